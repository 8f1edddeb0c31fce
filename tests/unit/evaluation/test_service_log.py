"""What the services log goes into a file; complaints are handed on, each once."""

import os
import subprocess
import sys

from evaluation.processes.service_log import STDERR, ServiceLog, complaint


def line(level, text):
    return f"2026-01-31 12:00:00,123 {level} {text}"


def test_only_complaints_and_what_is_no_log_line_are_for_people():
    assert complaint(line("INFO", "fuse: ready")) == ""
    assert complaint(line("WARNING", "capture: bad_frame (3 so far): a.png")) == "capture: bad_frame: a.png"
    assert complaint("capture: no PNG in it") == "capture: no PNG in it"
    assert complaint("") == ""


def test_this_process_and_its_children_write_into_the_file(tmp_path):
    before = os.fstat(STDERR)
    with ServiceLog(tmp_path / "log") as log:
        log.silence("fuse: known")
        os.write(STDERR, f"{line('WARNING', 'fuse: late (1 so far)')}\n{line('ERROR', 'fuse: known')}\nhalf".encode())
        assert log.complaints() == ["fuse: late"]
        child = "import sys; sys.stderr.write(' a line\\n')"
        subprocess.run([sys.executable, "-c", child], check=True)
        os.write(STDERR, f"{line('WARNING', 'fuse: late (2 so far)')}\n".encode())
        assert log.complaints() == ["half a line"]
        assert log.complaints() == []
    assert os.fstat(STDERR).st_ino == before.st_ino
    assert len((tmp_path / "log").read_text().splitlines()) == 4
