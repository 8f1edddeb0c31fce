"""The configuration of perception: that of the three services it is made of."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from cliffscan.common.runtime import config as configuration
from cliffscan.common.runtime.config import SHARED, ConfigError, ServiceConfig, meant_for
from cliffscan.common.runtime.suggest import suggest
from cliffscan.services.fuse.config import FuseConfig
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.positive.config import PositiveConfig

KINDS: dict[str, type[ServiceConfig]] = {"negative": NegativeConfig, "positive": PositiveConfig, "fuse": FuseConfig}
TABLES = (*SHARED, *KINDS)


def load(file: Path | None, overrides: Iterable[str]) -> dict[str, Any]:
    """The configuration of each of the three by its name. Raises ConfigError."""
    overrides = list(overrides)
    for override in overrides:
        if not any(meant_for(name, override) for name in KINDS):
            expected, meant = ", ".join(TABLES), suggest(override.partition(".")[0], TABLES)
            raise ConfigError(f"--set {override}: expected TABLE.KEY=VALUE, TABLE one of {expected}{meant}")
    return {
        name: configuration.load(name, kind, file, [each for each in overrides if meant_for(name, each)])
        for name, kind in KINDS.items()
    }
