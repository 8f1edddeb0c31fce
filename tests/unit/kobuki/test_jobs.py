"""One wait serves jobs of any thread and the port."""

import os
import threading

import pytest

from services.kobuki.jobs import ROOM, Jobs


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


def test_jobs_come_out_in_order():
    jobs = Jobs()
    one, two = lambda: None, lambda: None
    assert jobs.put(one)
    assert jobs.put(two)
    assert [jobs.take(), jobs.take(), jobs.take()] == [one, two, None]


def test_a_job_of_another_thread_ends_the_wait(port):
    jobs = Jobs()
    threading.Timer(0.05, lambda: jobs.put(lambda: None)).start()
    assert not jobs.wait(port, 60.0)
    assert jobs.take()


def test_the_port_ends_the_wait(port):
    jobs = Jobs()
    threading.Timer(0.05, lambda: os.write(port.other, b".")).start()
    assert jobs.wait(port, 60.0)
    assert not jobs.take()


def test_while_a_job_is_left_nobody_waits(port):
    jobs = Jobs()
    jobs.put(lambda: None)
    jobs.put(lambda: None)
    jobs.wait(port, 60.0)
    jobs.take()
    assert not jobs.wait(None, 60.0)
    assert jobs.take()


def test_the_bell_is_heard_once():
    jobs = Jobs()
    jobs.put(lambda: None)
    jobs.wait(None, 60.0)
    jobs.take()
    assert not jobs.wait(None, 0.0)


def test_when_nobody_takes_them_the_oldest_gives_way():
    jobs = Jobs()
    assert all(jobs.put(lambda n=n: n) for n in range(ROOM))
    assert not jobs.put(lambda: ROOM)
    assert jobs.take()() == 1
