"""The definitions of the ROS messages of a recording, which a reader without ROS needs to understand it."""

from functools import cache
from importlib.resources import files

SEPARATOR = "=" * 80 + "\n"  # between the definitions of one schema


def schema(name: str) -> str:
    """The definition of a message, as sensor_msgs/msg/LaserScan, and of all that it is made of: a ros2msg schema.

    Raises KeyError for one that definitions.msg lacks.
    """
    table = _table()
    first, *others = _used(name.replace("/msg/", "/"))
    return "".join((table[first], *(f"{SEPARATOR}MSG: {other}\n{table[other]}" for other in others)))


def _used(name: str) -> list[str]:
    """The message and all that it is made of, each once."""
    found = [name]
    for each in found:
        kinds = (line.split()[0].partition("[")[0] for line in _table()[each].splitlines())
        found += dict.fromkeys(kind for kind in kinds if "/" in kind and kind not in found)
    return found


@cache
def _table() -> dict[str, str]:
    """The definitions by name: those of Jazzy without comments, and our own."""
    text = (files(__package__) / "definitions.msg").read_text("utf-8")
    parts = (part.partition("\n") for part in text.split("MSG: ")[1:])
    return {name: body for name, _, body in parts}
