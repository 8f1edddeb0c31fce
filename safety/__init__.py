"""The safety gate as a library: what keeps a base of any make from falling and from hitting.

A driver translates its base into `inputs` and asks a `MessageGate`:

    gate = MessageGate(limits, warn)
    gate.command(velocity, stamp, now)  # messages as they come
    gate.scan(scan, stamp, now)
    gate.describe(camera)
    gate.sense(contacts, pose, stamp)  # at each packet of the base
    allowed = gate.decide(now).allowed  # goes to the wheels
"""
