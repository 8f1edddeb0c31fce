"""The robot's own perception gets every frame whole, and a workstation what its link carries."""

import numpy as np

from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.depth_publisher import DepthPublisher
from cliffscan.services.capture.sources.depth_source import DepthFrame
from cliffscan.services.capture.window import FEW
from tests import build

CAMERA = build.camera()
DEPTH = np.full((48, 64), 1500, np.uint16)
HERE, THERE = "camera/depth", "workstation/camera/depth"


def publish(frames, answered, there="perception", **settings):
    """What was published of frames, of which one was answered at these paths before; and what was held back.

    there: which service works at the workstation.
    """
    service = build.service("capture", CaptureConfig(**settings))
    publisher = DepthPublisher(service)
    service.bus.watchers[f"{service.bus.robot}/workstation"](there, True)
    for path in answered:
        service.bus.arrive(path, build.payload(build.scan_fields(seq=99)))
    for seq in range(frames):
        publisher.put(seq, DepthFrame(DEPTH, 1000 + seq, CAMERA))
    sent = {path: [image.seq for image in service.bus.said[path]] for path in (HERE, THERE)}
    return sent, service.metrics.counts().get("held_back", 0)


def test_the_workstations_frames_wait_for_its_answers_and_the_robots_own_do_not():
    sent, held = publish(6, ["workstation/scan/fused", "scan/fused"])
    assert sent == {HERE: [*range(6)], THERE: [*range(FEW)]}
    assert held == 6 - FEW


def test_without_a_perception_at_the_workstation_nothing_is_published_for_it():
    """A recorder receives all keys, and so does a fleet's perception."""
    assert publish(6, [], there="recorder") == ({HERE: [*range(6)], THERE: []}, 0)


def test_where_nobody_answers_or_the_link_is_not_to_be_fitted_all_go():
    assert publish(6, []) == ({HERE: [*range(6)], THERE: [*range(6)]}, 0)
    service = build.service("capture", CaptureConfig(fit_link=False))
    DepthPublisher(service)
    assert not any(path.endswith("scan/fused") for path in service.bus.receivers)


def test_the_workstation_is_told_of_the_body():
    service = build.service("capture", CaptureConfig())
    DepthPublisher(service)
    body = {"simulated": False, "radius": 0.2, "height": 0.5}
    service.bus.arrive("description", build.payload({"stamp": 1, "body": body}))
    (told,) = service.bus.said["workstation/description"]
    assert told.body.height == 0.5
