"""What each setting means, in words, as its configuration class says it."""

import re
from collections.abc import Iterator
from typing import Literal, NamedTuple, get_args, get_origin

from annotated_types import BaseMetadata, Ge, Gt, Le, Lt, MaxLen, MinLen
from pydantic import BaseModel
from pydantic.fields import FieldInfo

UNIT = re.compile(r" ?\[([^\]]+)\]")  # in a field's docstring


class Setting(NamedTuple):
    """One field of a configuration class."""

    name: str
    field: FieldInfo

    @property
    def meaning(self) -> str:
        """Its docstring in one line; the unit is in brackets."""
        return " ".join((self.field.description or "").split())

    @property
    def unit(self) -> str:
        """The docstring's first brackets; empty where a value has no unit, `1` for a ratio."""
        found = UNIT.search(self.meaning)
        return found[1] if found else ""

    @property
    def allowed(self) -> str:
        """Which values are taken, as `above 0, at most 20`; empty where any of the type is."""
        choices = ", ".join(f'"{each}"' for each in _choices(self.field.annotation))
        several = get_origin(self.field.annotation) is tuple
        quantity = "any" if several else "one"
        words = [f"{quantity} of {choices}"] if choices else []
        words += [_bound(each, several) for each in self.field.metadata if isinstance(each, BaseMetadata)]
        return ", ".join(filter(None, words))

    def comment(self) -> str:
        """Meaning, unit and range in one line."""
        allowed = self.allowed
        return f"{self.meaning} {allowed[0].upper()}{allowed[1:]}." if allowed else self.meaning


def settings(kind: type[BaseModel]) -> Iterator[Setting]:
    """The settings of a configuration class, in order."""
    return (Setting(name, field) for name, field in kind.model_fields.items())


def _choices(annotation: object) -> Iterator[str]:
    """The words of every Literal in a type."""
    if get_origin(annotation) is Literal:
        yield from get_args(annotation)
    else:
        for part in get_args(annotation):
            yield from _choices(part)


def _bound(limit: BaseMetadata, several: bool) -> str:
    match limit:
        case Gt(gt=least):
            return f"above {least:g}"
        case Ge(ge=least):
            return f"at least {least:g}"
        case Lt(lt=most):
            return f"below {most:g}"
        case Le(le=most):
            return f"at most {most:g}"
        case MinLen(min_length=least):
            return f"at least {least} of them"
        case MaxLen(max_length=most):
            return f"at most {most} of them" if several else f"at most {most} characters"
    return ""
