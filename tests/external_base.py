"""A base of another make, that knows nothing but the contract: it obeys base/cmd_vel_safe and publishes base/odom."""

import contextlib
import math
import threading
import time
from collections import deque

import msgpack

PERIOD = 0.02  # [s]
LONGEST = 0.1  # [s] that it moves on in one step: a busy machine means slow motion, not a base that nobody commands
COVARIANCE = [0.0] * 9


class ExternalBase:
    """Two wheels on a flat floor: a dead time, then a limited acceleration. A context manager that runs it."""

    def __init__(self, client, dead_time=0.1, deceleration=0.8, turning=3.0) -> None:
        self.client = client
        self.pose = (0.0, 0.0, 0.0)
        self.speed = [0.0, 0.0]
        self.commands = []  # every velocity that came
        self.publishing = True
        self.driven = True  # False: it ignores its commands, and the odometry stands
        self.offset = 0  # [ns] of its clock
        self._dead_time, self._limits = dead_time, (deceleration, turning)
        self._waiting = deque()
        self._target = (0.0, 0.0)
        self._end = threading.Event()
        client.session.declare_subscriber(f"{client.robot}/base/cmd_vel_safe", self._obey)

    def __enter__(self):
        self._thread = threading.Thread(target=self._run)
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._end.set()
        self._thread.join()

    def _obey(self, sample):
        message = msgpack.unpackb(sample.payload.to_bytes())
        self.commands.append(message)
        self._waiting.append((time.monotonic() + self._dead_time, (message["linear"], message["angular"])))

    def _run(self):
        before = time.monotonic()
        while not self._end.wait(PERIOD):
            now = time.monotonic()
            self._step(now, min(now - before, LONGEST))
            before = now
            if self.publishing:
                self._publish()

    def _step(self, now, dt):
        with contextlib.suppress(IndexError):
            while self._waiting[0][0] <= now:
                self._target = self._waiting.popleft()[1]
        for axis, limit in enumerate(self._limits):
            change = self._target[axis] * self.driven - self.speed[axis]
            self.speed[axis] += max(-limit * dt, min(limit * dt, change))
        x, y, theta = self.pose
        middle = theta + self.speed[1] * dt / 2
        way = self.speed[0] * dt
        self.pose = (x + way * math.cos(middle), y + way * math.sin(middle), theta + self.speed[1] * dt)

    def _publish(self):
        message = {
            "stamp": time.time_ns() + self.offset,
            "frame": "odom",
            "child_frame": "base_link",
            "pose": list(self.pose),
            "twist": list(self.speed),
            "pose_covariance": COVARIANCE,
            "twist_covariance": COVARIANCE,
        }
        self.client.session.put(f"{self.client.robot}/base/odom", msgpack.packb(message))
