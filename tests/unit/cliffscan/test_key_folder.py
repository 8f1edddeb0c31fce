"""What `cliffscan keys` writes, finds wrong and renews."""

import errno
import json
import os
import re
import shutil
import stat
from datetime import timedelta
from pathlib import Path

import pytest
import zenoh

from cliffscan.cli import build_parser
from cliffscan.common.contract.roles import role_names
from cliffscan.common.runtime.identity import read_certificate
from cliffscan.common.runtime.secure import FILES, SecureError, unreadable
from cliffscan.secure import authority
from cliffscan.secure.folder import KeyFolder


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("keys") / "robot"
    KeyFolder(folder).init("r", ["robot.local", "10.0.0.2"])
    return folder


@pytest.fixture
def keys(made, tmp_path):
    shutil.copytree(made, tmp_path / "keys")
    folder = KeyFolder(tmp_path / "keys")
    folder.renew()  # the Zenoh files name another place
    return folder


def wrong(folder):
    return {role: line for role, line, good in folder.check() if not good}


def cliffscan(*words):
    arguments = build_parser().parse_args(["keys", *map(str, words)])
    return arguments.command(arguments, None)


def test_each_role_has_its_files_and_nobody_else_reads_the_secret_ones(made):
    assert {each.name for each in made.iterdir()} == {"ca", *role_names()}
    for role in role_names():
        assert {each.name for each in (made / role).iterdir()} == set(FILES)
    for secret in made.glob("*/key.pem"):
        assert stat.S_IMODE(secret.stat().st_mode) == 0o600
        assert stat.S_IMODE(secret.parent.stat().st_mode) == 0o700


@pytest.mark.parametrize("role", role_names())
def test_any_zenoh_program_opens_a_roles_file(made, role):
    config = zenoh.Config.from_file(str(made / role / "zenoh.json5"))
    router = role.startswith("router")
    assert json.loads(config.get_json("mode")) == ("router" if router else "client")
    assert json.loads(config.get_json("transport/shared_memory/enabled")) is False
    assert json.loads(config.get_json("transport/link/tls/connect_private_key")) == str(made / role / "key.pem")
    assert json.loads(config.get_json("access_control/enabled")) is router


def test_the_workstations_router_joins_the_robots_host(made):
    text = (made / "router-workstation/zenoh.json5").read_text()
    assert '"tls/robot.local:7447"' in text


def test_what_was_made_is_well(made, capsys):
    assert cliffscan("check", made) == 0
    assert capsys.readouterr().out.count("ok ") == len(role_names())


def test_keys_are_for_a_domain_of_ros(tmp_path, made):
    assert cliffscan("init", tmp_path / "keys", "--robot", "r", "--ros-domain", "5") == 0
    rules = (tmp_path / "keys/router/zenoh.json5").read_text()
    assert '"5/**"' in rules
    assert '"0/**"' not in rules
    assert '"0/**"' in (made / "router/zenoh.json5").read_text()


@pytest.mark.parametrize("robot", ["5", "5/r"])
def test_a_robot_whose_keys_would_be_those_of_ros_gets_none(tmp_path, robot):
    with pytest.raises(SecureError, match=f"--robot {robot}: its keys would be those of ROS domain 5"):
        KeyFolder(tmp_path / "keys").init(robot, [], ros_domain=5)
    assert not (tmp_path / "keys").exists()


@pytest.mark.parametrize("host", ["rübe", "robot.local:7447", "tcp/robot.local", "two words"])
def test_a_host_that_no_certificate_can_name_is_refused_before_anything_is_made(tmp_path, host):
    with pytest.raises(SecureError, match=f"--host {host}: is no host's name"):
        KeyFolder(tmp_path / "keys").init("r", ["robot.local", host])
    assert not (tmp_path / "keys").exists()


@pytest.mark.parametrize("place", ["file", "file/keys"])
def test_keys_are_not_made_where_a_file_is(tmp_path, place):
    (tmp_path / "file").write_text("")
    with pytest.raises(SecureError, match="Not a directory; name another folder"):
        KeyFolder(tmp_path / place).init("r", [])


def test_keys_are_never_overwritten(made):
    with pytest.raises(SecureError, match="is not empty"):
        KeyFolder(made).init("r", [])


@pytest.mark.parametrize(
    ("spoil", "role", "why"),
    [
        (lambda d: (d / "fuse/key.pem").chmod(0o644), "fuse", r"others may read it \(644\): `chmod 600"),
        (lambda d: (d / "ca/key.pem").chmod(0o640), "ca", r"others may read it \(640\)"),
        (lambda d: (d / "fuse/cert.pem").unlink(), "fuse", "is not there"),
        (lambda d: shutil.copy(d / "viewer/cert.pem", d / "fuse"), "fuse", "is the certificate of 'viewer'"),
        (lambda d: KeyFolder(d).issue("fuse", timedelta(days=29)), "fuse", "28 days: `cliffscan keys renew"),
        (lambda d: KeyFolder(d).issue("fuse", timedelta(minutes=-1)), "fuse", "expired on"),
        (lambda d: (d / "fuse/zenoh.json5").write_text("{"), "fuse", "is no Zenoh file: `cliffscan keys renew"),
        (lambda d: (d / "router/zenoh.json5").write_text("{}"), "router", "so_sndbuf is None"),
    ],
)
def test_check_finds_what_is_wrong(keys, spoil, role, why, capsys):
    spoil(keys.directory)
    found = wrong(keys)
    assert list(found) == [role]
    assert cliffscan("check", keys.directory) == 1
    assert re.search(why, found[role])
    assert re.search(why, capsys.readouterr().out)


