"""Messages find together into frames in whatever order they come."""

import itertools

import numpy as np

from experiments.frames import ORDER, ROOM, Gathering
from tests.unit.experiments.made_up import PATHS, frame, image


def messages(seq=0, stamp=1):
    depth, scans = frame(seq=seq, stamp=stamp)
    return [("camera/depth", depth), *((path, scans[name]) for path, name in PATHS.items())]


def test_a_frame_is_complete_with_its_last_message_whichever_that_is():
    said = messages()
    for order in (said, said[::-1], said[2:] + said[:2]):
        gathering = Gathering(PATHS)
        *early, last = [gathering.take(*each) for each in order]
        assert early == [None] * len(PATHS)
        assert last.image is said[0][1]
        assert list(last.scans) == list(PATHS.values())


def test_messages_of_different_frames_are_not_mixed():
    gathering = Gathering(PATHS)
    one, other, restarted = messages(0, 1), messages(1, 2), messages(0, 3)
    taken = [gathering.take(*each) for each in itertools.chain(*zip(one, other, restarted, strict=True))]
    done = [each for each in taken if each]
    assert [each.image.stamp for each in done] == [1, 2, 3]
    assert all(scan.stamp == each.image.stamp for each in done for scan in each.scans.values())


def test_frames_that_are_never_completed_give_way():
    gathering = Gathering(PATHS)
    said = messages()
    for each in said[:-1]:
        gathering.take(*each)
    for seq in range(1, ROOM + 1):
        gathering.take("camera/depth", image(seq=seq, stamp=seq + 1))
    assert gathering.take(*said[-1]) is None


def test_the_papers_scan_is_the_nearer_of_its_two_methods():
    made = frame()
    del made.scans["paper"]
    scans = made.with_paper().scans
    assert list(scans) == [name for name in ORDER if name in scans]
    one, other = (scans[name].ranges for name in ("farthest_point", "virtual_floor"))
    told = np.isfinite(scans["paper"].ranges)
    assert told.any()
    assert np.array_equal(scans["paper"].ranges[told], np.fmin(one, other)[told])
