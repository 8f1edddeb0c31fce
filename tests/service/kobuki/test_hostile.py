"""Messages that nobody should send, to the real services: none of them dies, grows, or lets a good frame wait."""

from tests.hostile_services import Trial

OTHERS = ("negative", "positive", "fuse")
AT_ONCE = 2.0  # [s] a deadline where other tests share the machine; benchmarks/hostile tells how soon it is alone
GROWTH = 20e6  # [bytes] of a process


def test_a_good_frame_is_answered_at_once_whatever_came_before(client, start, base):
    services = [base.service, *(start(name, wait=False) for name in OTHERS)]
    for name in OTHERS:
        client.wait_alive(name)
    told = Trial(client, [service.process.pid for service in services]).run(seed=3, count=150)
    assert told.longest < AT_ONCE
    assert told.growth < GROWTH
    assert [service.process.poll() for service in services] == [None] * 4
