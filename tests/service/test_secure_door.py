"""A router accepts good keys and refuses others; the refused process logs why. Certificates end. Over real links."""

import json
import shutil
import sys
from contextlib import suppress
from datetime import timedelta

import pytest
import zenoh

from cliffscan.common.runtime import zenoh_config
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.network import Network, NotConnected
from cliffscan.common.runtime.secure import Credentials
from cliffscan.common.runtime.tls_probe import why_unreachable
from cliffscan.secure.folder import KeyFolder
from tests.service.conftest import DEADLINE, free_endpoint, wait_until


def secured_endpoint():
    return free_endpoint().replace("tcp/", "tls/")


def opened(folder, role, **ends):
    """A session as any Zenoh program opens it from a role's file, but for where it listens and connects."""
    config = zenoh.Config.from_file(str(folder / role / "zenoh.json5"))
    for end, endpoint in ends.items():
        config.insert_json5(f"{end}/endpoints", json.dumps([endpoint]))
    return zenoh.open(config)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("keys")
    for robot in ("r", "foreign"):
        KeyFolder(folder / robot).init(robot, [])
    return folder


@pytest.fixture
def keys(made, tmp_path):
    """Keys of a test's own, to be spoilt."""
    shutil.copytree(made / "r", tmp_path / "r")
    KeyFolder(tmp_path / "r").renew()
    return tmp_path / "r"


@pytest.fixture(scope="module")
def router(made):
    endpoint = secured_endpoint()
    session = opened(made / "r", "router", listen=endpoint)
    token = session.liveliness().declare_token("r/alive/router-here")
    yield endpoint
    token.undeclare()
    session.close()


def bus(folder, role, endpoint, robot="r"):
    return Bus(Network(connect=[endpoint], secure=Credentials(folder, role, [robot])), robot)


def test_who_has_keys_is_let_in(made, router):
    with bus(made / "r", "viewer", router) as inside:
        wait_until(lambda: inside.alive() == {"router-here"})
        assert inside.robots() == {"r": {"router-here"}}


def test_a_foreign_ca_is_refused_and_says_so(made, router):
    with pytest.raises(NotConnected, match=f"^{router}: its certificate is of another CA than ours: make both"):
        bus(made / "foreign", "viewer", router, "foreign")


def test_an_impostor_who_trusts_our_ca_is_refused(made, keys, router):
    """Its own certificate is of another CA."""
    for name in ("cert.pem", "key.pem"):
        shutil.copy(made / "foreign/driver" / name, keys / "driver" / name)
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        opened(keys, "driver", connect=router)
    assert "it knows another CA than that of our certificate" in why_unreachable(router, keys / "driver")


def test_an_expired_certificate_is_refused(made, router, keys):
    shutil.copytree(made / "r/ca", keys / "ca", dirs_exist_ok=True)
    KeyFolder(keys).issue("driver", timedelta(minutes=-1))
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        opened(keys, "driver", connect=router)
    assert "our certificate has expired" in why_unreachable(router, keys / "driver")


def test_no_certificate_is_refused(made, router):
    config = zenoh.Config()
    for key, value in (
        ("mode", "client"),
        ("connect/endpoints", [router]),
        ("transport/link/tls/root_ca_certificate", str(made / "r/viewer/ca.pem")),
    ):
        config.insert_json5(key, json.dumps(value))
    with pytest.raises(zenoh.ZError, match="Unable to connect"):
        zenoh.open(config)
    assert why_unreachable(router, None).endswith("it asks for a certificate: add --secure DIR")


def test_plain_tcp_is_refused_and_says_so(router):
    plain = router.replace("tls/", "tcp/")
    with pytest.raises(NotConnected, match=f"^{plain}: it speaks TLS: add --secure DIR, and write tls/"):
        Bus(Network("client", [plain]), "r")


