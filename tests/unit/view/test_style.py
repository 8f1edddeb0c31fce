"""The page's colours are those of the project's pictures, and are told apart in grey and without green."""

import re
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from cliffscan.common.contract.evidence import Evidence
from cliffscan.view.page_files import page_files
from evaluation import palette
from tests.unit.evaluation.test_palette import DEUTERANOPIA, IN_GREY, lab

PAGE = Path(__file__).parents[3] / "cliffscan/view/page"
STYLE = (PAGE / "style.css").read_text("utf-8")
LIGHT, DARK = (dict(re.findall(r"--([\w-]+): (#[0-9a-f]{6})\b", part)) for part in STYLE.split("@media")[:2])
NAMES = {
    Evidence.POSITIVE: "positive",
    Evidence.DROP: "drop",
    Evidence.FLOOR_LOST: "lost",
    Evidence.FARTHEST_FLOOR: "farthest",
    Evidence.EXTRA: "extra",
}


def least(values):
    return min(np.linalg.norm(one - other) for one, other in combinations(values, 2))


def test_evidence_has_the_colours_of_the_pictures():
    for evidence, name in NAMES.items():
        assert to_rgb(LIGHT[name]) == to_rgb(palette.EVIDENCE[evidence].colour)


@pytest.mark.parametrize("colours", [LIGHT, DARK], ids=["light", "dark"])
def test_evidence_is_told_apart(colours):
    shown = [colours[name] for name in NAMES.values()]
    assert least(lab(shown)[:, :1]) > IN_GREY
    assert least(lab(shown, DEUTERANOPIA)) > IN_GREY


@pytest.mark.parametrize("colours", [LIGHT, DARK], ids=["light", "dark"])
def test_text_is_read_on_what_it_stands(colours):
    for text, ground in (
        ("ink", "page"),
        ("ink", "panel"),
        ("faint", "panel"),
        ("alarm-ink", "alarm"),
        ("ink", "held"),
    ):
        lightness = lab([colours[text], colours[ground]])[:, 0]
        assert abs(lightness[0] - lightness[1]) > 40.0, (text, ground)


def test_nothing_is_loaded_from_elsewhere():
    for path, body in page_files().items():
        found = re.findall(r"(?:https?:)?//[\w.-]+\.\w+", body.decode().replace("http://www.w3.org/2000/svg", ""))
        assert found == [], path
