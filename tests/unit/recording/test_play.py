"""Samples are played when they came, faster or slower, from the middle or again, and no command is."""

import pytest

from cliffscan.common.runtime.raw_samples import RawSample
from cliffscan.recording.play import Options, Player
from tests.build import Stop

SECOND = 1_000_000_000  # [ns]


class Network:
    """What was put, and what is kept for whoever asks."""

    def __init__(self):
        self.published = []
        self.kept = []

    def publisher(self, _path, _encoding):
        return self

    def put(self, sample):
        self.published.append(sample)

    def latch(self, _path):
        return self.kept.append


def sample(path, seconds):
    return RawSample(path, "application/msgpack", 10**18 + int(seconds * SECOND), b"", path.encode())


SAMPLES = [
    sample("description", 0.0),
    sample("scan/fused", 1.0),
    sample("base/cmd_vel", 1.5),
    sample("base/command/stop", 1.5),
    sample("base/cmd_vel_safe", 1.5),
    sample("base/odom", 2.0),
    sample("scan/fused", 4.0),
]


def scans(*seconds):
    return [sample("scan/fused", each) for each in seconds]


@pytest.fixture
def played(monkeypatch):
    """Play samples: those that were put, and how long [s] was waited, on a clock that stands still."""

    def run(samples=SAMPLES, **options):
        network, stop = Network(), Stop()
        monkeypatch.setattr("time.monotonic", lambda: 100.0)
        player = Player(network, Options(**options), stop)
        again = player.play(iter(samples))
        return network, stop.waits, player, again

    return run


def test_all_but_commands_are_played_when_they_came(played):
    network, waits, player, again = played()
    assert [each.path for each in network.published] == ["description", "scan/fused", "base/odom", "scan/fused"]
    assert waits == pytest.approx([0.0, 1.0, 2.0, 4.0])
    assert player.left_out == {"base/cmd_vel": 1, "base/command/stop": 1, "base/cmd_vel_safe": 1}
    assert network.kept == SAMPLES[:1]
    assert again


def test_commands_are_played_when_told(played):
    network, _, player, _ = played(commands=True)
    assert network.published == SAMPLES
    assert not player.left_out


def test_faster_from_the_middle_with_the_description_of_the_beginning(played):
    network, waits, _, _ = played(rate=2.0, start=1.5)
    assert [each.path for each in network.published] == ["description", "base/odom", "scan/fused"]
    assert waits == pytest.approx([0.25, 1.25])


def test_chosen_keys_keep_the_recordings_beginning(played):
    network, waits, player, _ = played(keys=["scan/**"], start=0.5)
    assert network.published == [SAMPLES[1], SAMPLES[6]]
    assert waits == pytest.approx([0.5, 3.5])
    assert not player.left_out


@pytest.mark.parametrize("options", [{"start": 5.0}, {"keys": ["pose"]}, {"keys": ["base/cmd_vel"]}])
def test_a_pass_that_plays_nothing_is_the_last(played, options):
    assert not played(**options)[3]


@pytest.mark.parametrize(
    ("times", "waits"),
    [
        ((0.0, 1.0, -3599.0, -3598.0), (0.0, 1.0, 1.0, 2.0)),
        ((0.0, 1.0, 86_401.0, 86_402.0), (0.0, 1.0, 1.0, 2.0)),
        ((0.0, 1.0, 0.9, 1.1, 1.0, 1.2), (0.0, 1.0, 1.0, 1.1, 1.1, 1.2)),  # written in another order
        ((0.0, 59.0), (0.0, 59.0)),
    ],
)
def test_a_clock_that_was_set_takes_no_time(played, times, waits):
    network, waited, player, _ = played(scans(*times))
    assert len(network.published) == len(times)
    assert waited == pytest.approx(waits)
    assert player.passed_over == (86_400.0 if max(times) > 60.0 else 0.0)


def test_the_start_does_not_depend_on_a_clock_that_was_set(played):
    network, waited, _, _ = played(scans(0.0, 1.0, -3599.0, -3598.0), start=2.0)
    assert len(network.published) == 1
    assert waited == [0.0]