def test_a_router_without_keys_is_not_taken_for_one(made):
    endpoint = secured_endpoint()
    with Bus(Network("router", listen=[endpoint.replace("tls/", "tcp/")]), "r"):
        why = why_unreachable(endpoint, made / "r/viewer")
    assert why == f"{endpoint}: it does not answer in TLS: start that router with --secure DIR"


def test_where_nobody_listens_is_said(made):
    with pytest.raises(NotConnected, match="Connection refused: is a router running there"):
        bus(made / "r", "viewer", secured_endpoint())


def test_a_router_whose_certificate_has_expired_is_refused(made, keys):
    endpoint = secured_endpoint()
    KeyFolder(keys).issue("router", timedelta(minutes=-1))
    with opened(keys, "router", listen=endpoint) as session:
        assert session.zid()
        with pytest.raises(NotConnected, match="its certificate has expired: `cliffscan keys renew`"):
            bus(made / "r", "viewer", endpoint)


def test_a_service_stands_in_for_no_router(keys, made):
    """Stolen keys of a service do not make a router that others believe."""
    endpoint = secured_endpoint()
    for name in ("cert.pem", "key.pem"):
        shutil.copy(keys / "fuse" / name, keys / "router" / name)
    with opened(keys, "router", listen=endpoint) as session:
        assert session.zid()
        with pytest.raises(NotConnected, match="its certificate is no router's"):
            bus(made / "r", "viewer", endpoint)


def command(service, folder, endpoint, *options):
    return [
        *(sys.executable, "-m", f"services.{service}", "--robot", "r"),
        *("--secure", str(folder), "--connect", endpoint, *options),
    ]


def test_a_service_with_the_keys_of_another_says_so_in_one_line(keys, router, run):
    shutil.copytree(keys / "viewer", keys / "fuse", dirs_exist_ok=True)
    process = run(command("fuse", keys, router))
    process.expected = 2
    assert process.end() == 2
    assert process.said.count("\n") == 1
    assert f"fuse: {keys}/fuse/cert.pem: is the certificate of 'viewer', expected 'fuse'" in process.said


def test_a_service_that_no_rule_admits_says_so_instead_of_hearing_nothing(keys, run):
    """The router keeps rules of another robot: all is refused without a word."""
    endpoint, file = secured_endpoint(), keys / "router/zenoh.json5"
    file.write_text(file.read_text().replace('"r/', '"q/'))
    with opened(keys, "router", listen=endpoint) as session:
        assert session.zid()
        run(command("fuse", keys, endpoint)).wait_said("nothing passes: the router shows itself to no fuse of r: ")


def test_a_service_says_what_its_role_may_not_receive(keys, router, run):
    process = run(command("fuse", keys, router, "--set", 'fuse.inputs.front={key="lidar/front"}'))
    process.wait_said("fuse may not receive lidar/front: a secured router passes nothing of it")


def test_a_link_ends_with_its_certificate_and_begins_with_a_renewed_one(made, keys, router):
    with opened_briefly(keys, router) as session:
        wait_until(lambda: not session.info.routers_zid())
        KeyFolder(keys).renew()
        wait_until(session.info.routers_zid)


def opened_briefly(keys, router):
    """A session of fuse whose certificate ends in some seconds: in more of them where opening takes all there are."""
    for seconds in (3, 10, 30):
        KeyFolder(keys).issue("fuse", timedelta(seconds=seconds))
        with suppress(zenoh.ZError):
            return opened(keys, "fuse", connect=router)
    pytest.fail("no session")


def test_a_router_takes_up_renewed_keys_when_all_of_them_are_there(made, keys, run):
    endpoint = secured_endpoint()
    process = run(
        [
            *(sys.executable, "-m", "cliffscan", "router", "--name", "here"),
            *("--robot", "r", "--secure", str(keys), "--listen", endpoint),
        ]
    )
    process.wait_said("ready")
    with bus(keys, "viewer", endpoint) as inside:
        wait_until(lambda: inside.alive() == {"router-here"})
        shutil.copy(made / "foreign/router/cert.pem", keys / "router")  # one of several files that are being copied
        process.wait_said("goes on with the keys of before, for")
        KeyFolder(keys).renew()
        process.wait_said("keys or rules were renewed: opening anew")
        wait_until(lambda: process.said.count("ready") == 2)
        wait_until(lambda: inside.alive() == {"router-here"})


