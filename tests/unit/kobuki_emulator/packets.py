"""Packets taken apart the slow and obvious way, to the letter of the protocol; the emulator's code is not used."""

import struct

NAMES = {1: "core", 3: "dock_ir", 4: "inertia", 5: "cliff", 6: "current", 10: "hardware", 11: "firmware"}
NAMES |= {13: "gyro", 16: "inputs", 19: "udid", 21: "controller"}
CORE = ["stamp", "bumper", "wheel_drop", "cliff", "left", "right", "left_pwm", "right_pwm"]
CORE += ["button", "charger", "battery", "overcurrent"]


def payloads(stream):
    """The payloads of a stream that holds whole, good frames and nothing else."""
    found = []
    while stream:
        assert stream[:2] == b"\xaa\x55", stream[:8].hex()
        size = stream[2]
        check = 0
        for byte in stream[2 : size + 4]:
            check ^= byte
        assert check == 0
        found.append(stream[3 : size + 3])
        stream = stream[size + 4 :]
    return found


def parts(payload):
    """Sub-payloads by name."""
    found = {}
    while payload:
        size = payload[1]
        assert len(payload) >= size + 2
        found[NAMES[payload[0]]] = payload[2 : size + 2]
        payload = payload[size + 2 :]
    return found


def decoded(payload):
    """Sub-payloads by name, their numbers unpacked; core by field."""
    raw = parts(payload)
    told = {
        "core": dict(zip(CORE, struct.unpack("<HBBBHHbbBBBB", raw["core"]), strict=True)),
        "dock_ir": list(raw["dock_ir"]),
        "inertia": struct.unpack("<hh", raw["inertia"][:4]),
        "cliff": list(struct.unpack("<HHH", raw["cliff"])),
        "current": list(raw["current"]),
        "inputs": struct.unpack("<5H", raw["inputs"][:10]),
        "first": raw["gyro"][0],
        "samples": [struct.unpack_from("<hhh", raw["gyro"], 2 + 6 * n) for n in range(raw["gyro"][1] // 3)],
    }
    assert len(raw["gyro"]) == 2 + 2 * raw["gyro"][1]
    return told | {name: raw[name] for name in ("hardware", "firmware", "udid", "controller") if name in raw}


def packets(stream):
    """Every packet of a stream, decoded."""
    return [decoded(payload) for payload in payloads(stream)]


def command(identifier, layout, *values):
    """A command's frame."""
    data = struct.pack(layout, *values)
    body = bytes([len(data) + 2, identifier, len(data)]) + data
    check = 0
    for byte in body:
        check ^= byte
    return b"\xaa\x55" + body + bytes([check])


def drive(speed, radius=0):
    """Base control: speed [mm/s], radius [mm]."""
    return command(1, "<hh", speed, radius)
