"""Prints docs/configuration.md: every setting of every service, as the configuration classes say it.

python -m cliffscan.configuration_page > docs/configuration.md
"""

import json
from collections.abc import Iterator
from typing import get_args

from cliffscan.common.perception.scans import ScanConfig
from cliffscan.common.runtime.config import CONFIGURED, PROFILE, PROFILES, ServiceConfig, home_tables
from cliffscan.common.runtime.settings import Setting, settings
from cliffscan.preflight import config_class

INTRODUCTION = """\
# Configuration

A TOML file changes settings (`--config robot.toml`), and so does an option (`--set negative.range_min=0.2`). The option
wins. Each service has a table; negative and positive also read the table `scan`, for they must agree on it, and
perception reads the tables of negative, positive and fuse. All refuse an unknown key or a bad value with one line and
exit 2. `--dump-config` prints the settings that hold, with these comments, as a file that `--config` takes.

The unit 1 is that of a ratio.

`python -m cliffscan.configuration_page > docs/configuration.md` writes this page from the configuration classes."""

HEADER = "| setting | default | unit | range | meaning |\n|---|---|---|---|---|"


def page() -> str:
    """The whole page."""
    parts = [INTRODUCTION, *_profiles()]
    parts += _section(ScanConfig.TABLE, ScanConfig)
    for service in CONFIGURED:
        parts += _section(service, config_class(service))
    return "\n\n".join(parts) + "\n"


def _profiles() -> Iterator[str]:
    yield "## Profiles"
    yield f'`--set {PROFILE}=NAME`, or `{PROFILE} = "NAME"` above all tables of a file, changes these defaults:'
    rows = [
        f"| `{name}` | `{service}.{key}` | {_value(value)} |"
        for name in PROFILES
        for service in CONFIGURED
        for key, value in config_class(service).PROFILES.get(name, {}).items()
    ]
    yield "\n".join(["| profile | setting | default |\n|---|---|---|", *rows])


def _section(table: str, kind: type[ServiceConfig]) -> Iterator[str]:
    """The section of a table, then those of the tables that users name themselves."""
    yield f"## {table}"
    yield (kind.__doc__ or "").strip().splitlines()[0]
    homes = home_tables(table, kind)
    below = {each: _named_tables(each) for each in settings(kind) if homes[each.name] == table}
    yield "\n".join([HEADER, *(_row(table, each) for each, tables in below.items() if not tables)])
    for each, tables in below.items():
        if tables:
            yield from _section(f"{table}.{each.name}.NAME", tables)


def _named_tables(setting: Setting) -> type[ServiceConfig] | None:
    """The class of the tables that a setting holds; None where it holds a value."""
    parts = [each for each in get_args(setting.field.annotation) if isinstance(each, type)]
    return next((each for each in parts if issubclass(each, ServiceConfig)), None)


def _row(table: str, setting: Setting) -> str:
    default = "must be set" if setting.field.is_required() else _value(setting.field.default)
    meaning = setting.meaning.replace(f" [{setting.unit}]", "")
    cells = [f"`{table}.{setting.name}`", default, setting.unit, setting.allowed, meaning]
    return "|" + "|".join(f" {cell} " if cell else " " for cell in cells) + "|"


def _value(value: object) -> str:
    """A value as TOML has it."""
    text = f"{value:.6g}" if isinstance(value, float) else json.dumps(value, ensure_ascii=False)
    return f"`{text}`"


if __name__ == "__main__":
    print(page(), end="")
