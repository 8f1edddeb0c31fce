"""docs/glossary.md explains every counter and state that a user can see."""

import re
from pathlib import Path
from typing import get_args

from cliffscan.common.contract.messages import State

TOP = Path(__file__).parents[3]
CODE = ["common", "safety", "services"]
COUNTED = re.compile(
    r"""(?:warn_limited|_warn|metrics\.count|Oddity)\(\s*"(\w+)"  # a call with the counter's name
    | _counts\["(\w+)"\]""",
    re.VERBOSE,
)
SHOWN = re.compile(r"state = \"([a-z ]+)\"|return \"([a-z ]+)\" if|return \"([a-z ]+)\", ")


def rows(heading):
    """The first cells of the table below a heading."""
    section = (TOP / "docs/glossary.md").read_text("utf-8").split(f"## {heading}\n")[1].split("\n## ")[0]
    return re.findall(r"^\| `([^`]+)` \|", section, re.MULTILINE)


def found(pattern, files):
    return {name for file in files for groups in pattern.findall(file.read_text("utf-8")) for name in groups if name}


def test_every_counter_is_explained():
    counted = found(COUNTED, [file for folder in CODE for file in (TOP / folder).rglob("*.py")])
    assert len(counted) > 10
    explained = rows("Counters")
    assert sorted(counted) == sorted(explained)


def test_every_state_is_explained():
    shown = found(SHOWN, [TOP / "cliffscan/health.py"])
    assert {"gone", "alive", "not found"} <= shown
    assert sorted(shown | set(get_args(State))) == sorted(rows("States"))
