"""Configuration: a TOML file with one table per service, overridden by KEY=VALUE; refused with one line when wrong."""

from __future__ import annotations

import textwrap
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, ClassVar, TypeVar

import tomli_w
from pydantic import BaseModel, ConfigDict, ValidationError

from cliffscan.common.contract.message import explain
from cliffscan.common.runtime.settings import settings
from cliffscan.common.runtime.suggest import suggest

SENSING = ("capture", "negative", "positive", "fuse")
SERVICES = (*SENSING, "kobuki")
PROFILE = "profile"
PROFILES = ("default", "paper")
COMMENT_WIDTH = 110  # characters of a line of a dump


class ConfigError(ValueError):
    """The configuration cannot be used; the text is one line that says why."""


Profiles = dict[str, dict[str, Any]]


class ServiceConfig(BaseModel):
    """A service's table: every value typed and bounded, unknown keys refused.

    The docstring below a field says what it means, with its unit in brackets, as `[m/s]`; its range is its type's.
    PROFILES: what other defaults a value has where `profile` names one of them.
    """

    PROFILES: ClassVar[Profiles] = {}

    model_config = ConfigDict(
        strict=True, frozen=True, extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True
    )

    def check(self) -> None:
        """Raise ConfigError, one line with the remedy, where a service cannot start with these values as they are.

        What other programs read of the table, and --dump-config, do without it.
        """


C = TypeVar("C", bound=ServiceConfig)


def load(service: str, kind: type[C], file: Path | None, overrides: Iterable[str]) -> C:
    """The configuration of `service` from its table in `file`, with `overrides` on top. Raises ConfigError.

    A file's `profile`, outside all tables, or the override profile=NAME says which defaults lie below.
    """
    profile, table = _given(service, kind, file, overrides)
    try:
        return kind.model_validate({**kind.PROFILES.get(profile, {}), **table})
    except ValidationError as error:
        raise ConfigError(f"{service}.{explain(error)}{_meant(kind, error)}") from error


def given(service: str, kind: type[ServiceConfig], file: Path | None, overrides: Iterable[str]) -> dict[str, Any]:
    """What `file` and `overrides` say of `service`, whether it is valid or not. Raises ConfigError."""
    return _given(service, kind, file, overrides)[1]


def _given(
    service: str, kind: type[ServiceConfig], file: Path | None, overrides: Iterable[str]
) -> tuple[str, dict[str, Any]]:
    """The profile's name and the table that are given."""
    tables = _read_tables(file) if file else {}
    profile, table = tables.get(PROFILE, PROFILES[0]), tables.get(service, {})
    for override in overrides:
        key, equals, text = override.partition("=")
        if key.strip() == PROFILE and equals:
            profile = _profile(_value(text.strip()), f"--set {override}")
        else:
            _override(table, service, override, kind)
    return profile, table


def dump(service: str, config: ServiceConfig) -> str:
    """The effective configuration as TOML that load() reads back to the same.

    A comment above each value says what it means, one at the top what the table lacks.
    """
    return _lack(config) + "\n".join(_lines([service], config)) + "\n"


def meant_for(service: str, override: str) -> bool:
    """Whether a service takes this KEY=VALUE: one of its own values, or the profile."""
    return override.startswith(f"{service}.") or override.partition("=")[0].strip() == PROFILE


def _lines(path: Sequence[str], config: ServiceConfig) -> Iterator[str]:
    """The lines of the table at `path`, then those of the tables below it."""
    yield from _header(path)
    values = config.model_dump(mode="json")
    below: list[str] = []
    for setting in settings(type(config)):
        comment = textwrap.wrap(setting.comment(), COMMENT_WIDTH, initial_indent="# ", subsequent_indent="# ")
        tables = getattr(config, setting.name)
        if isinstance(tables, dict):
            below += ["", *comment, *_header([*path, setting.name])]
            for name, table in tables.items():
                below += ["", *_lines([*path, setting.name, name], table)]
        else:
            yield from comment
            yield tomli_w.dumps({setting.name: values[setting.name]}).rstrip("\n")
    yield from below


def _header(path: Sequence[str]) -> list[str]:
    """A table's header, its names quoted where TOML wants it."""
    table: dict[str, Any] = {}
    for name in reversed(path):
        table = {name: table}
    return tomli_w.dumps(table).splitlines()


def _lack(config: ServiceConfig) -> str:
    try:
        config.check()
    except ConfigError as error:
        return f"# {error}\n"
    return ""


def _meant(kind: type[ServiceConfig], error: ValidationError) -> str:
    """The setting that the first unknown one may be."""
    unknown = [each["loc"] for each in error.errors() if each["type"] == "extra_forbidden" and len(each["loc"]) == 1]
    return suggest(str(unknown[0][0]), kind.model_fields) if unknown else ""


def _profile(name: object, where: str) -> str:
    if name not in PROFILES:
        raise ConfigError(f"{where}: profile {name!r} is none of {', '.join(PROFILES)}")
    return str(name)


def _read_tables(file: Path) -> dict[str, Any]:
    try:
        tables = tomllib.loads(file.read_text("utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise ConfigError(f"{file}: {getattr(error, 'strerror', None) or error}") from error
    for name, table in tables.items():
        if name == PROFILE:
            _profile(table, str(file))
            continue
        if name not in SERVICES:
            expected = ", ".join(SERVICES)
            raise ConfigError(f"{file}: unknown table [{name}], expected one of {expected}{suggest(name, SERVICES)}")
        if not isinstance(table, dict):
            raise ConfigError(f"{file}: {name} is no table; write [{name}] and its keys below")
    return tables


def _override(table: dict[str, Any], service: str, override: str, kind: type[ServiceConfig]) -> None:
    """Set one value of `table`; a dotted key reaches into its tables. A text that looks like a number stays a text."""
    key, equals, text = override.partition("=")
    head, *path = key.strip().split(".")
    if not equals or not path:
        raise ConfigError(f"--set {override}: expected {service}.KEY=VALUE")
    if head != service:
        meant = suggest(head, [service])
        raise ConfigError(f"--set {override}: this service reads {service}.KEY only{meant}")
    for part in path[:-1]:
        table = table.setdefault(part, {})
        if not isinstance(table, dict):
            raise ConfigError(f"--set {override}: {part} is no table")
    value = _value(text)
    wants_text = len(path) == 1 and path[0] in kind.model_fields and kind.model_fields[path[0]].annotation is str
    table[path[-1]] = text if wants_text and not isinstance(value, str) else value


def _value(text: str) -> object:
    """A TOML value where the text is one, or else the text itself, so that words and paths need no quotes."""
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return parsed["value"] if len(parsed) == 1 else text
