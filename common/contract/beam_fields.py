"""What a scan says of each of its beams: one row a field, from which all that handles scans follows.

A field's type and its row stand together. Messages are checked by the rows, combine and fuse treat the fields as they
say, and the table in common/README.md is tested against them.
"""

import math
from dataclasses import dataclass
from enum import Enum
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.message import Float32s, Part

Ranges = NDArray[np.float32]
ABSENT = np.empty(0, np.float32)  # of an optional field


class Combining(Enum):
    """What a beam of several scans has in a field."""

    NEAREST = "the nearest number; without one +inf only if all are"
    OF_NEAREST = "that of the nearest number, 0 without one"
    LEAST = "the least; a scan without the field counts up to its number"


@dataclass(frozen=True)
class BeamField:
    """A row: what the values mean, which are valid, and how those of several scans combine."""

    meaning: str
    unit: str
    combining: Combining
    optional: bool = True  # the field may have no values at all
    finite: bool = True
    least: float = -math.inf


class Beams(Part):
    """The fields of a scan's beams, from right to left: (beams,) each, or (0,) where an optional field is absent."""

    ranges: Annotated[
        Float32s,
        BeamField(
            "distance to the obstacle; +inf: looked, nothing; NaN: not seen",
            "m",
            Combining.NEAREST,
            optional=False,
            finite=False,
            least=0.0,
        ),
    ]
    intensities: Annotated[Float32s, BeamField("what the number rests on, see below", "Evidence", Combining.OF_NEAREST)]
    clear: Annotated[
        Float32s, BeamField("how far floor was seen throughout, see below", "m", Combining.LEAST, least=0.0)
    ] = ABSENT

    def arrays(self) -> dict[str, Ranges]:
        """Every field by name."""
        return {name: getattr(self, name) for name in BEAM_FIELDS}

    def up_to(self, name: str) -> Ranges:
        """How far [m] a field of Combining.LEAST goes: (beams,); absent, up to the number or +inf, and NaN nowhere."""
        values: Ranges = getattr(self, name)
        return values if len(values) else np.fmax(self.ranges, np.float32(0.0))


BEAM_FIELDS: dict[str, BeamField] = {
    name: row for name, field in Beams.model_fields.items() for row in field.metadata if isinstance(row, BeamField)
}


def check_beams(beams: Beams) -> None:
    """Raise ValueError where a field does not fit its row or the number of beams."""
    count = len(beams.ranges)
    for name, row in BEAM_FIELDS.items():
        values = getattr(beams, name)
        if len(values) != count and not (row.optional and len(values) == 0):
            raise ValueError(f"{name}: {len(values)} values for {count} beams")
        if row.finite and np.count_nonzero(np.isfinite(values)) < len(values):
            raise ValueError(f"{name}: not finite")
        if row.least > -math.inf and np.count_nonzero(values < row.least):
            raise ValueError(f"{name}: " + ("negative" if row.least == 0.0 else f"below {row.least:g}"))
