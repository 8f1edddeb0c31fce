"""The bus in a flood, at its end, and without an endpoint."""

import contextlib
import json
import threading
import time

import msgpack
import psutil
import pytest
import zenoh

from cliffscan.common.contract.topics import VELOCITY
from cliffscan.common.runtime.bus import Bus
from cliffscan.common.runtime.network import Network
from tests.service.conftest import DEADLINE, free_endpoint, wait_until

NOT_LATE = 5.0  # [s] that a single answer may take in a flood on a busy machine; without rings it takes ten on any


@pytest.fixture
def bus(client):
    with Bus(Network("client", [client.endpoint]), client.robot) as made:
        yield made


def wait_answered(client, path):
    """Wait until the router knows who answers at a path, and so what was declared before."""
    wait_until(lambda: any(reply.ok for reply in client.session.get(f"{client.robot}/{path}", timeout=DEADLINE)))


def stranger(client):
    """The session of another client."""
    config = zenoh.Config()
    config.insert_json5("mode", '"client"')
    config.insert_json5("connect/endpoints", json.dumps([client.endpoint]))
    return zenoh.open(config)


@contextlib.contextmanager
def flood(client, act, burst):
    """Another client that does something `burst` times a millisecond at most, in a thread of its own."""
    over, session = threading.Event(), stranger(client)

    def run():
        while not over.wait(0.001):
            for _ in range(burst):
                act(session)

    thread = threading.Thread(target=run)
    thread.start()
    yield
    over.set()
    thread.join()
    session.close()


def test_a_flood_of_one_command_delays_no_other(client, bus):
    asked = []
    bus.answer("base/command/version", lambda _: asked.append(time.monotonic()) or {"ok": True})
    bus.answer("base/command/stop", lambda _: {"ok": True, "message": "stopped"})
    wait_answered(client, "base/command/stop")
    key = f"{client.robot}/base/command/version"
    with flood(client, lambda session: session.get(key, zenoh.handlers.RingChannel(1)), burst=20):
        wait_until(lambda: len(asked) > 50)
        for _ in range(5):
            began = time.monotonic()
            assert client.ask("base/command/stop", {})["ok"]
            assert time.monotonic() - began < NOT_LATE
    rate = (len(asked) - 1) / (asked[-1] - asked[0])
    assert rate < 250


def test_a_flood_of_one_key_delays_no_other(client, bus):
    arrived, slowly, commands = threading.Event(), threading.Event(), []
    bus.subscribe("base/cmd_vel", lambda *_: commands.append(slowly.wait(0.05)))
    bus.subscribe("scan/fused", lambda *_: arrived.set())
    bus.answer("base/command/stop", lambda _: {"ok": True})
    wait_answered(client, "base/command/stop")
    payload = msgpack.packb({"stamp": 1, "linear": 0.1, "angular": 0.0})
    with flood(client, lambda session: session.put(f"{client.robot}/base/cmd_vel", payload), burst=5):
        wait_until(lambda: len(commands) > 10)
        for _ in range(5):
            arrived.clear()
            client.put("scan/fused", b"")
            assert arrived.wait(NOT_LATE)
            assert client.ask("base/command/stop", {})["ok"]
    slowly.set()


def test_a_dropped_request_ends_for_its_asker(client, bus):
    taken, let_go = threading.Event(), threading.Event()

    def answer(_):
        taken.set()
        return let_go.wait(DEADLINE) and {"ok": True}

    bus.answer("base/command/version", answer)
    bus.answer("up", lambda _: {"ok": True})
    wait_answered(client, "up")
    key, ends = f"{client.robot}/base/command/version", []

    def ask():
        ends.append(len(list(client.session.get(key, timeout=DEADLINE))))

    askers = [threading.Thread(target=ask) for _ in range(12)]
    askers[0].start()
    assert taken.wait(DEADLINE)
    for asker in askers[1:]:
        asker.start()
    wait_until(lambda: len(ends) == 12 - 9)  # one is being answered, eight wait
    assert ends == [0, 0, 0]
    let_go.set()
    for asker in askers:
        asker.join(DEADLINE)
    assert sorted(ends) == [0] * 3 + [1] * 9


