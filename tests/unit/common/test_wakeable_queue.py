"""One wait serves jobs of any thread and the port; a stop waits for nothing, and nothing grows without end."""

import os
import threading

import pytest

from cliffscan.common.runtime.wakeable_queue import ROOM, WakeableQueue


class Pipe:
    """A port of which the test holds the other end."""

    def __init__(self):
        self.end, self.other = os.pipe()

    def fileno(self):
        return self.end


@pytest.fixture
def port():
    pipe = Pipe()
    yield pipe
    os.close(pipe.end)
    os.close(pipe.other)


def one():
    pass


def two():
    pass


def test_others_come_out_one_at_a_time_and_in_order():
    jobs = WakeableQueue()
    assert jobs.put(one)
    assert jobs.put(two)
    assert [jobs.take(), jobs.take(), jobs.take()] == [[one], [two], []]


def test_a_job_of_another_thread_ends_the_wait(port):
    jobs = WakeableQueue()
    threading.Timer(0.05, lambda: jobs.put(one)).start()
    assert not jobs.wait(port, 60.0)
    assert jobs.take()


def test_the_port_ends_the_wait(port):
    jobs = WakeableQueue()
    threading.Timer(0.05, lambda: os.write(port.other, b".")).start()
    assert jobs.wait(port, 60.0)
    assert not jobs.take()


@pytest.mark.parametrize(
    "put", [WakeableQueue.put, WakeableQueue.put_urgent, lambda jobs, job: jobs.put_newest("key", job)]
)
def test_while_a_job_is_left_nobody_waits(port, put):
    jobs = WakeableQueue()
    jobs.put(one)
    put(jobs, two)
    jobs.wait(port, 60.0)
    jobs.put(one)
    jobs.take()
    assert not jobs.wait(None, 60.0)
    assert jobs.take()


def test_the_bell_is_heard_once():
    jobs = WakeableQueue()
    jobs.put(one)
    jobs.wait(None, 60.0)
    jobs.take()
    assert not jobs.wait(None, 0.0)


def test_when_nobody_takes_them_the_oldest_gives_way():
    jobs = WakeableQueue()
    assert all(jobs.put(lambda n=n: n) for n in range(ROOM))
    assert not jobs.put(lambda: ROOM)
    assert jobs.take()[0]() == 1


def test_urgent_jobs_come_first_and_none_is_lost():
    jobs = WakeableQueue()
    for _ in range(2 * ROOM):
        jobs.put(one)
        jobs.put_newest("driver", one)
    jobs.put_urgent(two)
    jobs.put_urgent(one)
    assert jobs.take() == [two, one, one, one]


def test_of_one_key_only_the_newest_is_done():
    jobs = WakeableQueue()
    assert jobs.put_newest("a", one)
    assert jobs.put_newest("b", one)
    assert jobs.put_newest("a", two)
    assert jobs.take() == [two, one]


def test_there_is_no_room_for_any_number_of_keys():
    jobs = WakeableQueue()
    assert all(jobs.put_newest(str(n), one) for n in range(ROOM))
    assert not jobs.put_newest("another", one)
    assert jobs.put_newest("0", two)
    assert len(jobs.take()) == ROOM
