"""The keys of a host."""

import shutil
from datetime import timedelta

from cliffscan.doctor.command import check_keys
from cliffscan.doctor.finding import Level
from cliffscan.secure.folder import KeyFolder


def levels(folder, connect=(), robot="turtlebot"):
    return {each.subject: each.level for each in check_keys(folder, list(connect), robot)}


def test_no_keys_are_told_only_where_others_connect():
    assert levels(None) == levels(None, ["tcp/127.0.0.1:7447"]) == {}
    assert levels(None, ["tcp/robot:7447"]) == {"keys": Level.WARNING}


def test_each_role_s_keys_are_looked_at(tmp_path):
    assert levels(tmp_path) == {"keys": Level.FAULT}
    made = KeyFolder(tmp_path / "keys")
    made.init("turtlebot", [])
    here = tmp_path / "here"
    for role in ("router", "viewer", "fuse"):
        shutil.copytree(tmp_path / "keys" / role, here / role)
    assert set(levels(here).values()) == {Level.OK}
    assert set(levels(here, robot="other").values()) == {Level.FAULT}
    made.issue("fuse", timedelta(days=3))
    shutil.copytree(tmp_path / "keys/fuse", here / "fuse", dirs_exist_ok=True)
    (here / "viewer/key.pem").unlink()
    assert levels(here) == {
        "keys of fuse": Level.WARNING,
        "keys of router": Level.OK,
        "keys of viewer": Level.FAULT,
    }
