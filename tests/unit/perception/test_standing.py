"""However processes come, go and die, a robot is served by one of them at a time, and soon again."""

from collections import Counter, defaultdict

import pytest

from cliffscan.services.perception.standing import CLAIM, LYING, MOST, PARTS, SETTLED, Standing, Standings

TICK = 0.01  # [s]
ROBOTS = [f"cell{number % 3}/r{number}" for number in range(14)]


class Process:
    def __init__(self, net, name, named):
        self.net, self.name, self.named, self.news = net, name, named, []
        self.standings = Standings(name, named, net.now)

    def step(self, robots):
        now = self.net.now
        for at, call in [each for each in self.news if each[0] <= now]:
            call(self.standings)
            self.news.remove((at, call))
        for robot, standing in self.standings.review(robots, now).items():
            self.net.set(self, f"{CLAIM}{self.name}", robot, standing is not Standing.AWAY)
            for part in PARTS:
                self.net.set(self, part, robot, standing is Standing.SERVES)


class Net:
    """Processes, and tokens that reach others after a delay [s]; a token of one name is one, whoever holds it."""

    def __init__(self, robots, delay=0.03):
        self.robots, self.delay, self.now = list(robots), delay, 100.0
        self.processes, self.holders, self.members = {}, defaultdict(set), set()
        self.unserved, self.longest = Counter(), Counter()

    def tell(self, call, but=None):
        for process in self.processes.values():
            if process is not but:
                process.news.append((self.now + self.delay, call))

    def set(self, process, service, robot, here):
        holders = self.holders[robot, service]
        before = bool(holders)
        (holders.add if here else holders.discard)(process.name)
        if bool(holders) != before:
            self.tell(lambda each: each.token(robot, service, here))

    def start(self, name, named=None):
        process = self.processes[name] = Process(self, name, named)
        for (robot, service), holders in self.holders.items():
            if holders:
                process.news.append((self.now, lambda each, r=robot, s=service: each.token(r, s, True)))
        for member in self.members:
            process.news.append((self.now, lambda each, m=member: each.member(m, True)))
        if named is None:
            self.members.add(name)
            self.tell(lambda each: each.member(name, True))

    def kill(self, name):
        process = self.processes.pop(name)
        for robot, service in list(self.holders):
            self.set(process, service, robot, False)
        self.members.discard(name)
        self.tell(lambda each: each.member(name, False))

    def serving(self, robot):
        """Which processes serve a robot."""
        return [name for name, each in self.processes.items() if each.standings.of(robot) is Standing.SERVES]

    def run(self, seconds):
        """Let time pass: no robot is served twice, and how long each was not served is kept."""
        for _ in range(round(seconds / TICK)):
            self.now += TICK
            for process in list(self.processes.values()):
                process.step(self.robots)
            for robot in self.robots:
                serving = self.serving(robot)
                assert len(serving) <= 1, (robot, serving)
                self.unserved[robot] = 0.0 if serving else self.unserved[robot] + TICK
                self.longest[robot] = max(self.longest[robot], self.unserved[robot])
        return self

    def loads(self):
        return Counter(name for robot in self.robots for name in self.serving(robot))


def gaps(net):
    """The longest time without a scan [s] of each robot from here on."""
    net.longest.clear()
    return net.longest


@pytest.mark.parametrize("delay", [0.0, 0.03, 0.06])
def test_one_joins_and_one_dies(delay):
    net = Net(ROBOTS, delay)
    net.start("m")
    net.run(1.0)
    assert net.loads() == {"m": 14}
    gap = gaps(net)
    net.start("n")
    net.run(2.0)
    assert net.loads() == {"m": 7, "n": 7}
    net.start("o")
    net.run(2.0)
    assert sorted(net.loads().values()) == [4, 5, 5]
    net.kill("m")
    net.run(2.0)
    assert net.loads() == {"n": 7, "o": 7}
    assert max(gap.values()) < 0.6


