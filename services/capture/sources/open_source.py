"""The source that the configuration names."""

from collections.abc import Iterator
from contextlib import contextmanager
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
    with installed(config.source):
        module = import_module(f"{__package__}.{kind.module}")
        source: Source = module.open_configured(*((config, service) if kind.networked else (config,)))
    return source


@contextmanager
def installed(source: str) -> Iterator[None]:
    """Raises ConfigError, with what to install, where a library of a source is missing."""
    kind = KINDS[source]
    try:
        yield
    except ModuleNotFoundError as error:
        raise ConfigError(
            f"capture.source {source} needs {error.name}: pip install 'cliffscan[{kind.extra}]'"
        ) from error
    except ImportError as error:
        again = f"pip install --force-reinstall 'cliffscan[{kind.extra}]'"
        remedy = f"apt install {kind.debian}" if kind.debian else again
        raise ConfigError(f"capture.source {source} cannot load its library ({error}): {remedy}") from error
