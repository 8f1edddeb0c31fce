"""What `./demo --secure` starts: the services of two hosts, each behind its own router, with keys of its own making."""

import queue

from cliffscan.common.contract.messages import LaserScan
from cliffscan.common.contract.topics import SCAN_FUSED
from cliffscan.common.runtime.config import SENSING
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.system import Plan
from evaluation.processes.hosts import running
from evaluation.processes.watch import Watch
from tests.service.conftest import DEADLINE, wait_until

CAMERA = ["capture.world=paper_room_open", "capture.source=simulator", "capture.rate=10"]


class Scans:
    """A goal: the first scan."""

    unit, total, patience, paths, done = "scans", 1, DEADLINE, (SCAN_FUSED.path,), 0


def test_the_scans_of_the_robots_frames_are_made_at_the_workstation():
    arrived = queue.Queue()
    plan = Plan("demo-test", overrides=[*CAMERA, "negative.range_min=0.9"])
    with running(plan, StopSignal(), secure=True) as hosts, hosts.bus("recorder") as bus:
        robot, workstation = hosts.robot.plan, hosts.workstation.plan
        assert robot.services == ["capture"]
        assert robot.overrides == CAMERA
        assert workstation.services == ["negative", "positive", "fuse"]
        assert workstation.overrides == ["negative.range_min=0.9"]
        assert {end.partition("/")[0] for end in (*robot.listen, *workstation.listen, *workstation.join)} == {"tls"}
        assert set(hosts.children) == {"router", "router of the workstation", *workstation.services}
        bus.subscribe(SCAN_FUSED.path, lambda _path, payload: arrived.put(payload))
        watch, goal = Watch(hosts, SENSING, "seeing"), Scans()
        wait_until(lambda: watch.look(goal) or arrived.qsize())
        assert LaserScan.decode(arrived.get()).grid().beams > 1
        assert hosts.alive >= {*SENSING, "router-robot", "router-workstation"}
    assert not workstation.secure.exists()
