"""The configured source is opened with what is configured; what it needs and lacks is said with the remedy."""

import math
import sys

import pytest

from cliffscan.common.contract.camera import check_camera
from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.kinds import KINDS
from cliffscan.services.capture.sources.open_source import open_source
from tests.build import camera, depth_folder


def test_the_sources_that_others_name_are_there():
    assert {"simulator", "replay", "kinect", "realsense", "openni2"} <= set(KINDS)


@pytest.mark.parametrize("kind", KINDS.values(), ids=KINDS)
def test_every_source_can_be_opened(kind):
    module = f"cliffscan.services.capture.sources.{kind.module}"
    reason = f"needs the extra {kind.extra}" + (f" and Debian's {kind.debian}" if kind.debian else "")
    assert callable(pytest.importorskip(module, reason=reason, exc_type=ImportError).open_configured)


def test_a_source_must_be_set_and_the_choices_are_named():
    with pytest.raises(ConfigError) as refused:
        CaptureConfig().check()
    assert all(source in str(refused.value) for source in (*KINDS, "--set capture.source=kinect"))
    for source in KINDS:
        CaptureConfig(source=source).check()


def test_a_mount_is_read_without_a_source():
    assert CaptureConfig(height=0.4).mounted_floor().d == 0.4


def test_a_replay_is_opened_from_its_folder(tmp_path):
    config = CaptureConfig(source="replay", path=str(depth_folder(tmp_path)), rate=1000, loop=False)
    assert open_source(config).read(1.0).camera.width == 4


@pytest.mark.parametrize("path", ["", "/none"])
def test_a_folder_that_is_not_there_can_never_be_opened(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ConfigError, match=r"camera\.json"):
        open_source(CaptureConfig(source="replay", path=path))


@pytest.mark.parametrize(
    ("source", "missing", "remedy"),
    [
        ("replay", "PIL", r"'cliffscan\[capture,replay\]'"),
        ("simulator", "mujoco", r"cliffscan\[simulator\]"),
    ],
)
def test_a_missing_library_is_named_with_the_extra_that_brings_it(source, missing, remedy, monkeypatch):
    module = "cliffscan.services.capture.sources." + {"replay": "replay", "simulator": "simulated"}[source]
    for name in list(sys.modules):
        if (
            name in (module, *(f"cliffscan.services.capture.sources.{each}" for each in ("depth_folder", "depth_png")))
            or name.split(".")[0] == missing
            or name.startswith("cliffscan.simulator")
        ):
            monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, missing, None)
    with pytest.raises(ConfigError, match=remedy) as refused:
        open_source(CaptureConfig(source=source))
    assert missing in str(refused.value)


@pytest.mark.parametrize(("pitch", "roll"), [(0, 0), (86.9, 0), (-86.9, 180), (30, -180), (10, 90)])
def test_any_mount_that_can_be_configured_is_a_possible_floor(pitch, roll):
    config = CaptureConfig(height=0.5, pitch=pitch, roll=roll)
    floor = config.mounted_floor()
    assert floor.d == 0.5
    assert floor.nz == pytest.approx(-math.sin(math.radians(pitch)))
    assert math.hypot(*floor[:3]) == pytest.approx(1)
    check_camera(camera(mount=(0.5, math.radians(pitch), math.radians(roll))))