def test_those_that_start_together_share_at_once():
    net = Net(ROBOTS)
    for name in "mno":
        net.start(name)
    net.run(1.0)
    assert sorted(net.loads().values()) == [4, 5, 5]


def test_a_robot_that_comes_later_moves_no_other():
    net = Net(ROBOTS[:13])
    net.start("m")
    net.start("n")
    net.run(1.0)
    gap = gaps(net)
    net.robots.append(ROBOTS[13])
    net.run(1.0)
    assert net.loads() == {"m": 7, "n": 7}
    assert not any(gap[robot] for robot in ROBOTS[:13])


def test_a_silent_robot_is_left():
    net = Net(["a", "b"])
    net.start("m")
    net.run(1.0)
    process = net.processes["m"]
    process.step(["a"])
    assert process.standings.of("b") is Standing.AWAY
    assert process.standings.of("a") is Standing.SERVES


def test_a_process_that_was_started_for_a_robot_goes_before_the_fleet():
    net = Net(["a", "b"])
    net.start("m")
    net.run(1.0)
    gap = gaps(net)
    net.start("own", ["a"])
    net.run(1.0)
    assert (net.serving("a"), net.serving("b")) == (["own"], ["m"])
    net.kill("own")
    net.run(1.0)
    assert net.serving("a") == ["m"]
    assert max(gap.values()) < 0.6


def test_of_two_that_were_started_for_the_same_robots_one_stands_by():
    net = Net(["a", "b", "c"])
    net.start("m", ["a", "b"])
    net.start("n", ["b", "c"])
    net.run(1.0)
    assert (net.serving("a"), net.serving("c")) == (["m"], ["n"])
    (first,) = net.serving("b")
    gap = gaps(net)
    net.kill(first)
    net.run(1.0)
    assert net.serving("b") == ["n" if first == "m" else "m"]
    assert gap["b"] < 0.6


@pytest.mark.parametrize("named", [None, ["a"]])
def test_single_services_go_first_whenever_they_start(named):
    net = Net(["a"])
    other = Process(net, "negative of its own", None)
    net.set(other, "negative", "a", True)
    net.start("m", named)
    net.run(1.0)
    assert net.serving("a") == []
    net.set(other, "negative", "a", False)
    net.run(1.5)
    assert net.serving("a") == ["m"]
    net.set(other, "negative", "a", True)
    assert net.processes["m"].standings.status("a", net.now)
    net.run(4.0)
    assert net.serving("a") == []
    net.set(other, "negative", "a", False)
    net.run(1.0)
    assert net.serving("a") == ["m"]


def status_every_second(net, name, seconds):
    """A service that serves the robot alone publishes its status; when this process yielded [s], or None."""
    for second in range(seconds):
        if net.processes[name].standings.status("a", net.now):
            return second
        net.run(1.0)
    return None


def test_a_single_service_goes_first_beside_two_that_were_named():
    net = Net(["a"])
    for name in "mn":
        net.start(name, ["a"])
    net.run(1.5)
    (serving,) = net.serving("a")
    net.set(Process(net, "negative of its own", None), "negative", "a", True)
    assert status_every_second(net, serving, 3) == 1
    net.run(0.1)
    assert net.serving("a") == []


@pytest.mark.parametrize("named", [None, ["a"]])
def test_the_last_status_of_one_that_leaves_the_robot_is_not_yielded_to(named):
    net = Net(["a"])
    net.start("m", ["a"] if named else None)
    net.run(1.0)
    net.start("n", named)
    net.run(1.0)
    (first,) = net.serving("a")
    net.kill(first)
    net.run(0.6)
    (second,) = net.serving("a")
    standings = net.processes[second].standings
    assert not any(standings.status("a", net.now + late) for late in (0.0, 0.001, 0.2))
    net.run(1.0)
    assert net.serving("a") == [second]


