"""Kernels compile where neither the home nor the package can be written."""

import os
import shutil
import stat
import sys
from pathlib import Path

import pytest

from cliffscan.common.runtime import kernel_cache

ROOT = Path(__file__).parents[2]


@pytest.fixture
def read_only(tmp_path):
    """A copy of the sources beside which nothing can be kept, not even by root: a file has the folder's name."""
    for package in ("common", "services"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
    for folder in ("common", "services/positive"):
        (tmp_path / folder / "__pycache__").touch()
    return tmp_path


def test_a_service_works_where_nothing_can_be_cached(client, run, read_only, tmp_path_factory):
    temporary = tmp_path_factory.mktemp("temporary")
    code = "import os, sys; os.chdir(sys.argv[1]); os.execv(sys.executable, [sys.executable, *sys.argv[2:]])"
    service = ["-m", "services.positive", "--robot", client.robot, "--connect", client.endpoint]
    nowhere = {
        "HOME": "/dev/null",
        "XDG_CACHE_HOME": "/dev/null/cache",
        "NUMBA_CACHE_DIR": "",
        "TMPDIR": str(temporary),
        "NUMBA_OPT": "0",  # slow kernels that compile soon
    }
    process = run([sys.executable, "-c", code, str(read_only), *service], **nowhere)
    client.wait_alive("positive")
    kept = temporary / f"cliffscan-kernels-{os.getuid()}"
    process.wait_said("no cache folder is writable")
    assert process.said.count(f"no cache folder is writable: compiled kernels are kept in {kept}\n") == 1
    assert any(kept.rglob("*.nbi"))
    assert stat.S_IMODE(kept.stat().st_mode) == 0o700


@pytest.mark.parametrize("taken", ["writable by all", "a link", "a file"])
def test_a_folder_that_others_can_write_to_is_not_used(taken, tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    usual = tmp_path / f"cliffscan-kernels-{os.getuid()}"
    if taken == "writable by all":
        usual.mkdir()
        usual.chmod(0o777)
    elif taken == "a link":
        (tmp_path / "elsewhere").mkdir()
        usual.symlink_to(tmp_path / "elsewhere")
    else:
        usual.touch()
    for variable, value in (("HOME", "/dev/null"), ("XDG_CACHE_HOME", "/dev/null/x"), (kernel_cache.VARIABLE, "")):
        monkeypatch.setenv(variable, value)
    monkeypatch.setattr(kernel_cache, "COMMON", [])
    kernel_cache.ensure_writable(["/dev/null"])
    chosen = Path(os.environ[kernel_cache.VARIABLE])
    assert chosen.parent == tmp_path
    assert chosen != usual


def test_where_a_cache_is_writable_nothing_is_changed(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv(kernel_cache.VARIABLE, raising=False)
    kernel_cache.ensure_writable(["/dev/null"])
    assert kernel_cache.VARIABLE not in os.environ
