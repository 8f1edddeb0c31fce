"""Every source of depth frames, in one table: a row and its file are all that a further camera needs."""

from typing import NamedTuple


class Kind(NamedTuple):
    """How a source is opened, and what its pictures are. A source that is not said to be recorded is live.

    module: a file beside this one; its open_configured(config) makes a Source. extra: what pip installs for it.
    debian: the packages of Debian without which what pip installed cannot be loaded.
    recorded: a picture may come again. simulated: the pictures are not of where the robot stands now.
    networked: they come over the service's own session; the source is made by open_configured(config, service).
    """

    module: str
    extra: str = "capture"
    debian: str = ""
    recorded: bool = False
    simulated: bool = False
    networked: bool = False


KINDS = {
    "simulator": Kind("simulated", extra="simulator", simulated=True),
    "replay": Kind("replay", extra="capture,replay", recorded=True, simulated=True),
    "kinect": Kind("kinect"),
    "realsense": Kind("realsense", extra="realsense", debian="libusb-1.0-0"),
    "openni2": Kind("openni2", extra="openni2"),
    "ros2": Kind("ros2", extra="capture,ros2", networked=True),
}
