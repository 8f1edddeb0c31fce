"""The truth of every frame that a simulation sends, by the frame's stamp."""

import time

import numpy as np

from cliffscan.simulator import wire
from cliffscan.simulator.frame_server import FrameServer
from cliffscan.simulator.world import Pose
from evaluation.processes.truth_feed import PATIENCE, Truth, TruthFeed


def test_the_truth_comes_with_the_frames(tmp_path):
    server = FrameServer(str(tmp_path / "frames"))
    feed = TruthFeed(server.address)
    truth = {"pose": [1, 2, 3], "viewpoint": [4, 5, 6], "fallen": False, "bumps": 2}
    deadline = time.monotonic() + PATIENCE
    while 17 not in feed.by_stamp and time.monotonic() < deadline:
        server.offer(wire.pack({"stamp": 17, "time": 0.5, "truth": truth}, np.zeros((2, 3), np.uint16)))
    assert feed.by_stamp == {17: Truth(0.5, Pose(1, 2, 3), Pose(4, 5, 6), fallen=False, bumps=2)}
    feed.close()
    server.close()