def test_a_payload_beyond_its_key_is_told_and_not_delivered(client, bus):
    arrived, refused = [], []
    bus.subscribe("base/*", lambda *each: arrived.append(each), refused=lambda *each: refused.append(each))
    bus.answer("base/command/led", lambda parameters: {"ok": True, "got": parameters})
    wait_answered(client, "base/command/led")
    client.put("base/cmd_vel", bytes(1_000_000))
    client.put("base/cmd_vel", b"small")
    wait_until(lambda: arrived)
    assert arrived == [("base/cmd_vel", b"small")]
    assert [(path, str(why)) for path, why in refused] == [("base/cmd_vel", "1000000 bytes, expected 32768 at most")]
    answer = client.ask("base/command/led", {"led": bytes(1_000_000)})
    assert answer == {"ok": False, "message": "malformed request: 1000010 bytes, expected 32768 at most"}


def test_an_error_in_a_receiver_costs_one_message(client, bus, caplog):
    arrived = []

    def receive(_path, payload):
        arrived.append(payload)
        if payload == b"1":
            raise RuntimeError("a slip")

    bus.subscribe("scan/lidar", receive)
    bus.answer("up", lambda _: {"ok": True})
    wait_answered(client, "up")
    for payload in (b"1", b"2"):
        client.put("scan/lidar", payload)
    wait_until(lambda: len(arrived) == 2)
    assert "a slip" in caplog.text


def test_threads_end_with_the_session(client):
    with Bus(Network("client", [client.endpoint]), client.robot) as bus:
        bus.subscribe("scan/fused", lambda *_: None)
        bus.answer("base/command/stop", lambda _: {})
        bus.latch(VELOCITY)
        bus.receive_latched("description", lambda *_: None)
    mine = f"bus {client.robot}/"
    wait_until(lambda: not any(thread.name.startswith(mine) for thread in threading.enumerate()))


def test_what_is_kept_comes_to_those_who_come_later(client, bus):
    publish = bus.latch(VELOCITY)
    publish(VELOCITY.message(stamp=1, linear=0.5, angular=0.0))
    wait_answered(client, "base/cmd_vel")
    arrived = []
    with Bus(Network("client", [client.endpoint]), client.robot) as later:
        later.receive_latched("base/cmd_vel", lambda _, payload: arrived.append(msgpack.unpackb(payload)["linear"]))
        wait_until(lambda: arrived)

        def asked_again():
            """A question may go unanswered within its second on a busy machine; the next announcement asks again."""
            bus.withdraw()
            bus.announce("kobuki")
            return len(arrived) > 1

        wait_until(asked_again)
    assert set(arrived) == {0.5}


def test_no_answer_with_what_is_kept_is_lost(client, bus):
    key, kept, arrived = f"{client.robot}/description", [b"%d" % number for number in range(8)], []

    def answer(query):
        for payload in kept:
            query.reply(key, payload)

    with stranger(client) as keeper:
        keeper.declare_queryable(key, answer)
        wait_answered(client, "description")
        for asked in range(1, 6):
            bus.receive_latched("description", lambda _, payload: arrived.append(payload))
            wait_until(lambda times=asked: len(arrived) == times * len(kept))


def test_who_is_too_busy_to_answer_is_asked_again_for_what_is_kept(client, bus):
    asked, arrived = [], []

    def answer(query):
        asked.append(query)  # to hold it leaves it unanswered
        if len(asked) == 3:
            query.reply(query.key_expr, b"here")
            query.drop()

    client.session.declare_queryable(f"{client.robot}/description", answer)
    bus.receive_latched("description", lambda _, payload: arrived.append(payload))
    wait_until(lambda: arrived)
    assert arrived == [b"here"]


