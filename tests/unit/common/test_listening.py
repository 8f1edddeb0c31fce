"""Other machines connect with keys, or because somebody says so."""

import re

import pytest

from cliffscan.common.runtime.endpoints import parse
from cliffscan.common.runtime.network import BusError, Network, check
from cliffscan.common.runtime.secure import Credentials
from cliffscan.secure.folder import KeyFolder

BEYOND = ["tcp/0.0.0.0:7447", "tcp/[::]:7447", "tcp/192.168.1.20:0", "tcp/robot:7447#so_sndbuf=1", "udp/10.0.0.1:1"]
LOCAL = ["tcp/127.0.0.1:7447", "tcp/[::1]:7447", "tcp/localhost:1", "tcp/127.0.0.1:1?prio=1-5", "unixsock-stream/x"]


@pytest.mark.parametrize("endpoint", [*BEYOND, "tls/0.0.0.0:7447", "quic/0.0.0.0:7447"])
def test_listening_beyond_this_machine_needs_keys(endpoint):
    with pytest.raises(BusError, match=r"--listen .*: add --secure DIR .*, or --insecure$"):
        check(Network("router", listen=[endpoint]))
    check(Network("router", listen=[endpoint], insecure=True))


@pytest.mark.parametrize("endpoint", LOCAL)
def test_listening_on_this_machine_does_not(endpoint):
    check(Network("router", listen=[endpoint]))


@pytest.mark.parametrize("mode", [None, "peer", "router", "client"])
@pytest.mark.parametrize("connect", [[], ["tcp/192.168.1.20:7447"]])
def test_nothing_listens_beyond_by_default(mode, connect):
    check(Network(mode, connect))


@pytest.mark.parametrize(
    ("text", "good"),
    [
        ("{ listen: { endpoints: ['tcp/0.0.0.0:1'] } }", False),
        ("{ mode: 'router', listen: { endpoints: { router: ['tcp/0.0.0.0:1'] } } }", False),
        ("{ mode: 'client', listen: { endpoints: { router: ['tcp/0.0.0.0:1'] } } }", True),
        ("{ listen: { endpoints: ['tls/0.0.0.0:1'] } }", False),
        ("{ listen: { endpoints: ['tls/0.0.0.0:1'] }, transport: { link: { tls: { enable_mtls: true } } } }", True),
        ("{ listen: { endpoints: ['tcp/0.0.0.0:1'] }, transport: { link: { tls: { enable_mtls: true } } } }", False),
    ],
)
def test_a_zenoh_file_is_held_to_it_too(tmp_path, text, good):
    file = tmp_path / "zenoh.json5"
    file.write_text(text)
    if good:
        check(Network(zenoh_config=file))
    else:
        with pytest.raises(BusError, match="--insecure"):
            check(Network(zenoh_config=file))


@pytest.fixture(scope="module")
def keys(tmp_path_factory):
    folder = tmp_path_factory.mktemp("keys") / "r"
    KeyFolder(folder).init("r", [])
    return folder


@pytest.mark.parametrize(
    ("role", "network", "why"),
    [
        ("fuse", {"connect": ["tcp/127.0.0.1:1"]}, "is not encrypted; with --secure write tls/ instead of tcp/"),
        ("fuse", {"listen": ["tls/127.0.0.1:1"]}, "--listen tls/127.0.0.1:1: with --secure fuse is a client"),
        ("fuse", {"mode": "peer"}, "--mode peer: with --secure fuse is a client"),
        ("fuse", {"zenoh_config": "x.json5"}, "--zenoh-config x.json5: --secure has a file of its own"),
        ("router", {"listen": ["tcp/127.0.0.1:1"]}, "is not encrypted"),
        ("router", {"connect": ["tcp/127.0.0.1:1"]}, "is not encrypted"),
    ],
)
def test_a_process_with_keys_has_no_other_way_in(keys, role, network, why):
    with pytest.raises(BusError, match=why):
        check(Network(secure=Credentials(keys, role, ["r"]), **network))


@pytest.mark.parametrize("role", ["router", "router-workstation", "fuse", "viewer"])
def test_a_process_with_keys_needs_no_more(keys, role):
    check(Network(secure=Credentials(keys, role, ["r"])))


def test_endpoints_are_read_as_zenoh_writes_them():
    assert parse("tls/[fe80::1]:7447?prio=6-7#so_sndbuf=65536") == ("tls", "fe80::1", 7447)
    assert parse("unixsock-stream/tmp/x") == ("unixsock-stream", "", 0)
    assert parse("tcp/robot.local") == ("tcp", "robot.local", 0)
    assert parse("tcp/[::1]") == ("tcp", "::1", 0)


@pytest.mark.parametrize(
    ("endpoint", "why"),
    [
        ("tcp/127.0.0.1", "names no port: write it as tcp/HOST:7447"),
        ("tcp/[::1]", "names no port: write it as tcp/HOST:7447"),
        ("tcp/:7447", "names no host: write it as tcp/HOST:7447"),
        ("robot.local:7447", "names no protocol: write it as tcp/HOST:PORT"),
        ("tcp/robot.local:65536", "there is no such port"),
        ("tcp/robot.local:99999999999999999999", "there is no such port"),
    ],
)
def test_an_endpoint_that_lacks_something_is_told_with_its_remedy(endpoint, why):
    with pytest.raises(BusError, match=f"{re.escape(endpoint)}: {why}"):
        check(Network(connect=[endpoint]))


def test_a_router_that_joins_another_one_is_found_by_the_processes_of_its_machine():
    found = "scouting/multicast/enabled"
    assert found not in Network("router", ["tcp/robot:7447"]).settings()
    assert Network("client", ["tcp/robot:7447"]).settings()[found] is False


def test_every_robot_of_a_process_must_be_the_keys(keys):
    with pytest.raises(BusError, match="is of robot 'r', expected 'q'"):
        check(Network(secure=Credentials(keys, "perception", ["r", "q"])))
