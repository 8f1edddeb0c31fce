"""What an observation means: each finding with its remedy. Nothing here listens or waits."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from cliffscan.clocks import TOLERATED
from cliffscan.common.contract.description import CameraDescription
from cliffscan.common.contract.topics import DEPTH, ODOMETRY, SCAN_FUSED
from cliffscan.doctor.finding import Finding, Level, fault, ok, warning
from cliffscan.doctor.observation import STREAMS, Floor, Observation
from cliffscan.doctor.stream import Stream, measure
from cliffscan.health import SETTLED, Health, examine
from cliffscan.parts import KOBUKI

CHRONY = "synchronise both hosts (chrony, docs/deployment.md)"
REFUSES = 0.5  # [s] by which a command's stamp may be off before it moves nothing
ODOMETRY_RATE, KINECT_RATE = 50.0, 30.0  # [Hz]
SLOW, STANDS = 0.9, 0.5  # share of the expected rate below which a stream is too slow, and no use
LOSSY, BROKEN = 0.01, 0.1  # share of lost samples
LATE = 0.15  # [s] of jitter
MEGABIT = 125_000  # [bytes]
TILT, RISE = math.radians(1.0), 0.02  # [rad], [m] by which a mount may differ from the floor that is measured
MOST_TILT, MOST_RISE = math.radians(4.5), 0.045  # beyond, the floor is about to be lost: 5 degrees and 5 cm
THINNER = "the link is too thin: go nearer to the radio, or give `--perception` to the robot (docs/deployment.md)"
TOO_SLOW = "frames came without a scan: the link, or the host that makes the scans, is too slow (docs/deployment.md)"
SLOW_WRITER = "nothing is lost on the way, so what publishes it is slow: is that host overloaded (top)?"


def verdicts(seen: Observation, version: str) -> Iterator[Finding]:
    """All findings about services, versions, clocks, streams and mount. version: of this machine."""
    yield from _services(seen)
    yield _versions(seen, version)
    yield from _clocks(seen)
    yield from _streams(seen)
    if seen.camera:
        yield _mount(seen.camera, seen.floors)


def _services(seen: Observation) -> Iterator[Finding]:
    for health in examine(seen.alive, seen.statuses, seen.clocks, seen.at):
        yield Finding(_level(health), health.name, _in_words(health))


def _level(health: Health) -> Level:
    """How bad a service's state is; a robot without a base still has scans."""
    if health.state == "not found":
        return Level.WARNING if health.name == KOBUKI else Level.FAULT
    status = health.status
    idle = status is not None and status.rate == 0.0 and status.uptime > SETTLED and bool(health.notes)
    if idle or health.state in ("gone", "waiting"):
        return Level.FAULT
    return Level.WARNING if health.notes or health.state == "starting" else Level.OK


def _in_words(health: Health) -> str:
    if health.state == "not found":
        return f"is not found: `cliffscan run {health.name}`, or let the router of its host join this one"
    rate = f", {health.status.rate:.1f} Hz" if health.status and health.status.rate else ""
    return "; ".join([f"{health.state}{rate}", *health.notes])


def _versions(seen: Observation, here: str) -> Finding:
    others = {name: last.status.version for name, last in sorted(seen.statuses.items()) if last.status.version != here}
    if others:
        named = ", ".join(f"{name} {version}" for name, version in others.items())
        return warning("versions", f"{here} here, and {named}: install the same on both hosts")
    return ok("versions", f"{here} everywhere")


def _clocks(seen: Observation) -> Iterator[Finding]:
    """One finding for each clock that is off; one in all where none is."""
    if not seen.ways:
        return
    off = {name: -way * 1e-9 for name, way in sorted(seen.ways.items()) if abs(way) * 1e-9 > TOLERATED}
    for name, ahead in off.items():
        way = "ahead of" if ahead > 0 else "behind"
        text = f"is {abs(ahead):.2f} s {way} this machine's{', or its messages take that long' * (ahead < 0)}"
        if abs(ahead) > REFUSES:
            yield fault(f"clock of {name}", f"{text}; the base refuses commands of such a clock: {CHRONY}")
        else:
            yield warning(f"clock of {name}", f"{text}: {CHRONY}")
    if not off:
        furthest = max(map(abs, seen.ways.values())) * 1e-6
        yield ok("clocks", f"of {len(seen.ways)} services are within {furthest:.0f} ms of this machine's")


