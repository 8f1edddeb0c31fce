"""An array of cells around a map's origin that grows where something is to be drawn."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

LARGEST = 1 << 24  # cells; a map that would be larger has a fault in its poses


class TooLarge(ValueError):
    """A map would have more cells than any map has; the text tells how many."""


class Span(NamedTuple):
    """Rows, or columns, from `first` to before `end`, counted from the map's origin."""

    first: int
    end: int

    @property
    def size(self) -> int:
        """How many they are."""
        return self.end - self.first

    def grown(self, needed: Span, margin: int) -> Span:
        """The span widened to hold the needed one, with a margin on each side that is widened."""
        if not self.size:
            return Span(needed.first - margin, needed.end + margin)
        first = self.first if needed.first >= self.first else needed.first - margin
        end = self.end if needed.end <= self.end else needed.end + margin
        return Span(first, end)

    def within(self, other: Span) -> slice:
        """Where this span lies in the array of the other."""
        return slice(self.first - other.first, self.end - other.first)


class Canvas:
    """Values of cells that may have negative rows and columns; 0 where nothing was drawn."""

    def __init__(self, margin: int) -> None:
        """`margin`: cells added on a side where it must grow, so that it need not grow with each drawing."""
        self.rows, self.columns = Span(0, 0), Span(0, 0)
        self.values = np.zeros((0, 0), np.float32)  # (rows, columns)
        self._margin = margin

    def window(self, rows: Span, columns: Span) -> NDArray[np.float32]:
        """A view of these cells to draw on; grows to hold them. Raises TooLarge."""
        self._grow(self.rows.grown(rows, self._margin), self.columns.grown(columns, self._margin))
        return self.values[rows.within(self.rows), columns.within(self.columns)]

    def _grow(self, rows: Span, columns: Span) -> None:
        if (rows, columns) == (self.rows, self.columns):
            return
        if rows.size * columns.size > LARGEST:
            raise TooLarge(f"the map would have {rows.size} x {columns.size} cells")
        values = np.zeros((rows.size, columns.size), np.float32)
        if self.values.size:
            values[self.rows.within(rows), self.columns.within(columns)] = self.values
        self.rows, self.columns, self.values = rows, columns, values
