"""The project's settings hold with a Zenoh file too, but for what the file itself says."""

import json

import pytest
import zenoh

from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.network import BusError, Network
from cliffscan.common.runtime.zenoh_config import BETWEEN_ROUTERS, DEFAULTS, build


def values(config, keys=DEFAULTS):
    return {key: json.loads(config.get_json(key)) for key in keys}


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "zenoh.json5"
        path.write_text(text)
        return path

    return write


def test_without_a_file_the_defaults_hold():
    assert values(build({}, None)) == DEFAULTS


@pytest.mark.parametrize(
    "text",
    [
        "{}",
        "{ mode: 'client', }",
        "{ transport: { link: { tls: { root_ca_certificate: '/ca.pem' } } } } // TLS",
        "{ transport: { shared_memory: {} } }",
    ],
)
def test_what_a_file_does_not_set_stays(file, text):
    assert values(build({}, file(text))) == DEFAULTS


def test_a_files_own_value_holds_even_where_it_is_zenohs_default(file):
    config = build({}, file("{ transport: { shared_memory: { enabled: true }, link: { tx: { lease: 10000 } } } }"))
    own = {"transport/shared_memory/enabled": True, "transport/link/tx/lease": 10_000}
    assert values(config) == DEFAULTS | own


def test_an_option_holds_over_a_file(file):
    assert json.loads(build({"mode": "peer"}, file("{ mode: 'client' }")).get_json("mode")) == "peer"


WHERE = ["listen/endpoints", "scouting/multicast/interface"]


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"connect/endpoints": ["tcp/127.0.0.1:1"]}, "{}"),
        ({"mode": "router"}, "{}"),
        ({}, "{ listen: { endpoints: ['tcp/0.0.0.0:7447'] } }"),
        ({}, "{ connect: { endpoints: ['tcp/127.0.0.1:1'] } }"),
        ({}, "{ mode: 'router' }"),
    ],
)
def test_where_an_endpoint_is_named_or_routes_meet_nothing_else_is_changed(file, options, text):
    path = file(text)
    assert values(build(options, path), WHERE[1:]) == values(zenoh.Config.from_file(str(path)), WHERE[1:])


def test_with_no_endpoint_only_this_machine_is_looked_at():
    config = build({}, None)
    assert json.loads(config.get_json("listen/endpoints"))["peer"] == ["tcp/127.0.0.1:0"]
    assert json.loads(config.get_json("scouting/multicast/interface")) == "lo"


@pytest.mark.parametrize("text", ["{", "{ mode: 7 }", "{ no_such_key: 1 }"])
def test_a_file_that_is_none_is_refused_with_one_line(file, text):
    with pytest.raises(BusError, match=r"Zenoh refuses the configuration: [^\n]+$"):
        Bus(Network(zenoh_config=file(text)), "turtlebot")


def connects(mode, *endpoints):
    return json.loads(build({"mode": mode, "connect/endpoints": list(endpoints)}, None).get_json("connect/endpoints"))


def test_routers_are_joined_by_a_link_for_bulk_and_one_for_the_rest():
    assert connects("router", "tcp/a:1", "tcp/b:2#so_sndbuf=9") == [
        "tcp/a:1?prio=0-5",
        "tcp/a:1?prio=6-7",
        "tcp/b:2?prio=0-5#so_sndbuf=9",
        "tcp/b:2?prio=6-7#so_sndbuf=9",
    ]
    assert connects("router", "tcp/a:1?prio=0-7") == ["tcp/a:1?prio=0-7"]
    assert connects("client", "tcp/a:1") == ["tcp/a:1"]


def test_only_what_goes_between_routers_is_compressed():
    assert values(build({"mode": "router"}, None), BETWEEN_ROUTERS) == BETWEEN_ROUTERS
    assert values(build({"mode": "client"}, None), BETWEEN_ROUTERS) == values(zenoh.Config(), BETWEEN_ROUTERS)
