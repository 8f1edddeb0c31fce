"""The source that the configuration names."""

from importlib import import_module

from cliffscan.common.runtime.config import ConfigError
from cliffscan.common.runtime.service import Service
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_source import Source
from cliffscan.services.capture.sources.kinds import KINDS


def open_source(config: CaptureConfig, service: Service[CaptureConfig] | None = None) -> Source:
    """Open the configured source; what only one source needs is imported only for it.

    service: whose session a source on the network takes; no other needs one.
    Raises SourceLost where its device is not there, ConfigError where it can never be opened.
    """
    kind = KINDS[config.source]
    try:
        module = import_module(f"{__package__}.{kind.module}")
        source: Source = module.open_configured(*((config, service) if kind.networked else (config,)))
    except ModuleNotFoundError as error:
        raise ConfigError(
            f"capture.source {config.source} needs {error.name}: pip install 'cliffscan[{kind.extra}]'"
        ) from error
    except ImportError as error:
        raise ConfigError(
            f"capture.source {config.source} cannot load its library ({error}): apt install {kind.debian}"
        ) from error
    return source
