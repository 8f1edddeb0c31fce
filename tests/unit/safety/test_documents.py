"""docs/safety.md says what the code does, and the tests that it names are there."""

import re
from pathlib import Path
from typing import get_args

from cliffscan.common.contract.base_messages import Rule as Name
from cliffscan.safety.rules import RULES

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs/safety.md").read_text("utf-8")


def test_the_table_of_rules_is_the_codes():
    table = PAGE.partition("## The rules")[2].partition("## Hazards")[0]
    rows = [line for line in table.splitlines() if line.startswith("| `")]
    assert rows == [f"| `{rule.name}` | {rule.holds} | {rule.does} |" for rule in RULES]


def test_every_rule_on_the_wire_is_in_the_table():
    assert {rule.name for rule in RULES} == set(get_args(Name))


def test_the_tests_that_show_a_rule_are_there():
    named = re.findall(r"(?:unit|service)/[\w/]*\.py", PAGE)
    assert len(named) > 20
    assert [each for each in named if not (ROOT / "tests" / each).is_file()] == []
