"""What is wrong with a recording or an option is one line that says what to do, before anything is connected."""

import sys

import pytest
from mcap.writer import Writer

from cliffscan import cli
from cliffscan.recording.mcap_file import McapFile
from tests.build import Stop


@pytest.fixture
def refused(monkeypatch, capsys):
    """The line with which a command ends that is used wrongly."""
    monkeypatch.setattr(cli, "StopSignal", Stop)

    def run(*words):
        monkeypatch.setattr(sys, "argv", ["cliffscan", *map(str, words)])
        with pytest.raises(SystemExit) as left:
            cli.main()
        assert left.value.code == 2
        *_, line = capsys.readouterr().err.strip().splitlines()
        return line

    return run


@pytest.fixture
def empty(tmp_path):
    """A recording of nothing."""
    path = tmp_path / "empty.mcap"
    with McapFile(path, "turtlebot"):
        pass
    return path


@pytest.fixture
def foreign(tmp_path):
    """An MCAP of another program."""
    path = tmp_path / "foreign.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        writer.finish()
    return path


@pytest.mark.parametrize("command", ["play", "replay-check"])
def test_what_is_no_recording_is_refused(command, refused, foreign, tmp_path):
    text = tmp_path / "text.mcap"
    text.write_text("hello")
    assert refused(command, tmp_path / "none.mcap").endswith("none.mcap: No such file or directory")
    assert refused(command, text).endswith("text.mcap is no MCAP file: it does not begin as one")
    line = refused(command, foreign)
    assert line.endswith("was not made by `cliffscan record`: play it with the program that made it")


def test_no_file_is_overwritten(refused, empty, tmp_path):
    expected = f"cliffscan: {empty} is there already: choose another name, or remove it"
    assert refused("record", empty) == expected
    assert refused("recover", empty, empty) == expected


@pytest.mark.parametrize("name", ["drive_0.mcap", "drive_1.mcap", "drive_12.mcap"])
def test_no_part_of_a_recording_is_overwritten(name, refused, empty, tmp_path):
    part = tmp_path / name
    empty.rename(part)
    assert refused("record", tmp_path / "drive.mcap", "--split-time", "9").startswith(f"cliffscan: {part} is there")


def test_a_file_without_a_whole_record_is_not_recovered(refused, empty, tmp_path):
    empty.write_bytes(empty.read_bytes()[:12])
    line = refused("recover", empty, tmp_path / "fixed.mcap")
    assert line == f"cliffscan: {empty} holds no whole record: there is nothing to recover"
    assert not (tmp_path / "fixed.mcap").exists()


def test_a_folder_that_is_not_there_and_a_full_disk_are_named(refused, tmp_path):
    assert refused("record", tmp_path / "none/a.mcap") == f"cliffscan: {tmp_path / 'none'}: No such file or directory"
    line = refused("record", tmp_path / "a.mcap", "--reserve", "900000G")
    assert line.endswith("a.mcap: its disk has less than 900000.0 GB left: make room, or lower --reserve")
    assert not (tmp_path / "a.mcap").exists()


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (
            ["--keys", "scan//fused"],
            "'scan//fused' is no key: write it below the robot's name, as scan/fused or scan/**",
        ),
        (["--split-size", "2 GB"], "'2 GB' is no size: a number of bytes, or one with k, M or G, as 500M"),
        (["--split-time", "0"], "0, expected a number above 0"),
        (["--images", "-1"], "-1, expected 0 or more"),
        (["--images", "1", "--no-ros"], "not allowed with argument"),
    ],
)
def test_a_wrong_option_is_named(words, expected, refused, tmp_path):
    assert expected in refused("record", tmp_path / "a.mcap", *words)


def test_a_missing_package_is_named(refused, monkeypatch, empty):
    for module in ("mcap.writer", "mcap.exceptions"):
        monkeypatch.setitem(sys.modules, module, None)
    for module in [name for name in sys.modules if name.startswith("cliffscan.recording.")]:
        if module.rpartition(".")[2] in ("reading", "mcap_file", "parts", "play"):
            monkeypatch.delitem(sys.modules, module)
    assert refused("play", empty).endswith(": pip install 'cliffscan[record]'")


def test_a_recording_without_frames_is_not_checked(refused, empty):
    expected = "holds 0 depth images and no scan of them: record camera/depth and scan/** at least"
    assert refused("replay-check", empty) == f"cliffscan: {empty} {expected}"
