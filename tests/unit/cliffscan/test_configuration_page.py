"""docs/configuration.md is what the configuration classes say."""

from pathlib import Path

from cliffscan.configuration_page import page

PAGE = Path(__file__).parents[3] / "docs/configuration.md"


def test_the_page_is_current():
    remedy = "run: python -m cliffscan.configuration_page > docs/configuration.md"
    assert page() == PAGE.read_text("utf-8"), remedy
