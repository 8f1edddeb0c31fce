"""How high the robot is: what its configuration gives, or else what its base describes."""

from __future__ import annotations

from cliffscan.common.contract import topics
from cliffscan.common.contract.description import RobotDescription
from cliffscan.common.runtime.service import Service
from cliffscan.services.positive.config import PositiveConfig


class RobotHeight:
    """Holds the configuration with the height that counts.

    A base that drives has described its body before it is ready, so no drive begins with the default of another body.
    """

    def __init__(self, service: Service[PositiveConfig]) -> None:
        self.config = self._configured = service.config  # the first with the height that counts
        self._given = "robot_height" in service.config.model_fields_set
        self._metrics = service.metrics
        self._described: float | None = None
        service.receive_latched(topics.DESCRIPTION, self._receive)

    def _receive(self, description: RobotDescription) -> None:
        """Take the body's height, from any thread; the same one often, for it is published anew to whoever asks."""
        height = description.body.height if description.body else None
        ours = self.config.robot_height
        if height is None or height in (ours, self._described):
            return
        self._described = height
        if self._given:
            why = f"positive.robot_height is {ours:g} m, the base describes {height:g} m: set kobuki.robot_height only"
            self._metrics.warn_limited("height_differs", why)
        elif height <= self.config.floor_band:
            why = f"the base describes a body {height:g} m high: {ours:g} m counts; set kobuki.robot_height"
            self._metrics.warn_limited("height_refused", why)
        else:
            self.config = self._configured.on_body(height)
