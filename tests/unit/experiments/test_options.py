"""What the demo's command line refuses before anything starts."""

import pytest

from experiments.cli import build_parser


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--frames", "0"], "expected a whole number above 0"),
        *((["--map", "--route", route], "argument --route") for route in ("", "1", "1,2,3", "a,b")),
    ],
)
def test_a_number_that_means_nothing_is_refused(capsys, words, told):
    with pytest.raises(SystemExit, match="2"):
        build_parser().parse_args(words)
    assert told in capsys.readouterr().err
