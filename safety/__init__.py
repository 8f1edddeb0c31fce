"""The safety gate as a library: what keeps a base of any make from falling and from hitting.

A driver translates its base into `inputs` and asks a `MessageGate`:

    gate = MessageGate(limits, wheel_separation, warn)
    gate.command(velocity, stamp, now)  # messages as they come
    gate.scan(scan, stamp, now)
    gate.describe(camera)
    gate.report(report, stamp, now)  # at each report of the base
    gate.caught_up()  # when all that the base sent has been read
    allowed = gate.decide(now).allowed  # goes to the wheels
"""
