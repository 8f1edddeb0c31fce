"""Configuration: a TOML file with one table per service, overridden by KEY=VALUE; refused with one line when wrong."""

import textwrap
import tomllib
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, TypeVar

import tomli_w
from pydantic import BaseModel, ConfigDict, ValidationError

from cliffscan.common.contract.message import explain
from cliffscan.common.runtime.settings import settings
from cliffscan.common.runtime.suggest import suggest

SENSING = ("capture", "negative", "positive", "fuse")
BASES = ("kobuki", "gate")  # one of them guards the base: of a TurtleBot 2, or of any make
SERVICES = (*SENSING, BASES[0])  # of a TurtleBot 2
FOLDERS = sorted(file.parent.name for file in (Path(__file__).parents[2] / "services").glob("*/config.py"))
CONFIGURED = (*SERVICES, *(name for name in FOLDERS if name not in SERVICES))  # every service that has settings
SHARED = {"scan": ("negative", "positive")}  # tables that several services read: what these must agree on
TABLES = (*SHARED, *CONFIGURED)
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
    TABLE: of a class that several services' classes derive from, the table of SHARED that its fields are read from.
    """

    PROFILES: ClassVar[Profiles] = {}
    TABLE: ClassVar[str] = ""

    model_config = ConfigDict(
        strict=True, frozen=True, extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True
    )

    def check(self) -> None:
        """Raise ConfigError, one line with the remedy, where a service cannot start with these values as they are.

        What other programs read of the table, and --dump-config, do without it.
        """


C = TypeVar("C", bound=ServiceConfig)


def home_tables(service: str, kind: type[ServiceConfig]) -> dict[str, str]:
    """The table that each field is read from: the service's own, or one that it shares."""
    homes = dict.fromkeys(kind.model_fields, service)
    for base in kind.__mro__:
        if "TABLE" in vars(base) and issubclass(base, ServiceConfig) and base.TABLE:
            homes |= dict.fromkeys(base.model_fields, base.TABLE)
    return homes


def load(service: str, kind: type[C], file: Path | None, overrides: Iterable[str]) -> C:
    """The configuration of `service` from its table in `file`, with `overrides` on top. Raises ConfigError.

    A file's `profile`, outside all tables, or the override profile=NAME says which defaults lie below.
    """
    profile, table = _given(service, kind, file, overrides)
    try:
        return kind.model_validate({**kind.PROFILES.get(profile, {}), **table})
    except ValidationError as error:
        first = error.errors()[0]["loc"]
        home = home_tables(service, kind).get(str(first[0]), service) if first else service
        raise ConfigError(f"{home}.{explain(error)}{_meant(kind, error)}") from error


def given(service: str, kind: type[ServiceConfig], file: Path | None, overrides: Iterable[str]) -> dict[str, Any]:
    """What `file` and `overrides` give `service`, whether it is valid or not. Raises ConfigError."""
    return _given(service, kind, file, overrides)[1]


def _given(
    service: str, kind: type[ServiceConfig], file: Path | None, overrides: Iterable[str]
) -> tuple[str, dict[str, Any]]:
    """The profile's name and the values that are given."""
    read = _read_tables(file) if file else {}
    homes = home_tables(service, kind)
    profile, tables = read.get(PROFILE, PROFILES[0]), {name: read.get(name, {}) for name in (service, *homes.values())}
    for override in overrides:
        key, equals, text = override.partition("=")
        if key.strip() == PROFILE and equals:
            profile = _profile(_value(text.strip()), f"--set {override}")
        else:
            _override(tables, service, override, kind)
    for name, table in tables.items():
        for key in table:
            if homes.get(key, name) != name:
                raise ConfigError(f"{name}.{key}: write {homes[key]}.{key}, for it has one home")
            if key not in homes and name != service:
                raise ConfigError(f"{name}.{key}: is not known here{suggest(key, homes)}")
    return profile, {key: value for table in tables.values() for key, value in table.items()}


def dump(configs: Mapping[str, ServiceConfig]) -> str:
    """The effective configuration of services by name, as TOML that load() reads back to the same.

    A comment above each value says what it means, one at a table's top what it lacks.
    """
    tables: dict[str, str] = {}
    for service, config in configs.items():
        homes = home_tables(service, type(config))
        for table in sorted(set(homes.values()), key=lambda name: name == service):
            lines = _lines([table], config, [name for name in homes if homes[name] == table])
            tables.setdefault(table, (_lack(config) if table == service else "") + "\n".join(lines) + "\n")
    return "\n".join(tables.values())


def meant_for(service: str, override: str) -> bool:
    """Whether a service takes this KEY=VALUE: one of its own values or of a table that it shares, or the profile."""
    tables = [service, *(table for table, readers in SHARED.items() if service in readers)]
    return override.startswith(tuple(f"{table}." for table in tables)) or override.partition("=")[0].strip() == PROFILE


def _lines(path: Sequence[str], config: ServiceConfig, names: Collection[str]) -> Iterator[str]:
    """The lines of the table at `path`, which has the fields `names`, then those of the tables below it."""
    yield from _header(path)
    values = config.model_dump(mode="json")
    below: list[str] = []
    for setting in settings(type(config)):
        comment = textwrap.wrap(setting.comment(), COMMENT_WIDTH, initial_indent="# ", subsequent_indent="# ")
        tables = getattr(config, setting.name)
        if setting.name not in names:
            continue
        if isinstance(tables, dict):
            below += ["", *comment, *_header([*path, setting.name])]
            for name, table in tables.items():
                below += ["", *_lines([*path, setting.name, name], table, type(table).model_fields)]
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
        if name not in TABLES:
            expected = ", ".join(TABLES)
            raise ConfigError(f"{file}: unknown table [{name}], expected one of {expected}{suggest(name, TABLES)}")
        if not isinstance(table, dict):
            raise ConfigError(f"{file}: {name} is no table; write [{name}] and its keys below")
    return tables


def _override(tables: dict[str, Any], service: str, override: str, kind: type[ServiceConfig]) -> None:
    """Set one value of the tables that `service` reads; a dotted key reaches into the tables below them.

    A text that looks like a number stays a text where the field is one.
    """
    key, equals, text = override.partition("=")
    head, *path = key.strip().split(".")
    if not equals or not path:
        raise ConfigError(f"--set {override}: expected {service}.KEY=VALUE")
    if head not in tables:
        readable = " and ".join(f"{name}.KEY" for name in tables)
        raise ConfigError(f"--set {override}: this service reads {readable} only{suggest(head, list(tables))}")
    table = tables[head]
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
