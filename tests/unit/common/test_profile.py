"""A profile says which defaults lie below everything that is configured."""

import pytest

from cliffscan.common.runtime.config import ConfigError, load
from cliffscan.services.fuse.config import FuseConfig
from cliffscan.services.negative.config import NegativeConfig
from cliffscan.services.positive.config import PositiveConfig

PAPER = ("farthest_point", "virtual_floor")


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text("profile = 'paper'\n[scan]\nbeams = 90\n")
    return path


def negative(file, *overrides):
    return load("negative", NegativeConfig, file, overrides)


def test_by_default_near_edge_runs_alone():
    assert NegativeConfig().methods == negative(None, "profile=default").methods == ("near_edge",)


def test_paper_is_the_papers_pipeline():
    paper = negative(None, "profile=paper")
    assert paper.methods == PAPER
    assert paper == NegativeConfig(methods=PAPER)


def test_a_file_may_name_the_profile(file):
    assert negative(file) == NegativeConfig(methods=PAPER, beams=90)


def test_the_command_line_wins_over_the_file(file):
    assert negative(file, "profile=default") == NegativeConfig(beams=90)


def test_what_is_configured_wins_over_the_profile_wherever_it_stands(file):
    for overrides in (["negative.methods=['near_edge']", "profile=paper"], ["negative.methods=['near_edge']"]):
        assert negative(file, *overrides).methods == ("near_edge",)


def test_a_profile_leaves_the_services_alone_that_it_does_not_name(file):
    assert load("fuse", FuseConfig, file, []) == FuseConfig()
    assert load("fuse", FuseConfig, None, ["profile=paper"]) == FuseConfig()


def test_the_papers_floor_is_flat():
    assert load("positive", PositiveConfig, None, ["profile=paper"]) == PositiveConfig(flat_floor=True)


@pytest.mark.parametrize("profile", ["scissors", "", "Paper", "paper x"])
def test_an_unknown_profile_is_refused_with_the_known_ones(profile):
    with pytest.raises(ConfigError, match=r"^--set profile=.*: profile '.*' is none of default, paper$"):
        negative(None, f"profile={profile}")


@pytest.mark.parametrize(
    "text", ["profile = 'scissors'", "profile = 5", "profile = ['paper']", "[profile]\npaper = true"]
)
def test_an_unknown_profile_in_a_file_is_refused_too(text, tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(text)
    with pytest.raises(ConfigError, match=r"is none of default, paper$"):
        negative(path)
