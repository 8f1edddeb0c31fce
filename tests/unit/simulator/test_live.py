"""The simulation's pace is told as it is, and its control socket obeys."""

import json
import logging
import math
import threading

import numpy as np
import pytest

from cliffscan.simulator import wire
from cliffscan.simulator.frame_server import FrameServer
from cliffscan.simulator.kobuki.cable import Cable
from cliffscan.simulator.kobuki.control import ControlError
from cliffscan.simulator.kobuki.runner import Runner
from cliffscan.simulator.live import LONGEST, Live, Pace
from cliffscan.simulator.robot import RobotSimulation
from cliffscan.simulator.world import Pose

DEADLINE = 60.0  # [s]


def test_the_pace_is_simulated_over_real_time(caplog):
    pace = Pace()
    for turn in range(40):
        pace.passed(0.05, 0.1, 0.1 * turn)
    assert pace.rate == pytest.approx(0.5)
    assert [record.levelno for record in caplog.records] == [logging.WARNING]  # and not once a second
    assert "at 50 % of real time" in caplog.text


def test_a_machine_that_keeps_up_is_not_complained_of(caplog):
    pace = Pace()
    for turn in range(40):
        pace.passed(0.1, 0.1, 0.1 * turn)
    assert pace.rate == pytest.approx(1.0)
    assert not caplog.records


def live(**options):
    return Live(RobotSimulation("paper_room", **options), None, 30.0)


def test_truth_and_place():
    running = live(pose=Pose(0.5, 0.0, 0.0))
    assert json.loads(running.execute("truth"))["pose"] == pytest.approx([0.5, 0.0, 0.0])
    assert running.execute("place -0.5 1 90") == "ok"
    told = json.loads(running.execute("truth"))
    assert told["pose"] == pytest.approx([-0.5, 1.0, math.pi / 2])
    assert told["viewpoint"] == pytest.approx([-0.5, 1.0 - 0.087, math.pi / 2])
    assert (told["fallen"], told["bumped"], told["bumps"], told["rate"]) == (False, False, 0, 1.0)


def test_the_bases_own_commands_are_obeyed_too():
    running = live()
    assert running.execute("bumper left on") == "ok"
    assert json.loads(running.execute("state"))["sensors"]["bumper"] == 4
    assert running.execute("help").startswith("truth; place X Y DEGREES; state; watch; bumper")
    with pytest.raises(ControlError, match="slip as their own world has them"):
        running.execute("slip 0.1 0.1")


@pytest.mark.parametrize("line", ["place", "place 1 2", "place 1 2 x", "place 1 2 nan"])
def test_a_place_that_is_none_is_refused(line):
    with pytest.raises(ControlError, match="expected place X Y DEGREES"):
        live().execute(line)


def test_a_running_simulation_says_what_time_it_is(tmp_path):
    """However fast the machine is, the frames' own time never outruns the clock's."""
    simulation = RobotSimulation("empty_room")
    server = FrameServer(str(tmp_path / "frames"))
    running, stop = Live(simulation, server, 30.0), threading.Event()
    with Runner(simulation.base, Cable(tmp_path / "port")) as runner:
        thread = threading.Thread(target=running.run, args=(runner, stop))
        thread.start()
        reader, frames = wire.FrameReader(), []
        with wire.connect(server.address, DEADLINE) as connection:
            while len(frames) < 4:
                frames += reader.feed(connection.recv(1 << 20))
        stop.set()
        thread.join(DEADLINE)
    server.close()
    times = np.array([frame.header["time"] for frame in frames])
    stamps = np.array([frame.header["stamp"] for frame in frames]) * 1e-9
    assert (np.diff(times) > 0.0).all()
    assert (np.diff(times) <= np.diff(stamps) + LONGEST).all()
    assert [frame.header["seq"] for frame in frames] == [0, 1, 2, 3]
    assert all(frame.depth.shape == (480, 640) for frame in frames)


def test_nothing_is_drawn_while_nobody_looks(tmp_path, monkeypatch):
    simulation = RobotSimulation("empty_room")
    server = FrameServer(str(tmp_path / "frames"))
    monkeypatch.setattr(simulation, "frame", lambda: pytest.fail("drawn"))
    running, stop = Live(simulation, server, 1000.0), threading.Event()
    with Runner(simulation.base, Cable(tmp_path / "port")) as runner:
        exchange = runner.exchange

        def exchanged(dt):
            exchange(dt)
            if simulation.time > 0.1:
                stop.set()

        monkeypatch.setattr(runner, "exchange", exchanged)
        running.run(runner, stop)
    server.close()
