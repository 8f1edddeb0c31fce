"""The source that the configuration names."""

from importlib import import_module

from cliffscan.common.runtime.config import ConfigError
from cliffscan.services.capture.config import CaptureConfig
from cliffscan.services.capture.sources.depth_source import Source
from cliffscan.services.capture.sources.kinds import KINDS


def open_source(config: CaptureConfig) -> Source:
    """Open the configured source; what only one source needs is imported only for it.

    Raises SourceLost where its device is not there, ConfigError where it can never be opened.
    """
    kind = KINDS[config.source]
    try:
        source: Source = import_module(f"{__package__}.{kind.module}").open_configured(config)
    except ModuleNotFoundError as error:
        raise ConfigError(
            f"capture.source {config.source} needs {error.name}: pip install 'cliffscan[{kind.extra}]'"
        ) from error
    return source