def _streams(seen: Observation) -> Iterator[Finding]:
    """Rate, loss and jitter of each stream that came, and of those that should have come."""
    expected = expected_rates(seen)
    total = 0.0
    for topic in STREAMS:
        arrivals = seen.streams.get(topic.path, [])
        stream = measure(arrivals)
        total += stream.bytes_per_second
        if topic.path in seen.malformed:
            yield fault(topic.path, "carries malformed messages: does a foreign program publish there?")
            continue
        published = _published(seen, topic.writer)
        if arrivals:
            yield _stream(topic.path, stream, expected[topic.path], published)
        elif published:
            yield fault(topic.path, f"nothing arrives, though {published:.1f} Hz are published: {THINNER}")
    if total:
        yield ok("link", f"{total / MEGABIT:.1f} Mbit/s of these streams arrive here")


def expected_rates(seen: Observation) -> dict[str, float]:
    """How often [Hz] each stream should come: scans as often as frames, frames as their camera says."""
    periods = [floor.period for floor in seen.floors if floor.period > 0.0]
    frames = 1.0 / float(np.median(periods)) if periods else KINECT_RATE
    return {topic.path: ODOMETRY_RATE if topic is ODOMETRY else frames for topic in STREAMS}


def _published(seen: Observation, writer: str) -> float:
    """How often [Hz] the service that writes a stream says that it does; 0 where it does not say."""
    rates = seen.rates.get(writer.partition(",")[0])
    return float(np.mean(rates)) if rates else 0.0


def _stream(path: str, stream: Stream, expected: float, published: float) -> Finding:
    """What is lost, is lost on the way; what is slow without being lost comes from a slow writer."""
    counted = path != ODOMETRY.path  # by sequence numbers, which odometry lacks
    figures = f"{stream.rate:.1f} of {expected:.0f} Hz, {stream.bytes_per_second / MEGABIT:.2f} Mbit/s"
    figures += f", {stream.lost:.1%} lost" * counted + f", jitter {1e3 * stream.jitter:.0f} ms"
    remedy = THINNER if path in (DEPTH.path, ODOMETRY.path) else TOO_SLOW
    if stream.lost > LOSSY or (not counted and stream.rate < SLOW * published):
        broken = stream.lost > BROKEN or stream.rate < STANDS * published
        return (fault if broken else warning)(path, f"{figures}: {remedy}")
    if stream.rate < SLOW * expected:
        return (fault if stream.rate < STANDS * expected else warning)(path, f"{figures}: {SLOW_WRITER}")
    if path == SCAN_FUSED.path and stream.jitter > LATE:
        return warning(path, f"{figures}: {remedy}")
    return ok(path, figures)


def _mount(camera: CameraDescription, floors: list[Floor]) -> Finding:
    """The mount that is described, against the floor in the frames."""
    if camera.height is None or camera.pitch is None or camera.roll is None:
        return ok("mount", "the camera does not describe its mount")
    if not floors:
        return warning("mount", "cannot be checked without frames: see capture above")
    said = np.array([camera.height, camera.pitch, camera.roll])
    found = np.median([floor.plane.mount() for floor in floors], axis=0)
    off = np.abs(found - said)
    words = f"said {_mount_in_words(said)}, measured {_mount_in_words(found)}"
    remedy = "`cliffscan calibrate` on level, empty floor, and set capture.height, pitch and roll"
    if off[0] > MOST_RISE or off[1:].max() > MOST_TILT:
        return fault("mount", f"{words}: {remedy}")
    if off[0] > RISE or off[1:].max() > TILT:
        return warning("mount", f"{words}: {remedy}")
    return ok("mount", words if off.any() else f"{words}, or not measured at all")


def _mount_in_words(mount: NDArray[np.float64]) -> str:
    pitch, roll = (round(float(angle), 1) + 0.0 for angle in np.degrees(mount[1:]))  # no -0.0
    return f"{mount[0]:.3f} m high, {pitch:.1f} deg down, {roll:.1f} deg aside"
