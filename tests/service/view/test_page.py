"""The page in a real Chromium, beside a gate that drives an emulated base."""

import pytest

from tests.chromium import Chromium

RULE = "document.getElementById('why').dataset.rule"
TEXT = "document.getElementById('{}').textContent"


@pytest.fixture
def chromium(tmp_path):
    made = Chromium(tmp_path / "browser")
    yield made
    made.close()


def test_the_page_says_what_holds_the_robot_and_stops_it(base, view, chromium):
    chromium.call("Page.navigate", url=view.address)
    wall = (0.6,)

    def drive():
        base.see(*wall)
        base.drive(0.2)

    chromium.until(f"{RULE} === 'obstacle'", drive)
    chromium.until(f"{TEXT.format('headline')} === 'Stopped: obstacle ahead'", drive)
    assert "m to go" in chromium.value(TEXT.format("reason"))
    chromium.until(f"{TEXT.format('base')}.includes('+0.20 m/s')", drive)  # what is asked
    chromium.until(f"/\\d+ pictures/.test({TEXT.format('pace')})", drive)
    pixel = "document.getElementById('plan').getContext('2d').getImageData(0, 0, 600, 600).data.some((each) => each)"
    assert chromium.value(pixel)
    chromium.value("document.getElementById('stop').click()")
    chromium.until(f"{RULE} === 'stopped'")
    chromium.until("!document.getElementById('clear').hidden")
    chromium.value("document.getElementById('clear').click()")
    chromium.value("document.querySelector('#sure button[value=\"\"]').click()")  # it is asked for again
    chromium.value("document.getElementById('clear').click()")
    chromium.value("document.querySelector('#sure button[value=clear]').click()")
    chromium.until(f"{RULE} !== 'stopped'")
    base.client.session.close()
    chromium.until(f"{TEXT.format('notice')}.startsWith('No router answers')")
    assert chromium.errors == []
