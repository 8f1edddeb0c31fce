"""The source that the configuration names."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_source import Source


class Kind(NamedTuple):
    """How a source is opened, and what its pictures are. One that does not say it is a recording is live.

    recorded: a picture may come again. simulated: they are not of where the robot stands now.
    """

    open: Callable[[CaptureConfig], Source]
    recorded: bool = False
    simulated: bool = False


def open_source(config: CaptureConfig) -> Source:
    """Open the configured source; what only one source needs is imported only for it.

    Raises SourceLost where its device is not there, ConfigError where it can never be opened.
    """
    try:
        return KINDS[config.source].open(config)
    except ModuleNotFoundError as error:
        extra = "simulator" if config.source == "simulator" else "capture"
        raise ConfigError(
            f"capture.source {config.source} needs {error.name}: pip install 'cliffscan[{extra}]'"
        ) from error


def _replay(config: CaptureConfig) -> Source:
    from cliffscan.services.capture.sources.replay import Replay

    return Replay(Path(config.path), config.rate, config.loop)


def _simulator(config: CaptureConfig) -> Source:
    if config.simulation:
        from cliffscan.services.capture.sources.simulation import Simulation

        return Simulation(config.simulation, config.mounted_floor())
    from cliffscan.services.capture.sources.simulated import Simulated

    return Simulated(config.world, config.mounted_floor(), config.rate, config.seed)


def _kinect(config: CaptureConfig) -> Source:
    from cliffscan.services.capture.sources.kinect import Kinect

    return Kinect(config.kinect(), config.depth_mode, config.device)


KINDS = {
    "replay": Kind(_replay, recorded=True, simulated=True),
    "simulator": Kind(_simulator, simulated=True),
    "kinect": Kind(_kinect),
}
