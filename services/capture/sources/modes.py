"""Which of a camera's image sizes and rates is taken."""

from collections.abc import Sequence

from cliffscan.common.runtime.config import ConfigError

RATE = 30  # [Hz] wanted
MOST_PIXELS = 848 * 480  # unless a size is configured: what a D435 measures best with, and more than a Kinect has

Mode = tuple[int, int, int]  # width, height [px], rate [Hz]


def best_mode(modes: Sequence[Mode], size: Sequence[int], name: str) -> int:
    """The place in `modes` of the one nearest to RATE, and of these the largest; of the configured `size`, if any.

    Raises ConfigError where the camera `name` has no such size.
    """
    offered = sorted({mode[:2] for mode in modes})
    wanted = [tuple(size)] if size else [each for each in offered if each[0] * each[1] <= MOST_PIXELS] or offered
    places = [place for place, mode in enumerate(modes) if mode[:2] in wanted]
    if not places:
        has = ", ".join(f"[{width}, {height}]" for width, height in offered)
        raise ConfigError(f"capture.size: {name} has no depth of {list(size)}; choose one of {has or 'none'}")
    return min(places, key=lambda place: (abs(modes[place][2] - RATE), -modes[place][0] * modes[place][1]))
