"""A recording becomes a depth folder that plays the same frames, bit by bit."""

import json
from contextlib import closing

import numpy as np
import pytest

from cliffscan.common.runtime.config import ConfigError
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.convert import convert
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.replay import open_recorded
from tests.build import SECOND, depth_folder
from tests.own_recordings import DEPTHS, KINDS, record, stamp_of


def configured(path, **settings):
    return CaptureConfig(source="replay", path=str(path), **settings)


def frames(config):
    with closing(open_recorded(config)) as recorded:
        read = [image.read() for image in recorded.images()]
    return [frame._replace(camera=config.camera(frame.camera)) for frame in read]


def same(one, other):
    assert len(one) == len(other)
    for before, after in zip(one, other, strict=True):
        np.testing.assert_array_equal(before.depth, after.depth)
        assert (before.stamp, before.camera, before.place) == (after.stamp, after.camera, after.place)


@pytest.mark.parametrize("kind", KINDS)
def test_a_recording_becomes_the_same_frames(tmp_path, kind):
    config = configured(record(tmp_path, kind), range=(0.3, 6.0))
    assert convert(config, tmp_path / "new" / "folder", 1, StopSignal()) == 0
    same(frames(config), frames(configured(tmp_path / "new" / "folder")))


def test_a_folder_keeps_what_its_frames_have_of_their_own(tmp_path):
    own = {"stamp": 5 * SECOND, "intrinsics": [5, 6, 1, 2], "floor": [0, -0.6, -0.8, 0.5]}
    stamps = {f"{number:03}": {"stamp": number * SECOND} for number in range(3)}
    (tmp_path / "old").mkdir()
    old = configured(
        depth_folder(
            tmp_path / "old", frames=stamps | {"001": own}, noise=0.002, region=[0, 0, 3, 1], place=[1, 2, 0.5]
        )
    )
    convert(old, tmp_path / "new", 1, StopSignal())
    same(frames(old), frames(configured(tmp_path / "new")))
    assert json.loads((tmp_path / "new" / "camera.json").read_text())["frames"]["002"] == {"stamp": 2 * SECOND}


def test_what_is_configured_of_the_sensor_is_written(tmp_path):
    path = record(tmp_path, "bag")
    convert(configured(path, noise=0.004, baseline=0.05, region=(0, 0, 2, 1)), tmp_path / "new", 1, StopSignal())
    (camera,) = {frame.camera for frame in frames(configured(tmp_path / "new"))}
    assert (camera.noise, camera.baseline) == (0.004, 0.05)


def test_every_second_image_is_every_second_image(tmp_path, capsys):
    convert(configured(record(tmp_path, "bag")), tmp_path / "new", 2, StopSignal())
    assert [frame.stamp for frame in frames(configured(tmp_path / "new"))] == [stamp_of(0), stamp_of(2)]
    assert capsys.readouterr().out == f"{tmp_path / 'new'}: 2 of 3 images\n"


def test_a_damaged_image_is_left_out_with_a_line(tmp_path, capsys):
    convert(configured(record(tmp_path, "sqlite", damaged=[1])), tmp_path / "new", 1, StopSignal())
    assert [frame.depth.tolist() for frame in frames(configured(tmp_path / "new"))] == [
        DEPTHS[0].tolist(),
        DEPTHS[2].tolist(),
    ]
    said = capsys.readouterr().err
    assert said.startswith("leaving out 000001: a message that cannot be decoded")
    assert said.count("\n") == 1


def test_a_folder_that_is_not_empty_is_refused_and_left_as_it_is(tmp_path):
    path = record(tmp_path, "bag")
    with pytest.raises(ConfigError, match="is not empty: name a new folder"):
        convert(configured(path), tmp_path, 1, StopSignal())
    assert [each.name for each in tmp_path.iterdir()] == ["drive.bag"]


def test_a_folder_that_cannot_be_made_is_refused(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(ConfigError, match="file/new: Not a directory"):
        convert(configured(record(tmp_path, "bag")), tmp_path / "file" / "new", 1, StopSignal())