def test_a_router_that_is_joined_and_lets_nothing_pass_is_joined_anew(keys, run):
    robot, join = secured_endpoint(), [*(sys.executable, "-m", "cliffscan", "router", "--name", "workstation")]
    ours = zenoh_config.build({"listen/endpoints": [robot]}, keys / "router/zenoh.json5")  # is joined by two links
    with zenoh.open(ours) as session:
        place = ["--robot", "r", "--secure", str(keys), "--connect", robot, "--listen", secured_endpoint()]
        process = run([*join, *place])
        process.wait_said("nothing passes, though the other router is reached: opening anew")
        token = session.liveliness().declare_token("r/alive/router-robot")
        shown = []
        session.liveliness().declare_subscriber("r/alive/router-workstation", shown.append, history=True)
        wait_until(lambda: shown)
        token.undeclare()


@pytest.fixture
def two(made):
    """The robot's router and the workstation's, joined; endpoints by name."""
    robot, workstation = secured_endpoint(), secured_endpoint()
    with (
        opened(made / "r", "router", listen=robot) as first,
        opened(made / "r", "router-workstation", listen=workstation, connect=robot) as second,
    ):
        wait_until(second.info.routers_zid)
        yield {"robot": robot, "workstation": workstation, "router": first}


def gather(session, path, of=None):
    """The keys below `path` on which something comes, or only `of` a payload."""
    arrived = []

    def take(sample):
        if of in (None, sample.payload.to_bytes()):
            arrived.append(str(sample.key_expr))

    session.declare_subscriber(f"r/{path}", take)
    return arrived


def test_what_crosses_between_two_routers(made, two):
    def session(role, place):
        return opened(made / "r", role, connect=two[place])

    with (
        session("recorder", "robot") as at_robot,
        session("recorder", "workstation") as at_workstation,
        session("kobuki", "robot") as kobuki,
        session("capture", "robot") as capture,
        session("fuse", "workstation") as fuse,
        session("driver", "workstation") as driver,
        session("slam", "workstation") as slam,
        session("kobuki", "workstation") as thief,
        session("capture", "workstation") as other_thief,
    ):
        robot, workstation = gather(at_robot, "**"), gather(at_workstation, "**")
        down = {"camera/depth": capture} | {f"base/{name}": kobuki for name in ("odom", "state", "imu", "safety")}
        down |= {"status/kobuki": kobuki, "status/capture": capture, "description": kobuki}
        up = {"scan/fused": fuse, "status/fuse": fuse, "base/cmd_vel": driver}

        def crossed():
            for path, sender in (down | up).items():
                sender.put(f"r/{path}", "owner")
            return {f"r/{path}" for path in down} <= set(workstation) and {f"r/{path}" for path in up} <= set(robot)

        wait_until(crossed)
        stolen = gather(at_robot, "**", of=b"a thief")
        for path in ("camera/depth", "description"):
            other_thief.put(f"r/{path}", "a thief")
        for path in ("base/odom", "base/safety", "status/kobuki"):
            thief.put(f"r/{path}", "a thief")
        slam.put("r/map", "a thief")
        wait_until(lambda: fuse.put("r/scan/fused", "a thief") or "r/scan/fused" in stolen)
        assert set(stolen) == {"r/scan/fused"}

        answers = [kobuki.declare_queryable(f"r/base/command/{name}", reply) for name in ("stop", "clear_safety")]
        assert answers
        wait_until(lambda: answered(driver, "stop"))
        assert not answered(driver, "clear_safety")  # only by who is at the robot's own router


def reply(query):
    with query:
        query.reply(query.key_expr, b"")


def answered(session, name):
    return any(each.ok for each in session.get(f"r/base/command/{name}", timeout=DEADLINE))
