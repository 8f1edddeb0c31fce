"""What is published of every packet of the base."""

from cliffscan.common.contract import topics
from cliffscan.common.runtime.service import Service
from cliffscan.services.kobuki import reports
from cliffscan.services.kobuki.config import KobukiConfig
from cliffscan.services.kobuki.odometry import Estimate
from cliffscan.services.kobuki.protocol.packets import Feedback
from cliffscan.services.kobuki.protocol.sensors import Core


class BasePublishers:
    """Publishes odometry, state and gyro, as far as anybody subscribes."""

    def __init__(self, service: Service[KobukiConfig]) -> None:
        self._metrics = service.metrics
        self._odom = service.publisher(topics.ODOMETRY)
        self._state = service.publisher(topics.BASE_STATE)
        self._imu = service.publisher(topics.IMU)
        self.begin()

    def begin(self) -> None:
        """Know nothing of the base."""
        self._report = reports.StateReport()

    def publish(self, feedback: Feedback, core: Core, estimate: Estimate, stamp: int) -> None:
        """Publish what a packet brought."""
        self._report.update(feedback, core)
        if self._odom.has_subscribers:
            self._odom.put(reports.odometry(estimate, stamp))
        if self._state.has_subscribers:
            self._state.put(self._report.message(core, stamp))
        if feedback.gyro and feedback.inertia and self._imu.has_subscribers:
            self._imu.put(reports.imu(feedback.gyro, feedback.inertia, stamp))
        self._metrics.output(stamp)
