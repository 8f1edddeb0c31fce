"""Keys that a router would refuse are refused before they are shown, each with one line that says what to do."""

import errno
import os
import re
import shutil
from datetime import timedelta
from pathlib import Path

import pytest

from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.door import Keys
from cliffscan.common.runtime.network import BusError, Network, NotConnected
from cliffscan.common.runtime.secure import Credentials
from cliffscan.secure import authority
from cliffscan.secure.folder import KeyFolder


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Keys of two robots."""
    folder = tmp_path_factory.mktemp("keys")
    for robot in ("mine", "other"):
        KeyFolder(folder / robot).init(robot, [])
    return folder


@pytest.fixture
def keys(made, tmp_path):
    shutil.copytree(made, tmp_path / "keys")
    return tmp_path / "keys"


def missing_folder(keys):
    shutil.rmtree(keys / "mine/fuse")


def missing_file(keys):
    (keys / "mine/fuse/key.pem").unlink()


def missing_config(keys):
    (keys / "mine/fuse/zenoh.json5").unlink()


def garbage(keys):
    (keys / "mine/fuse/cert.pem").write_text("-----BEGIN")


def another_role(keys):
    shutil.copytree(keys / "mine/viewer", keys / "mine/fuse", dirs_exist_ok=True)


def another_ca(keys):
    shutil.copy(keys / "other/fuse/ca.pem", keys / "mine/fuse/ca.pem")


def another_robot(keys):
    shutil.copytree(keys / "other/fuse", keys / "mine/fuse", dirs_exist_ok=True)


def another_key(keys):
    shutil.copy(keys / "mine/viewer/key.pem", keys / "mine/fuse/key.pem")


def no_key(keys):
    (keys / "mine/fuse/key.pem").write_text("secret")


def expired(keys):
    KeyFolder(keys / "mine").issue("fuse", timedelta(minutes=-30))


@pytest.mark.parametrize(
    ("spoil", "why", "remedy"),
    [
        (missing_folder, "mine/fuse: is not there", "`cliffscan keys issue .*/mine fuse`"),
        (missing_file, "mine/fuse/key.pem: is not there", "`cliffscan keys issue .*/mine fuse`"),
        (missing_config, "mine/fuse/zenoh.json5: is not there", "`cliffscan keys renew .*/mine`"),
        (garbage, "mine/fuse/cert.pem: is no certificate", "`cliffscan keys issue"),
        (another_role, "mine/fuse/cert.pem: is the certificate of 'viewer', expected 'fuse'", "`cliffscan keys issue"),
        (another_ca, "mine/fuse/cert.pem: was issued by another CA than ca.pem", "`cliffscan keys issue"),
        (another_robot, "mine/fuse/cert.pem: is of robot 'other', expected 'mine'", "--robot other"),
        (another_key, "mine/fuse/key.pem: is not the key of cert.pem", "`cliffscan keys issue"),
        (no_key, "mine/fuse/key.pem: is no private key", "`cliffscan keys issue"),
        (expired, r"mine/fuse/cert.pem: expired on \d{4}-\d\d-\d\d", "`cliffscan keys renew .*/mine`"),
    ],
    ids=lambda value: getattr(value, "__name__", None),
)
def test_keys_that_are_wrong_are_refused_with_a_remedy(keys, spoil, why, remedy):
    spoil(keys)
    with pytest.raises(BusError, match=f"{why}.*{remedy}") as refused:
        Bus(Network(secure=Credentials(keys / "mine", "fuse", ["mine"])), "mine")
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("robot", ["mine", "mine/workstation"])
def test_keys_are_good_for_the_robot_and_a_perception_that_works_for_it(keys, robot):
    assert Keys.of(Credentials(keys / "mine", "perception", [robot])).robot == "mine"


@pytest.mark.parametrize("robots", [["*"], ["mine", "other"], ["mine/another"], ["min"]])
def test_keys_are_good_for_no_other_robot(keys, robots):
    with pytest.raises(
        BusError, match=f"is of robot 'mine', expected '{re.escape(robots[-1])}': give --robot mine alone"
    ):
        Bus(Network(secure=Credentials(keys / "mine", "perception", robots)), "mine")


def test_keys_of_another_user_are_refused_with_a_remedy(keys, monkeypatch):
    def denied(_file):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(Path, "exists", denied)
    with pytest.raises(BusError, match=r"mine/fuse: Permission denied: run this as the user whose keys"):
        Bus(Network(secure=Credentials(keys / "mine", "fuse", ["mine"])), "mine")


def test_a_certificate_of_the_future_is_for_a_clock_that_is_behind(keys, monkeypatch):
    monkeypatch.setattr(authority, "EARLIER", timedelta(days=-1))
    KeyFolder(keys / "mine").issue("fuse")
    with pytest.raises(NotConnected, match=r"is not valid before .* set the clock"):
        Bus(Network(secure=Credentials(keys / "mine", "fuse", ["mine"])), "mine")


@pytest.mark.parametrize(("days", "notice"), [(400, ""), (31, ""), (12, "expires in 11 days"), (-0.02, "has expired")])
def test_an_end_that_is_near_is_told(keys, days, notice):
    shown = Keys.of(Credentials(keys / "mine", "fuse", ["mine"]))
    KeyFolder(keys / "mine").issue("fuse", timedelta(days=days))
    assert notice in shown.expiry()
    assert bool(shown.expiry()) == bool(notice)
    assert not notice or "`cliffscan keys renew`" in shown.expiry()
