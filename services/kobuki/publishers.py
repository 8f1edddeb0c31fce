"""What is published of every packet of the base."""

from cliffscan.common.contract import topics
from cliffscan.common.runtime.service import Service
from cliffscan.services.kobuki import reports
from cliffscan.services.kobuki.config import KobukiConfig
from cliffscan.services.kobuki.odometry import Estimate
from cliffscan.services.kobuki.protocol.packets import Feedback
from cliffscan.services.kobuki.protocol.sensors import Core

ASK = 10  # packets, 0.2 s, after which to look again who subscribes, for that takes as long as to publish


class BasePublishers:
    """Publishes odometry, state and gyro, as far as anybody subscribes."""

    def __init__(self, service: Service[KobukiConfig]) -> None:
        self._metrics = service.metrics
        self._odom = service.publisher(topics.ODOMETRY)
        self._state = service.publisher(topics.BASE_STATE)
        self._imu = service.publisher(topics.IMU)
        self._packets = 0
        self.begin()

    def begin(self) -> None:
        """Know nothing of the base."""
        self._report = reports.StateReport()

    def publish(self, feedback: Feedback, core: Core, estimate: Estimate, stamp: int) -> None:
        """Publish what a packet brought."""
        if self._packets % ASK == 0:
            self._to_odom, self._to_state, self._to_imu = (
                publisher.has_subscribers for publisher in (self._odom, self._state, self._imu)
            )
        self._packets += 1
        self._report.update(feedback, core)
        if self._to_odom:
            self._odom.put(reports.odometry(estimate, stamp))
        if self._to_state:
            self._state.put(self._report.message(core, stamp))
        if self._to_imu and feedback.gyro and feedback.inertia:
            self._imu.put(reports.imu(feedback.gyro, feedback.inertia, stamp))
        self._metrics.output(stamp)
