"""A film of the page on a drive past stairs, as an animated GIF: python -m experiments.film FILE. For the README.

What is filmed is `cliffscan view` in a Chromium, on the demo's drive. Run by hand, on a machine with little else to do
and with the system package `chromium`.
"""

import argparse
import base64
import io
import tempfile
import time
from pathlib import Path

from PIL import Image
from rich.console import Console

from cliffscan.common.contract.base_messages import Odometry
from cliffscan.common.contract.topics import ODOMETRY, VELOCITY
from cliffscan.common.runtime.config import SENSING
from cliffscan.common.runtime.stop_signal import StopSignal
from cliffscan.system import Plan, System
from evaluation.processes.network import free_endpoint
from experiments.map_system import RATE
from experiments.mapping import ROUND, WORLD
from experiments.run import Run
from experiments.watched import Rounds, page
from tests.chromium import Chromium

ROBOT, WANTED = "turtlebot", {*SENSING, "kobuki"}
SIZE = (1000, 690)  # [px] of the page, which README shows as it is
EVERY = 0.7  # [s] between two pictures
COLOURS = 48
PACE, LAST = 300, 2500  # [ms] that a picture is shown, and the last one
LONGEST = 240.0  # [s] after which the drive counts as failed


def filmed(run: Run, browser: Chromium) -> list[Image.Image]:
    """The page, from the moment at which all works to the end of one round."""
    port = int(free_endpoint().rpartition(":")[2])
    plan = Plan(ROBOT, [free_endpoint()], overrides=[f"capture.rate={RATE}"], world=WORLD)
    pictures: list[Image.Image] = []
    with System(plan, run.stop) as system:
        system.supervisor.start("view", page(system.plan, port))
        rounds = Rounds(ROUND, system.bus.publisher(VELOCITY))

        def moved(_path: str, payload: bytes) -> None:
            if pictures:
                rounds.moved(Odometry.decode(payload))

        system.bus.subscribe(ODOMETRY.path, moved)
        deadline, due = time.monotonic() + LONGEST, 0.0
        while not rounds.done:
            if time.monotonic() > deadline:
                raise SystemExit(f"no round within {LONGEST:g} s: see {run.log_file}")
            system.poll()
            if not system.alive.issuperset(WANTED):
                run.stop.wait(EVERY)
                continue
            if not due:
                browser.call("Page.navigate", url=f"http://127.0.0.1:{port}/")
                browser.until("/pictures\\/s/.test(document.getElementById('pace').textContent)", system.poll)
            run.stop.wait(max(0.0, due - time.monotonic()))
            due = time.monotonic() + EVERY
            pictures.append(picture(browser))
    return pictures


def picture(browser: Chromium) -> Image.Image:
    """What the page shows."""
    data = browser.call("Page.captureScreenshot", format="png")["data"]
    return Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB")


def save(pictures: list[Image.Image], file: Path) -> None:
    """Write pictures as a film that goes on for ever."""
    middle = pictures[len(pictures) // 2]
    colours = middle.quantize(COLOURS, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    flat = [each.quantize(palette=colours, dither=Image.Dither.NONE) for each in pictures]
    times = [PACE] * (len(flat) - 1) + [LAST]
    flat[0].save(file, save_all=True, append_images=flat[1:], duration=times, loop=0, optimize=True)


def main() -> None:
    """Drive, and write the film."""
    parser = argparse.ArgumentParser(prog="python -m experiments.film", description=__doc__)
    parser.add_argument("file", type=Path, help="the GIF to write")
    file = parser.parse_args().file
    with tempfile.TemporaryDirectory() as out:
        run = Run(Console(), StopSignal(), Path(out), [])
        run.log_file.touch()
        browser = Chromium(Path(out) / "browser")
        try:
            browser.call(
                "Emulation.setDeviceMetricsOverride", width=SIZE[0], height=SIZE[1], deviceScaleFactor=1, mobile=False
            )
            browser.call("Emulation.setScrollbarsHidden", hidden=True)
            save(filmed(run, browser), file)
        finally:
            browser.close()


if __name__ == "__main__":
    main()
