"""The table of roles in docs/security.md is the one in code."""

from pathlib import Path

from cliffscan.secure.page import table

PAGE = (Path(__file__).parents[3] / "docs/security.md").read_text("utf-8")


def test_the_table_of_roles_is_the_one_in_code():
    """`python -m cliffscan.secure.page` prints it."""
    assert table() in PAGE
