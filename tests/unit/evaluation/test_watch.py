"""Processes that die or say nothing are noticed."""

from types import SimpleNamespace

import pytest

from cliffscan.common.runtime.config import SENSING
from evaluation.processes.watch import STARTING, Failed, Watch
from experiments.worlds import FirstFrames


class Scripted:
    """A system whose processes do what a test says."""

    def __init__(self) -> None:
        self.alive = set()
        self.children = {"negative": SimpleNamespace(pid=1)}
        self.polled = 0
        self.now = 0.0

    def poll(self):
        self.polled += 1

    def watch(self):
        return Watch(self, SENSING, "collecting frames", lambda: self.now)


def test_a_process_that_was_started_again_has_died():
    system, goal = Scripted(), FirstFrames(3, {})
    watch = system.watch()
    watch.look(goal)
    system.children["negative"].pid = 2
    with pytest.raises(Failed, match="negative died"):
        watch.look(goal)
    assert system.polled == 2


def test_services_have_time_to_start_each_after_the_other():
    system, goal = Scripted(), FirstFrames(3, {})
    watch = system.watch()
    for service in SENSING:
        system.now += STARTING - 1.0
        watch.look(goal)
        assert service in watch.state
        system.alive.add(service)
    watch.look(goal)
    assert watch.state == "collecting frames"


def test_a_service_that_does_not_start_is_named():
    system = Scripted()
    system.alive = set(SENSING) - {"fuse"}
    watch = system.watch()
    watch.look(FirstFrames(3, {}))
    system.now = STARTING + 1.0
    with pytest.raises(Failed, match="while starting fuse: 0 of 3 frames"):
        watch.look(FirstFrames(3, {}))


def test_services_that_work_must_bring_a_new_frame_in_time():
    system, goal = Scripted(), FirstFrames(3, {})
    system.alive = set(SENSING)
    watch = system.watch()
    for taken in range(3):
        system.now += goal.patience - 1.0
        watch.look(goal)
        goal.frames.append(taken)
    watch.look(goal)
    system.now += goal.patience + 1.0
    with pytest.raises(Failed, match="nothing new for 30 s while collecting frames: 3 of 3"):
        watch.look(goal)
