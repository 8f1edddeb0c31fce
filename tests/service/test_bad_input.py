"""Bad input is counted and told, and the next good frame is processed as if nothing had happened."""

import msgpack
import numpy as np
import pytest
from numpy.testing import assert_array_equal

from tests import scenes
from tests.service.conftest import image, ranges, scan

CAMERA = scenes.camera()
DEPTH = scenes.depth(CAMERA, [scenes.HOLE])


def changed(**changes):
    return msgpack.packb(image(CAMERA, DEPTH, 100) | changes)


def without(field):
    fields = image(CAMERA, DEPTH, 100)
    del fields[field]
    return msgpack.packb(fields)


MALFORMED = {
    "nothing": b"",
    "no msgpack": b"\xc1 depth",
    "a list": msgpack.packb([1, 2]),
    "no stamp": without("stamp"),
    "a stamp in words": changed(stamp="now"),
    "too few pixels": changed(data=b"\0" * 100),
    "a size of nothing": changed(width=0, data=b""),
    "nan in the intrinsics": changed(intrinsics=[float("nan"), 1.0, 1.0, 1.0]),
    "impossible intrinsics": changed(intrinsics=[0.0, 0.0, 32.0, 24.0]),
    "a floor above the camera": changed(floor=[0.0, -1.0, 0.0, -0.3]),
    "a plane without direction": changed(floor=[0.0, 0.0, 0.0, 0.3]),
    "infinite range": changed(range=[0.4, float("inf")]),
    "an unknown encoding": changed(encoding="32FC1"),
    "no levels": changed(encoding="16UC1;levels;zstd", data=b"\0\0"),
}


def counts(status, what):
    return status["counts"].get(what, 0)


@pytest.mark.parametrize("service", ["negative", "positive"])
def test_malformed_frames_cost_nothing_but_a_count(client, start, service):
    process = start(service)
    ear, status = client.listen(f"scan/{service}"), client.listen(f"status/{service}")
    client.put("camera/depth", image(CAMERA, DEPTH, 1))
    right = ranges(ear.get())
    for number, payload in enumerate(MALFORMED.values(), start=1):
        client.put("camera/depth", payload)
        client.put("camera/depth", image(CAMERA, DEPTH, 1 + number, seq=number))
        answer = ear.get()
        assert answer["stamp"] == 1 + number
        assert_array_equal(ranges(answer), right)
    told = status.until(lambda each: counts(each, "malformed") == len(MALFORMED))
    assert counts(told, "received") == len(MALFORMED) + 1
    process.wait_said("malformed (1 so far): camera/depth: ")


def test_another_size_in_mid_stream_is_another_camera_not_a_fault(client, start):
    start("negative")
    ear = client.listen("scan/negative")
    for stamp, size in enumerate([(64, 48), (32, 24), (64, 48)]):
        camera = scenes.camera(*size)
        client.put("camera/depth", image(camera, scenes.depth(camera), stamp, seq=stamp))
        assert ear.get()["seq"] == stamp


def test_a_clock_set_back_is_told_of_once_and_costs_no_frame(client, start):
    process = start("positive")
    for other in ("negative", "fuse"):
        start(other)
    ear, status = client.listen("scan/fused"), client.listen("status/positive")
    for seq, stamp in enumerate([5_000, 1_000, 1_033]):
        client.put("camera/depth", image(CAMERA, DEPTH, stamp, seq=seq))
        assert ear.get()["stamp"] == stamp
    status.until(lambda each: counts(each, "stamp_back") == 1)
    process.wait_said("stamp 1000 comes 4000 ns before")


def test_two_cameras_on_one_key_are_noticed(client, start):
    process = start("positive")
    ear, status = client.listen("scan/positive"), client.listen("status/positive")
    for stamp, seq in enumerate([1000, 7, 1001, 8, 1002]):
        client.put("camera/depth", image(CAMERA, DEPTH, stamp, seq=seq))
        assert ear.get()["stamp"] == stamp
    status.until(lambda each: counts(each, "sequence_back") == 2)
    process.wait_said("two cameras share this key")


def test_a_scan_without_its_partner_is_never_published(client, start):
    start("fuse", "--set", "fuse.timeout=0.2")
    ear, status = client.listen("scan/fused"), client.listen("status/fuse")
    client.put("scan/positive", scan([1.0, np.inf, 3.0], 10))
    client.put("scan/negative", scan([1.0, 2.0, np.nan], 11))
    status.until(lambda each: counts(each, "incomplete") == 2)
    client.put("scan/positive", scan([1.0, np.inf, 3.0, np.inf], 12))
    client.put("scan/negative", scan([2.0, 2.0, np.nan, np.nan], 12))
    answer = ear.get()
    assert answer["stamp"] == 12
    assert_array_equal(ranges(answer), np.array([1.0, 2.0, 3.0, np.nan], np.float32))
    assert not ear.all()


def test_scans_that_do_not_fit_each_other_are_refused(client, start):
    start("fuse")
    ear, status = client.listen("scan/fused"), client.listen("status/fuse")
    client.put("scan/positive", scan([1.0, 1.0, 1.0], 1))
    client.put("scan/negative", scan([1.0, 1.0], 1))
    client.put("scan/negative", b"garbage")
    client.put("scan/positive", scan([1.0, 4.0], 2))
    client.put("scan/negative", scan([2.0, 3.0], 2))
    assert ear.get()["stamp"] == 2
    told = status.until(lambda each: counts(each, "mismatch") == 1)
    assert counts(told, "malformed") == 1


LIDAR = ("--set", 'fuse.inputs.lidar={key="scan/lidar", x=0.1}')


def test_a_laser_scanner_on_its_own_grid_is_combined(client, start):
    start("fuse", *LIDAR)
    ear, status = client.listen("scan/fused"), client.listen("status/fuse")
    stamp = 1_000_000_000
    client.put("scan/lidar", scan([np.nan, 1.0, np.nan], stamp - 50_000_000))
    status.until(lambda each: counts(each, "received") == 1)
    client.put("scan/positive", scan([2.0, 2.0, np.inf, 0.5, 2.0], stamp))
    client.put("scan/negative", scan([np.inf] * 5, stamp))
    answer = ear.get()
    assert ranges(answer) == pytest.approx(np.array([2.0, 1.1, 1.1, 0.5, 2.0]), abs=0.03)
    assert np.frombuffer(answer["intensities"], "<f4").tolist() == [1, 5, 5, 1, 1]


def test_without_a_fresh_scan_of_a_configured_input_nothing_is_published(client, start):
    start("fuse", *LIDAR)
    ear, status = client.listen("scan/fused"), client.listen("status/fuse")
    client.put("scan/lidar", scan([1.0, 1.0], 1))
    status.until(lambda each: counts(each, "received") == 1)
    for side in ("positive", "negative"):
        client.put(f"scan/{side}", scan([2.0, 2.0], 10**10))
    status.until(lambda each: counts(each, "incomplete") == 1)
    client.put("scan/lidar", scan([1.0, 1.0], 3))
    status.until(lambda each: counts(each, "received") == 4)
    client.put("scan/positive", scan([2.0, 2.0], 3, seq=1))
    client.put("scan/negative", scan([2.0, 2.0], 3, seq=1))
    assert ear.get()["stamp"] == 3
