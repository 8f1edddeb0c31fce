"""A world that does not move, and wheels that obey late and brake weakly, for tests of the gate."""

import math
from collections import deque

import numpy as np

from cliffscan.safety.inputs import REST
from cliffscan.safety.pose2d import Pose2D
from cliffscan.safety.scan_claims import Scan

TICK = 0.02  # [s]
SUBSTEPS = 4
BRAKE = 0.6  # [m/s²]
RADIUS = 0.18  # [m]
BLIND = 0.75  # [m]
RANGE_MAX = 4.0
ANGLES = np.radians(np.linspace(-29, 29, 160))


class World:
    """What is there around a robot: voids, each the bearing [rad] and distance [m] of its edge, and round posts."""

    def __init__(self, voids, posts, middle):
        self.drawn = voids, posts
        voids = [(way + middle.theta, far) for way, far in voids]
        posts = [(way + middle.theta, far, size) for way, far, size in posts]
        self.voids = [
            (math.cos(way), math.sin(way), far + math.cos(way) * middle.x + math.sin(way) * middle.y)
            for way, far in voids
        ]
        self.posts = [
            (middle.x + (far + size) * math.cos(way), middle.y + (far + size) * math.sin(way), size)
            for way, far, size in posts
        ]

    def scan(self, camera, dark=False):
        """What each beam shows, where it is dark in the voids only what stands behind; and how far it shows floor."""
        dx, dy = np.cos(camera.theta + ANGLES), np.sin(camera.theta + ANGLES)
        ranges = np.full(len(ANGLES), np.inf)
        with np.errstate(divide="ignore", invalid="ignore"):
            for nx, ny, distance in self.voids:
                room, closing = distance - (nx * camera.x + ny * camera.y), nx * dx + ny * dy
                ranges = np.minimum(ranges, np.where(closing > 1e-9, np.maximum(room / closing, BLIND), np.inf))
            free = np.minimum(ranges, RANGE_MAX)
            if dark:
                ranges[ranges < RANGE_MAX] = np.nan
            edges = np.isfinite(ranges)
            for x, y, size in self.posts:
                along = dx * (x - camera.x) + dy * (y - camera.y)
                aside = dx * (y - camera.y) - dy * (x - camera.x)
                begins = along - np.sqrt(size**2 - aside**2)
                before = (begins >= BLIND) & ~(begins >= ranges)
                ranges, edges = np.where(before, begins, ranges), edges & ~before
        return Scan(np.where(ranges > RANGE_MAX, np.inf, ranges), edges, np.fmin(free, ranges), ANGLES)

    def depth_in_void(self, pose):
        """How far [m] the disc reaches into a void; negative for not at all."""
        return max((nx * pose.x + ny * pose.y + RADIUS - far for nx, ny, far in self.voids), default=-math.inf)

    def way_to(self, which, pose):
        """The heading [rad] from `pose` to an edge or a post, whichever has that number."""
        which %= len(self.voids) + len(self.posts)
        if which < len(self.voids):
            return math.atan2(self.voids[which][1], self.voids[which][0])
        x, y, _ = self.posts[which - len(self.voids)]
        return math.atan2(y - pose.y, x - pose.x)

    def room(self, pose, heading):
        """How far [m] the disc can go straight on."""
        dx, dy = math.cos(heading), math.sin(heading)
        rooms = [RANGE_MAX]
        for nx, ny, far in self.voids:
            if nx * dx + ny * dy > 0.01:
                rooms.append((far - RADIUS - nx * pose.x - ny * pose.y) / (nx * dx + ny * dy))
        for x, y, size in self.posts:
            along = dx * (x - pose.x) + dy * (y - pose.y)
            if along > 0 and abs(dx * (y - pose.y) - dy * (x - pose.x)) < size + RADIUS + 0.1:
                rooms.append(along - size - RADIUS)
        return min(rooms)

    def open_way(self, pose):
        """The heading [rad] with the most room."""
        return max((pose.theta + turn * math.pi / 8 for turn in range(16)), key=lambda way: self.room(pose, way))


class Wheels:
    """A base that does what it is told `dead` seconds later, speeds up at once, and brakes slowly on its arc."""

    def __init__(self, dead):
        self.dead = dead
        self.sent = deque([(-math.inf, REST)])
        self.speed = self.curvature = self.turning = 0.0

    def tell(self, now, twist):
        self.sent.append((now, twist))

    def step(self, pose, now, seconds):
        while len(self.sent) > 1 and self.sent[1][0] + self.dead <= now:
            self.sent.popleft()
        linear, angular = self.sent[0][1]
        self._drive(linear, seconds)
        if linear == 0.0 == angular or (linear * self.speed > 0 and abs(angular / linear - self.curvature) < 0.1):
            self.turning = self.curvature * self.speed
        else:
            self.turning = angular
            self.curvature = angular / self.speed if self.speed else 0.0
        middle = pose.theta + self.turning * seconds / 2
        way = self.speed * seconds
        theta = pose.theta + self.turning * seconds
        return Pose2D(pose.x + way * math.cos(middle), pose.y + way * math.sin(middle), theta)

    def _drive(self, wanted, seconds):
        if wanted * self.speed >= 0 and abs(wanted) >= abs(self.speed):
            self.speed = wanted
        else:
            braked = max(abs(self.speed) - BRAKE * seconds, abs(wanted) if wanted * self.speed > 0 else 0.0)
            self.speed = math.copysign(braked, self.speed)
