"""A misspelt word is answered with the one that it may have meant."""

import pytest

from cliffscan.common.runtime import config
from cliffscan.common.runtime.config import SERVICES, ConfigError
from cliffscan.common.runtime.suggest import suggest
from cliffscan.services.negative.config import NegativeConfig


@pytest.mark.parametrize(("word", "meant"), [("fuze", "fuse"), ("kobuky", "kobuki"), ("negatve", "negative")])
def test_what_is_like_a_known_word_is_named(word, meant):
    assert suggest(word, SERVICES) == f"; did you mean {meant}?"


def test_what_is_like_none_is_answered_with_nothing():
    assert suggest("xyz", SERVICES) == ""


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("[negatve]\nbeams = 3", r"unknown table \[negatve\], expected .*; did you mean negative\?$"),
        ("[scan]\nflor_band = 0.1", r"^scan\.flor_band: is not known here; did you mean floor_band\?$"),
        ("[negative]\ncolour = 1", r"^negative\.colour: is not known here$"),
    ],
)
def test_a_file_is_answered_so(text, why, tmp_path):
    file = tmp_path / "robot.toml"
    file.write_text(text)
    with pytest.raises(ConfigError, match=why):
        config.load("negative", NegativeConfig, file, [])


def test_a_service_is_answered_so():
    with pytest.raises(
        ConfigError, match=r"this service reads negative\.KEY and scan\.KEY only; did you mean negative\?$"
    ):
        config.load("negative", NegativeConfig, None, ["negatve.beams=3"])
