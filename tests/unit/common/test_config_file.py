"""A file that is no configuration is refused with one line that names it."""

import pytest

from cliffscan.common.runtime.config import ConfigError, load
from cliffscan.services.capture.config import CaptureConfig

LONG = "9" * 5000
DEEP = "[" * 5000
WRONG = {
    "no TOML": ("[capture]\nrate=\n", "line 2"),
    "a key twice": ("[capture]\nrate=1\nrate=2\n", "line 3"),
    "no UTF-8": (b"\xff\xfe", "utf-8"),
    "a byte-order mark": ("\ufeff[capture]\n", "Invalid statement"),
    "a null byte": ("\x00", "Invalid statement"),
    "an unknown table": ("[camera]\n", "unknown table [camera]"),
    "a table for the robot": ("name = 'r'\n", "unknown table [name]"),
    "no table": ("capture = 5\n", "capture is no table"),
    "an array of tables": ("[[capture]]\n", "capture is no table"),
    "no table of another service": ("negative = 5\n", "negative is no table"),
}


def refusal(file, *overrides):
    with pytest.raises(ConfigError) as refused:
        load("capture", CaptureConfig, file, overrides)
    assert "\n" not in str(refused.value)
    return str(refused.value)


@pytest.mark.parametrize("kind", WRONG)
def test_a_file_that_is_wrong_is_refused_by_its_name(kind, tmp_path):
    text, reason = WRONG[kind]
    path = tmp_path / "robot.toml"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    message = refusal(path)
    assert message.startswith(f"{path}: ")
    assert reason in message


def test_a_file_that_is_not_there_is_named(tmp_path):
    assert "No such file" in refusal(tmp_path / "none.toml")
    assert "directory" in refusal(tmp_path)


def test_windows_line_ends_do_not_matter(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_bytes(b"[capture]\r\nrate = 5\r\n")
    assert load("capture", CaptureConfig, path, []).rate == 5.0


def test_a_value_in_a_file_is_refused_by_its_key(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text('[capture]\nrate = "fast"\nsorce = 1\n')
    message = refusal(path)
    assert message.startswith("capture.rate: ")
    assert "sorce: is not known here" in message


@pytest.mark.parametrize("value", [LONG, DEEP, "0x" + "f" * 5000], ids=["digits", "brackets", "hex"])
def test_an_absurd_value_is_refused_like_any_other(value, tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text(f"[capture]\nrate = {value}\n")
    assert str(path) in (refusal(path)) or "capture.rate" in refusal(path)
    assert "capture.rate" in refusal(None, f"capture.rate={value}")


def test_a_key_of_two_lines_is_refused_with_one(tmp_path):
    path = tmp_path / "robot.toml"
    path.write_text('[capture]\n"a\\nb" = 5\n')
    assert "capture.a" in refusal(path)
