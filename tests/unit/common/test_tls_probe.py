"""Why an endpoint cannot be reached is one line, whatever its host is called."""

import pytest

from cliffscan.common.runtime.tls_probe import why_unreachable


@pytest.mark.parametrize("host", ["robot..local", "x" * 70, "."])
@pytest.mark.parametrize("protocol", ["tcp", "tls"])
def test_a_host_that_can_have_no_such_name(protocol, host):
    endpoint = f"{protocol}/{host}:7447"
    assert why_unreachable(endpoint, None) == f"{endpoint}: no host can have that name: is it right?"
