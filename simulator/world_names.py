"""The names of the worlds, for programs that need not load one."""

from importlib.resources import files

RANDOM = "random:"  # with a seed, the name of a random floor


def world_names() -> list[str]:
    """Names of the worlds that come with the simulator, in alphabetical order."""
    folder = files("cliffscan.simulator") / "worlds"
    return sorted(entry.name.removesuffix(".xml") for entry in folder.iterdir() if entry.name.endswith(".xml"))
