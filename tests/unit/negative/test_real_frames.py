"""Frames of real sensors: table tops end where they end, and floors do not.

What is taken for floor is the plane that a frame's camera.json tells, which of the table tops is the table.
"""

from pathlib import Path

import numpy as np
import pytest

from cliffscan.common.contract.camera import scan_axes
from cliffscan.common.contract.depth_codec import RAW
from cliffscan.common.contract.messages import DepthImage
from cliffscan.services.capture.sources.depth_folder import read_camera, read_depth
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.negative.scans import beams_by_method

REAL = Path(__file__).parents[2] / "data/real"
GRID = NegativeConfig().grid()
BAND = 0.02  # [m] about the plane: its own pixels


def frames(pattern):
    return [str(path.relative_to(REAL)) for path in sorted(REAL.glob(pattern))]


class Recorded:
    """A recorded frame, what near_edge tells of it, and its pixels beam by beam."""

    def __init__(self, name):
        path = REAL / name
        self.camera = read_camera(path.parent).camera_of(path.stem)
        depth = read_depth(path, self.camera.width, self.camera.height)
        image = DepthImage.pack(0, 0, "camera", depth, self.camera, RAW)
        self.beams = beams_by_method(image, NegativeConfig(), ["near_edge"])["near_edge"]
        self.told = np.isfinite(self.beams.ranges)
        forward, left, up = (axis.table() for axis in scan_axes(self.camera))
        metres = np.where(depth > 0, depth / 1000, np.nan)
        self.heights = up * metres + self.camera.floor.d
        self.distances = np.hypot(forward, left) * metres
        self.beam = GRID.beam_of(np.arctan2(left, forward))

    def of_beams(self, chosen, values, least_or_most):
        """The least, or the most, of each beam's chosen pixels; NaN of a beam that has none."""
        found = np.full(GRID.beams, np.nan)
        inside = chosen & (self.beam >= 0) & (self.beam < GRID.beams)
        least_or_most.at(found, self.beam[inside], values[inside])
        return found

    def ends(self):
        """Where the plane's last pixel lies along each beam [m]."""
        return self.of_beams(np.abs(self.heights) <= BAND, self.distances, np.fmax)

    def allowed(self):
        """2 cm, or the spacing of the image's rows on the plane: (beams,) [m]."""
        slope = self.camera.floor.d**2 + self.beams.ranges.astype(float) ** 2
        return np.maximum(0.02, slope / (self.camera.intrinsics.fy * self.camera.floor.d))


@pytest.mark.parametrize("name", frames("nvblox*/*.png") + frames("felix*/*.png") + frames("*/pcl_five_people.png"))
def test_no_drop_is_on_a_corridors_or_a_plank_floor(name):
    frame = Recorded(name)
    assert not frame.told.any()
    assert not frame.beams.intensities.any()


@pytest.mark.parametrize("name", frames("nvblox*/*.png"))
def test_most_of_a_corridor_is_free(name):
    assert np.isposinf(Recorded(name).beams.ranges).mean() > 0.6  # the others see a person, or a wall 3.6 m away


def test_tables_end_where_their_own_pixels_end():
    off = []
    for name in frames("pcl_mOSD*/*.png"):
        frame = Recorded(name)
        off += [*np.abs(frame.beams.ranges - frame.ends())[frame.told]]
    assert len(off) > 2000
    assert np.mean(np.array(off) <= 0.02) >= 0.985
    assert np.max(off) <= 0.04  # [m]
    assert np.median(off) <= 0.01


@pytest.mark.parametrize("name", frames("pcl_mOSD*/*.png"))
def test_no_beam_is_free_beyond_a_table(name):
    assert not np.isposinf(Recorded(name).beams.ranges).any()


def test_where_nothing_stands_on_a_table_its_edge_is_told():
    clear, told = 0, 0
    for name in frames("pcl_mOSD*/*.png"):
        frame = Recorded(name)
        standing = np.bincount(frame.beam[(frame.heights > 0.03) & (frame.beam >= 0)], minlength=GRID.beams)
        seen = np.bincount(frame.beam[(np.abs(frame.heights) < BAND) & (frame.beam >= 0)], minlength=GRID.beams)
        empty = ((standing < 2)[: GRID.beams]) & ((seen > 20)[: GRID.beams])
        clear, told = clear + empty.sum(), told + (frame.told & empty).sum()
    assert clear > 2000
    assert told >= 0.92 * clear  # the others look past an object's side, or into its shadow


def test_a_table_far_off_ends_about_where_its_own_pixels_end():
    frame = Recorded("pcl_five_people_and_milk/pcl_milk_cartoon_all_small_clorox.png")
    last = frame.of_beams(np.abs(frame.heights) <= 0.05, frame.distances, np.fmax)  # out there it leaves its plane
    off = np.abs(frame.beams.ranges - last)[frame.told]
    assert frame.told.sum() > 150
    assert np.median(off) <= 0.015
    assert (off <= frame.allowed()[frame.told]).mean() >= 0.74
    assert off.max() <= 0.06  # [m] at 2.4 m, where the sensor's steps are of 2 cm


@pytest.mark.parametrize("name", frames("tum*/*.png"))
def test_a_desk_whose_near_edge_is_in_view_begins_with_a_drop(name):
    frame = Recorded(name)
    below = frame.heights < -0.1
    height = frame.camera.floor.d
    moved = np.where(below, frame.distances * height / (height - np.where(below, frame.heights, 0.0)), np.nan)
    first = frame.of_beams(below, moved, np.fmin)
    desk = frame.of_beams(np.abs(frame.heights) <= BAND, frame.distances, np.fmin)
    assert frame.told.mean() > 0.985
    assert not (frame.beams.ranges - first > 0.02).any()
    assert not (frame.beams.ranges >= desk).any()


def test_no_beam_is_free_beyond_a_kerb_that_stereo_smears():
    frame = Recorded("gmrpd_d415_kerb/sample2.png")
    road = frame.of_beams(frame.heights < -0.09, frame.distances, np.fmin)  # within sight, on the left only
    beyond = (road < 3.9) & (GRID.angles() > 0.2)
    assert beyond.sum() > 60
    assert np.isfinite(frame.beams.ranges[beyond]).mean() > 0.75
    assert not np.isposinf(frame.beams.ranges[beyond]).any()


@pytest.mark.parametrize("name", frames("gmrpd_d415_kerb/*.png"))
def test_the_pavement_before_a_kerb_is_free(name):
    frame = Recorded(name)
    ahead = np.abs(GRID.angles()) < 0.17
    assert np.isposinf(frame.beams.ranges[ahead]).mean() > 0.8