def test_rules_that_were_loosened_are_noticed_and_renewed(keys):
    file = keys.directory / "router/zenoh.json5"
    file.write_text(file.read_text().replace('"deny"', '"allow"'))
    assert "keeps other rules" in wrong(keys)["router"]
    assert keys.renew() == ["router"]
    assert wrong(keys) == {}


def test_a_folder_that_was_moved_is_renewed(made, tmp_path):
    shutil.copytree(made, tmp_path / "moved")
    folder = KeyFolder(tmp_path / "moved")
    assert set(wrong(folder)) == set(role_names())
    assert set(folder.renew()) == set(role_names())
    assert wrong(folder) == {}


def test_renewing_keeps_the_key_and_changes_the_certificate(keys):
    before = {name: (keys.directory / "fuse" / name).read_bytes() for name in FILES}
    assert keys.renew() == []
    after = {name: (keys.directory / "fuse" / name).read_bytes() for name in FILES}
    assert [name for name in FILES if before[name] != after[name]] == ["cert.pem"]


def test_no_certificate_outlives_the_authority_whose_end_is_told_in_time(tmp_path, monkeypatch):
    monkeypatch.setattr(authority, "CA_LIFE", timedelta(days=20))
    keys = KeyFolder(tmp_path / "keys")
    keys.init("r", [])
    ends = {read_certificate(tmp_path / "keys" / name / "cert.pem").not_valid_after_utc for name in ("ca", "fuse")}
    assert max(ends) - min(ends) < timedelta(minutes=1)
    assert re.search("ends on .*, and all keys with it: make others by `cliffscan keys init`", wrong(keys)["ca"])


def test_a_sensor_gets_keys_and_the_routers_a_rule(keys, capsys):
    assert cliffscan("issue", keys.directory, "sensor-lidar") == 0
    assert "copy their zenoh.json5" in capsys.readouterr().out
    assert '"r/scan/lidar"' in (keys.directory / "router/zenoh.json5").read_text()
    assert wrong(keys) == {}
    assert cliffscan("issue", keys.directory, "sensor-lidar") == 0
    assert "zenoh.json5" not in capsys.readouterr().out


@pytest.mark.parametrize("role", ["negativ", "sensor-", "sensor-a/b", "sensor-*", "sensor-fused", "../ca", ""])
def test_what_is_no_role_gets_no_keys(keys, role):
    with pytest.raises(SecureError, match="is no role: there are router, "):
        keys.issue(role)


def test_a_sensor_whose_name_no_certificate_holds_gets_nothing(keys):
    role = f"sensor-{'x' * 60}"
    with pytest.raises(SecureError, match="a certificate has room for 64 characters"):
        keys.issue(role)
    assert not (keys.directory / role).exists()


def test_without_the_ca_nothing_is_made(keys):
    shutil.rmtree(keys.directory / "ca")
    with pytest.raises(SecureError, match=r"ca/key.pem: No such file .*: run this where `cliffscan keys init`"):
        keys.issue("fuse")
    assert wrong(keys) == {}


def test_the_cas_key_may_be_kept_elsewhere(keys):
    (keys.directory / "ca/key.pem").unlink()
    assert wrong(keys) == {}


def test_no_folder_has_no_keys(tmp_path):
    with pytest.raises(SecureError, match="has no keys; `cliffscan keys init"):
        list(KeyFolder(tmp_path).check())


@pytest.mark.parametrize("file", ["key.pem", "made_for.json", "cert.pem"])
def test_a_ca_that_was_damaged_is_told_with_a_remedy(keys, file):
    (keys.directory / "ca" / file).write_bytes(b"")
    with pytest.raises(SecureError, match=f"ca/{file}: is .* copy ca/ from where it is whole"):
        keys.issue("fuse")


def test_a_zenoh_file_that_is_no_text_is_told_and_renewed(keys):
    (keys.directory / "fuse/zenoh.json5").write_bytes(b"\xff\xfe")
    assert [line for role, line, good in keys.check() if role == "fuse" and not good]
    assert "fuse" in keys.renew()
    assert all(good for *_, good in keys.check())


def test_what_cannot_be_written_is_told(keys, monkeypatch):
    def denied(*_):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))

    monkeypatch.setattr(os, "open", denied)
    with pytest.raises(SecureError, match="Permission denied: run this as the user whose keys they are"):
        keys.renew()


def test_another_users_folder_is_told_from_one_without_keys(keys, monkeypatch):
    def denied(path):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))

    monkeypatch.setattr(Path, "exists", denied)
    assert "Permission denied: run this as the user whose" in unreadable(keys.directory)
    monkeypatch.undo()
    assert unreadable(keys.directory) == unreadable(keys.directory / "none") == ""