def test_of_two_that_did_not_see_each_other_one_goes_on_whatever_the_other_said_last():
    standings = Standings("m", ["a"], 0.0)
    for now in (0.0, 0.2, 2.0):
        standings.review([], now)
    assert standings.of("a") is Standing.SERVES
    standings.token("a", f"{CLAIM}n", True)
    assert not standings.status("a", 2.0)
    assert not standings.status("a", 2.01)
    assert standings.status("a", 2.9)


def test_robots_that_a_member_leaves_lying_are_served_by_another():
    robots = [f"r{number}" for number in range(6)]
    net = Net(robots)
    net.start("m")
    net.run(1.0)
    net.start("deaf")
    deaf, robots_of_the_deaf = net.processes["deaf"], []
    step, deaf.step = deaf.step, lambda _: step(robots_of_the_deaf)
    net.run(2.0)
    assert net.loads() == {"m": 3}
    net.run(LYING)
    assert net.loads() == {"m": 6}
    net.run(20.0)
    assert net.loads() == {"m": 6}
    robots_of_the_deaf += [*robots, "new", "newer"]  # it hears them again, and claims the next that come
    net.robots += ["new", "newer"]
    net.run(2.0)
    assert net.loads() == {"m": 4, "deaf": 4}


def test_a_member_is_not_idle_for_robots_that_are_served_by_services_of_their_own():
    net = Net(["r0", "r1"])
    other = Process(net, "negative of its own", None)
    for robot in net.robots:
        net.set(other, "negative", robot, True)
    for name in "mn":
        net.start(name)
    net.run(2 * LYING)
    assert not any(each.standings._idle for each in net.processes.values())


def test_what_works_for_a_robots_own_perception_is_always_named():
    net = Net(["a", "a/workstation"])
    net.start("m")
    net.start("own", ["a"])
    net.run(1.0)
    assert (net.serving("a"), net.serving("a/workstation")) == (["own"], [])
    net.start("half", ["a/workstation"])
    net.run(1.0)
    assert (net.serving("a"), net.serving("a/workstation")) == (["own"], ["half"])


def test_a_process_of_the_fleet_takes_no_more_than_it_may():
    robots = [f"r{number:03}" for number in range(MOST + 2)]
    net = Net(robots)
    net.start("m")
    net.run(1.0)
    assert net.loads() == {"m": MOST}
    assert len(net.processes["m"].standings.beyond) == 2
    net.start("n")
    net.run(1.0)
    assert net.loads() == {"m": MOST // 2 + 1, "n": MOST // 2 + 1}


def test_a_robot_is_new_until_anybody_served_it():
    standings = Standings("m", None, 0.0)
    assert standings.is_new("a")
    standings.token("a", "capture", True)
    assert standings.is_new("a")
    standings.token("a", f"{CLAIM}n", True)
    standings.token("a", f"{CLAIM}n", False)
    assert not standings.is_new("a")
    standings.forget("a")
    assert standings.is_new("a")


def test_a_start_takes_no_longer_than_tokens_need():
    net = Net(["a"])
    net.start("m", ["a"])
    net.run(SETTLED + 3 * TICK)
    assert net.serving("a") == ["m"]


def test_two_members_that_did_not_see_each_other_for_a_while_agree_by_their_claims():
    net = Net(["a"])
    for name in "mn":
        net.processes[name] = Process(net, name, None)
    for name in "mn":
        for _ in range(40):
            net.now += TICK
            net.processes[name].step(["a"])
            net.processes["n" if name == "m" else "m"].news.clear()
    assert net.serving("a") == ["m", "n"]
    for name, other in ("mn", "nm"):
        standings = net.processes[name].standings
        standings.member(other, True)
        standings.token("a", f"{CLAIM}{other}", True)
        assert not standings.status("a", net.now)
    for process in net.processes.values():
        process.step(["a"])
    assert len(net.serving("a")) == 1
