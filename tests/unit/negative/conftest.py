"""Hypothesis takes the same examples every time."""

from tests import build  # noqa: F401