def test_with_no_endpoint_nothing_beyond_this_machine_can_connect(client, start, run):
    process = start("fuse", wait=False, where=[])
    process.wait_said("ready")
    listening = [
        each.laddr.ip
        for each in psutil.Process(process.process.pid).net_connections("tcp")
        if each.status == psutil.CONN_LISTEN
    ]
    assert listening == ["127.0.0.1"]


def test_a_router_is_found_by_those_who_look_on_this_machine(client, meeting_point):
    """The router listens where it was told, and a client without an endpoint finds it by asking."""
    config = zenoh.Config.from_file(str(meeting_point))
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", '["tcp/127.0.0.1:0"]')
    with zenoh.open(config) as router, Bus(Network("client", zenoh_config=meeting_point), client.robot) as bus:
        assert router.zid() is not None
        arrived = threading.Event()
        bus.subscribe("scan/fused", lambda *_: arrived.set())
        wait_until(lambda: router.put(f"{client.robot}/scan/fused", b"") or arrived.is_set())


def test_no_thread_outlives_its_session(client):
    """One that still waited in native code would abort the process at its end."""
    before = set(threading.enumerate())
    with Bus(Network("client", [client.endpoint]), client.robot) as bus:
        bus.subscribe("base/cmd_vel", lambda _path, _payload: None)
        bus.receive_latched("description", lambda _path, _payload: None)
        bus.answer("base/command/stop", lambda _: {})
        started = set(threading.enumerate()) - before
        assert {thread.name.split()[0] for thread in started} == {"bus"}
    assert not [thread for thread in started if thread.is_alive()]


def test_what_one_robot_declared_can_be_taken_back_alone(client):
    with Bus(Network("client", [client.endpoint]), client.robot) as bus:
        mine, others = bus.beside(client.robot), bus.beside("another")
        arrived, taken_back = threading.Event(), []
        mine.subscribe("scan/lidar", lambda *_: taken_back.append(1))
        bus.subscribe("scan/fused", lambda *_: arrived.set())
        mine.announce("perception")
        others.announce("perception")
        client.wait_alive("perception")
        mine.retract()
        client.wait_alive("perception", alive=False)
        client.put("scan/lidar", b"")
        client.put("scan/fused", b"")
        assert arrived.wait(DEADLINE)
        assert not taken_back
        assert bus.robots()["another"] == {"perception"}


def test_two_routers_are_joined_and_what_is_no_router_is_not(client, bus):
    with Bus(Network("router", [client.endpoint], [free_endpoint()]), client.robot) as router:
        wait_until(lambda: router.connected)
        assert not router.joined  # the tests' router knows nothing of ours
        with (
            Bus(Network("router", [], [endpoint := free_endpoint()]), client.robot),
            Bus(Network("router", [endpoint], [free_endpoint()]), client.robot) as second,
        ):
            wait_until(lambda: second.joined)
    assert bus.connected
    assert not bus.joined


def test_no_token_is_missed_by_who_is_busy(client, bus):
    names, told, go_on = {f"r{number}" for number in range(700)}, set(), threading.Event()

    def changed(robot, _service, here):
        go_on.wait(DEADLINE)
        (told.add if here else told.discard)(robot)

    bus.beside("*").watch_robots(changed)
    with Bus(Network("client", [client.endpoint]), client.robot) as asking, stranger(client) as session:
        tokens = [session.liveliness().declare_token(f"{name}/alive/fuse") for name in names]
        wait_until(lambda: names <= asking.robots().keys())
        go_on.set()
        wait_until(lambda: names <= told)
        go_on.clear()
        for token in tokens:
            token.undeclare()
        wait_until(lambda: not names & asking.robots().keys())
        go_on.set()
        wait_until(lambda: not names & told)


def test_who_watches_many_tokens_may_ask_for_them(client, bus):
    names = {f"r{number}" for number in range(300)}
    bus.beside("*").watch_robots(lambda *_: None)
    with stranger(client) as session:
        tokens = [session.liveliness().declare_token(f"{name}/alive/fuse") for name in names]
        wait_until(lambda: names <= bus.robots().keys())
        assert len(tokens) == len(names)
