"""The port of the base is never let go of without a stop."""

import os
import pty
import select
import signal
import tty

from cliffscan.services.kobuki.port import Port, PortLost
from cliffscan.services.kobuki.protocol.commands import base_control
from tests.service.conftest import wait_until

STOP = base_control(0.0, 0.0)


def test_a_base_whose_guard_has_died_is_stopped_before_the_port_is_closed():
    base, end = pty.openpty()
    tty.setraw(end)
    port = Port(os.ttyname(end))
    port.write(base_control(0.5, 0.0))
    os.kill(port._guard.pid, signal.SIGKILL)

    def dead():
        try:
            port.beat()
        except PortLost:
            return True
        return False

    wait_until(dead)
    port.close()
    said = b""
    while select.select([base], [], [], 0.0)[0]:
        said += os.read(base, 4096)
    assert said.endswith(STOP)
    os.close(base)
    os.close(end)
