"""The robot that has had the least time comes next, with its newest samples; idling earns no claim."""

import pytest

from cliffscan.services.perception.turns import MOST, ROOM, Turns


@pytest.fixture
def turns():
    return Turns()


def served(turns, cost, rounds, again):
    """The order of turns: a turn of a robot takes `cost` [s], and `again` [robot] ask again at once."""
    order = []
    for _ in range(rounds):
        robot, _ = turns.take(0.0)
        order.append(robot)
        turns.spent(cost[robot])
        if robot in again:
            turns.put(robot, b"")
    return order


def test_robots_come_in_the_order_of_their_samples(turns):
    for robot in "cab":
        turns.put(robot, robot.encode())
    assert [turns.take(0.0) for _ in "cab"] == [("c", [b"c"]), ("a", [b"a"]), ("b", [b"b"])]
    assert turns.take(0.0) is None


def test_only_the_newest_samples_of_a_robot_wait(turns):
    assert [turns.put("a", bytes([number])) for number in range(ROOM + 2)] == [True] * ROOM + [False] * 2
    assert turns.take(0.0) == ("a", [bytes([number]) for number in range(2, ROOM + 2)])


def test_what_a_robot_sent_can_be_forgotten(turns):
    for robot in "ab":
        turns.put(robot, b"")
    turns.drop("a")
    turns.drop("c")
    assert turns.take(0.0) == ("b", [b""])
    assert turns.take(0.0) is None


def test_it_is_idle_when_nothing_waits_and_the_last_turn_is_spent(turns):
    assert turns.is_idle()
    turns.put("a", b"")
    assert not turns.is_idle()
    turns.take(0.0)
    assert not turns.is_idle()
    turns.spent(0.1)
    assert turns.is_idle()


def test_a_robot_that_never_stops_has_every_other_turn(turns):
    for robot in "ab":
        turns.put(robot, b"")
    assert served(turns, {"a": 0.01, "b": 0.01}, 6, again="ab") == ["a", "b", "a", "b", "a", "b"]


def test_a_robot_of_long_turns_has_as_much_time_as_others(turns):
    for robot in "ab":
        turns.put(robot, b"")
    order = served(turns, {"a": 0.1, "b": 0.01}, 44, again="ab")
    assert order.count("a") == pytest.approx(4, abs=1)


def test_who_asks_rarely_waits_for_one_turn_at_most(turns):
    turns.put("flood", b"")
    served(turns, {"flood": 0.1}, 50, again="flood")
    turns.put("rare", b"")
    assert "rare" in served(turns, {"flood": 0.1, "rare": 0.001}, 2, again="flood")


def test_idling_earns_no_claim(turns):
    turns.put("idle", b"")
    served(turns, {"idle": 0.001}, 1, again="")
    turns.put("busy", b"")
    served(turns, {"busy": 0.1}, 100, again="busy")
    turns.put("idle", b"")
    order = served(turns, {"busy": 0.1, "idle": 0.1}, 10, again=("busy", "idle"))
    assert order.count("busy") == pytest.approx(5, abs=1)


def test_no_more_than_so_many_robots_wait(turns):
    for number in range(MOST):
        turns.put(str(number), b"")
    assert not turns.admits("another")
    assert turns.admits("0")
    turns.take(0.0)
    assert turns.admits("another")


def test_strangers_have_together_the_time_of_one_robot(turns):
    order = []
    turns.put("a", b"")
    for number in range(40):
        turns.put(f"stranger {number}", b"", known=False)
        robot, _ = turns.take(0.0)
        order.append(robot)
        turns.spent(0.01)
        if robot == "a":
            turns.put("a", b"")
    assert order.count("a") == pytest.approx(20, abs=1)


def test_strangers_take_no_robots_room(turns):
    for number in range(MOST):
        assert turns.admits(f"stranger {number}", known=False)
        turns.put(f"stranger {number}", b"", known=False)
    assert not turns.admits("stranger", known=False)
    assert turns.admits("a")
    turns.put("stranger 0", b"")  # it is known now
    assert turns.admits("stranger", known=False)
