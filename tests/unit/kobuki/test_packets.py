"""Every sub-payload is read to SI units, and one that cannot be read costs nothing but itself."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cliffscan.services.kobuki.protocol.packets import READERS, Feedback, decode
from cliffscan.services.kobuki.protocol.sensors import (
    Bumper,
    Button,
    Charger,
    Cliff,
    DockSignal,
    GainSet,
    Overcurrent,
    WheelDrop,
)
from cliffscan.services.kobuki.protocol.versions import UNREPORTED, Version
from tests.kobuki_stream import core, gyro, inertia, sub_payload, usual_payload

OLD = bytes.fromhex(
    "0120a8000000fd32de3c00000016a503000000042f24feff888888056a0644077206060000104800ff0fff0fff0fff0ff20f00000000"
)  # a real base before 1.0.0
degrees = math.radians

readable = st.sampled_from(
    [
        core(1000),
        inertia(-4500, 900),
        gyro((10, -20, 30)),
        sub_payload(5, "<3H", 1, 2, 3),
        sub_payload(19, "<3I", 1, 2, 3),
    ]
)
sizes = {1: 15, 3: 3, 4: 7, 5: 6, 6: 2, 10: 4, 11: 4, 16: 16, 19: 12, 21: 13}
unreadable = st.one_of(
    st.tuples(st.integers(0, 255).filter(lambda ident: ident not in READERS), st.binary(max_size=12)),
    st.sampled_from(sorted(sizes)).flatmap(
        lambda ident: st.tuples(
            st.just(ident), st.binary(max_size=20).filter(lambda data: len(data) not in (2, sizes[ident]))
        )
    ),
).map(lambda parts: bytes([parts[0], len(parts[1])]) + parts[1])


def test_the_core():
    data = core(
        61840, 65532, 18264, bumper=5, drop=1, cliff=4, pwm=(-30, 31), buttons=2, charger=6, battery=159, over=1
    )
    assert decode(data).core == (
        61840,
        Bumper.LEFT | Bumper.RIGHT,
        WheelDrop.RIGHT,
        Cliff.LEFT,
        65532,
        18264,
        -30,
        31,
        Button.B1,
        Charger.DOCK_CHARGING,
        15.9,
        Overcurrent.LEFT,
    )


def test_the_flags_of_both_wheels_are_numbered_differently():
    left = decode(core(drop=2, over=1)).core
    right = decode(core(drop=1, over=2)).core
    assert (left.wheel_drop, left.overcurrent) == (WheelDrop.LEFT, Overcurrent.LEFT)
    assert (right.wheel_drop, right.overcurrent) == (WheelDrop.RIGHT, Overcurrent.RIGHT)


@pytest.mark.parametrize(
    ("kind", "names"),
    [
        (Bumper, "RIGHT CENTRE LEFT"),
        (WheelDrop, "RIGHT LEFT"),
        (Cliff, "RIGHT CENTRE LEFT"),
        (Button, "B0 B1 B2"),
        (Overcurrent, "LEFT RIGHT"),
        (DockSignal, "NEAR_LEFT NEAR_CENTRE NEAR_RIGHT FAR_CENTRE FAR_LEFT FAR_RIGHT"),
    ],
)
def test_flags_are_numbered_from_the_lowest_bit(kind, names):
    assert {flag.name: flag.value for flag in kind} == {name: 1 << bit for bit, name in enumerate(names.split())}


def test_bits_without_a_meaning_are_no_news():
    found = decode(core(bumper=0xF8, drop=0xFC, cliff=0xF8, buttons=0xF8, over=0xFC)).core
    assert not any((found.bumper, found.wheel_drop, found.cliff, found.buttons, found.overcurrent))


@pytest.mark.parametrize(
    ("code", "charger", "charging", "charged"),
    [
        (0, Charger.DISCHARGING, False, False),
        (2, Charger.DOCK_CHARGED, False, True),
        (6, Charger.DOCK_CHARGING, True, False),
        (18, Charger.ADAPTER_CHARGED, False, True),
        (22, Charger.ADAPTER_CHARGING, True, False),
        (77, Charger.UNKNOWN, False, False),
    ],
)
def test_the_charger(code, charger, charging, charged):
    found = decode(core(charger=code)).core.charger
    assert (found, found.charging, found.charged) == (charger, charging, charged)


def test_the_docks_signals():
    found = decode(sub_payload(3, "<3B", 1, 2 | 8, 4 | 32)).dock_ir
    assert found == (
        DockSignal.NEAR_LEFT,
        DockSignal.NEAR_CENTRE | DockSignal.FAR_CENTRE,
        DockSignal.NEAR_RIGHT | DockSignal.FAR_RIGHT,
    )
    assert (found.right, found.left) == (found[0], found[2])


def test_the_inertia():
    assert decode(inertia(-17999, 32767)).inertia == pytest.approx((degrees(-179.99), degrees(327.67)))


def test_cliffs_currents_and_the_unique_number():
    found = decode(
        sub_payload(5, "<3H", 0, 4095, 2048)
        + sub_payload(6, "<2B", 7, 250)
        + sub_payload(19, "<3I", 97713968, 2, 2**32 - 1)
    )
    assert (found.cliff.right, found.cliff.centre, found.cliff.left) == (0, 4095, 2048)
    assert (found.current.left, found.current.right) == (0.07, 2.5)
    assert str(found.udid) == "97713968-2-4294967295"


def test_the_gyros_axes_are_turned_to_the_robots():
    found = decode(gyro((10, -20, 30), (0, 0, -32768), frame_id=254)).gyro
    assert found.frame_id == 254
    assert found.samples[0] == pytest.approx((degrees(0.175), degrees(0.0875), degrees(0.2625)))
    assert found.samples[1] == pytest.approx((0, 0, degrees(-286.72)))


def test_the_newest_sample_of_the_gyro_is_from_now():
    now = 1_700_000_000_000_000_000
    assert decode(gyro(*[(0, 0, 0)] * 3)).gyro.stamps(now) == (now - 20_000_000, now - 10_000_000, now)


@pytest.mark.parametrize("samples", [0, 1, 2, 3, 8, 30, 42])
def test_a_packet_may_hold_any_number_of_samples(samples):
    payload = gyro(*[(n, 0, 0) for n in range(samples)])
    assert [round(math.degrees(each.y) / 0.00875) for each in decode(payload).gyro.samples] == list(range(samples))


@pytest.mark.parametrize("bit", range(16))
def test_each_digital_input_has_its_bit(bit):
    found = decode(sub_payload(16, "<5H6x", 1 << bit, 0, 0, 0, 0)).gp_input
    assert found.digital == tuple(bit == number for number in range(4))


def test_the_analog_inputs():
    found = decode(sub_payload(16, "<5H6x", 0, 4095, 1365, 2048, 1)).gp_input
    assert found.analog == pytest.approx((3.3, 1.1, 1.6504, 0.0008), abs=1e-4)


def test_the_gains():
    assert decode(sub_payload(21, "<B3I", 0, 100000, 100, 2000)).gains == (GainSet.FACTORY, 100.0, 0.1, 2.0)
    assert decode(sub_payload(21, "<B3I", 1, 90000, 50, 1500)).gains == (GainSet.USER, 90.0, 0.05, 1.5)
    assert [str(each) for each in decode(sub_payload(21, "<B3I", 2, 0, 0, 0)).skipped] == [
        "sub-payload 21: gains of type 2, expected 0 (factory) or 1 (user)"
    ]


@pytest.mark.parametrize("samples", [2, 3])
def test_the_usual_payload_holds_the_usual(samples):
    payload = usual_payload(20, 3, 4, samples)
    found = decode(payload)
    assert len(payload) == {2: 77, 3: 83}[samples]
    present = {name for name, value in found._asdict().items() if value is not None}
    assert present == {"core", "dock_ir", "inertia", "cliff", "current", "gyro", "gp_input", "skipped"}
    assert not found.skipped
    assert (found.core.left_encoder, found.core.right_encoder, len(found.gyro.samples)) == (3, 4, samples)


def test_an_empty_payload_is_no_news():
    assert decode(b"") == Feedback()


def test_firmware_before_1_0_0_is_known_by_its_packets():
    assert decode(OLD) == Feedback(firmware=UNREPORTED)


def test_other_payloads_of_54_bytes_are_read():
    payload = core(0x0F01) + sub_payload(99, "<35B", *range(35))
    assert len(payload) == len(OLD)
    assert decode(payload).core.timestamp == 0x0F01


@pytest.mark.parametrize(
    ("ident", "size", "why"),
    [
        (1, 14, "14 bytes, expected 15"),
        (1, 16, "16 bytes, expected 15"),
        (4, 0, "0 bytes, expected 7"),
        (11, 3, "3 bytes, expected 4"),
        (13, 0, "0 bytes, expected 2"),
        (13, 8, "6 bytes of samples, expected 3 numbers of 2 bytes each, 0 in all"),
        (99, 4, "unknown id"),
    ],
)
def test_what_cannot_be_read_is_listed_and_skipped(ident, size, why):
    found = decode(inertia(100) + bytes([ident, size]) + bytes(size) + core(77))
    assert found.core.timestamp == 77
    assert found.inertia.angle == pytest.approx(degrees(1))
    assert found.skipped == ((ident, why),)


@pytest.mark.parametrize("cut", range(1, 17))
def test_a_sub_payload_that_runs_past_the_end_is_listed(cut):
    found = decode((inertia(100) + core(77))[:-cut])
    assert found.inertia.angle == pytest.approx(degrees(1))
    assert found.core is None
    assert found.skipped == ((1, "runs past the end of its packet"),)


@given(st.lists(st.tuples(readable, st.lists(unreadable, max_size=3)), max_size=4))
def test_nothing_is_lost_beside_what_cannot_be_read(parts):
    clean = b"".join(good for good, _ in parts)
    mixed = b"".join(good + b"".join(bad) for good, bad in parts)
    found = decode(mixed)
    assert found._replace(skipped=()) == decode(clean)
    assert [each.id for each in found.skipped] == [bad[0] for _, all_bad in parts for bad in all_bad]


@given(st.binary(max_size=255))
def test_no_payload_raises(payload):
    found = decode(payload)
    assert all(each.why for each in found.skipped)


def test_a_sub_payload_without_data_may_be_the_last():
    assert decode(core(77) + bytes([99, 0])).skipped == ((99, "unknown id"),)


def test_a_later_sub_payload_counts():
    assert decode(core(1) + core(2)).core.timestamp == 2
    assert decode(sub_payload(11, "<4B", 0, 2, 1, 0)).firmware == Version(1, 2, 0)
