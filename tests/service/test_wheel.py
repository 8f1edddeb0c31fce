"""The wheel: one top-level package, with its data, that works beside folders and packages called like its parts."""

import os
import shutil
import subprocess
import sys
import zipfile
from functools import partial
from pathlib import Path

import pytest

from cliffscan.common.runtime.config import SENSING
from tests.build import depth_folder
from tests.service.conftest import DEADLINE, free_endpoint

TOP = Path(__file__).parents[2]
SOURCES = ["pyproject.toml", "README.md", "LICENSE", "cliffscan", "common", "safety", "services", "simulator"]
DATA = {"common/README.md", "py.typed", "recording/definitions.msg", "simulator/turtlebot2.xml"}


@pytest.fixture
def wheel(tmp_path):
    """Built from a copy, for a build writes into its folder."""
    source = tmp_path / "source"
    source.mkdir()
    for name in SOURCES:
        if (TOP / name).is_dir():
            shutil.copytree(TOP / name, source / name, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(TOP / name, source)
    build = "from setuptools.build_meta import build_wheel; build_wheel('..')"
    subprocess.run([sys.executable, "-c", build], cwd=source, check=True, capture_output=True, timeout=2 * DEADLINE)
    return next(tmp_path.glob("*.whl"))


def test_the_wheel_holds_one_package_and_its_data(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    top = {name.partition("/")[0] for name in names}
    assert sorted(top) == ["cliffscan", next(each for each in top if each.endswith(".dist-info"))]
    worlds = {str(world.relative_to(TOP)) for world in (TOP / "simulator/worlds").glob("*.xml")}
    page = {f"view/page/{file.name}" for file in (TOP / "cliffscan/view/page").iterdir()}
    assert worlds
    assert page
    assert {f"cliffscan/{name}" for name in DATA | worlds | page} <= names
    assert not [name for name in names if name.endswith((".nbi", ".nbc", ".pyc"))]


@pytest.fixture
def installed(wheel, tmp_path):
    """Runs the wheel's command in a folder, and beside packages, that are called like its parts."""
    site, folder = tmp_path / "site", tmp_path / "folder"
    zipfile.ZipFile(wheel).extractall(site)
    for name in ("common", "safety", "services", "simulator"):
        (folder / name).mkdir(parents=True)
        (site / name).mkdir()
        (site / name / "__init__.py").write_text(f"raise ImportError('this {name} is of somebody else')\n")
    # JIT is off, for this wheel's kernels are in no cache and take long to compile.
    environment = os.environ | {"PYTHONPATH": str(site), "NUMBA_DISABLE_JIT": "1"}
    return partial(
        subprocess.Popen, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def cliffscan(*words):
    return [sys.executable, "-m", "cliffscan", *words]


def ask(installed, *words):
    """What a command prints."""
    with installed(cliffscan(*words)) as process:
        printed, errors = process.communicate(timeout=DEADLINE)
    assert process.returncode == 0, errors
    return printed


def test_the_wheel_works_beside_others_of_the_same_names(installed, tmp_path, client):
    replay = ["--set", "capture.source=replay", "--set", f"capture.path={depth_folder(tmp_path)}"]
    place = ["--robot", client.robot, "--connect", client.endpoint]
    with installed(cliffscan("up", "--listen", free_endpoint(), *place, "--base", "none", *replay)) as up:
        try:
            for service in SENSING:
                client.wait_alive(service)
            assert client.listen("scan/fused").get()
            assert "working" in ask(installed, "status", *place)
        finally:
            up.terminate()
        assert up.wait(DEADLINE) == 0
    assert "[kobuki]" in ask(installed, "run", "kobuki", "--dump-config")
    assert 'world = "office"' in ask(installed, "up", "--world", "office", "--dump-config")
