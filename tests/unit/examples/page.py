"""What docs/slam.md shows: its program and its bytes."""

import re
from pathlib import Path

PAGE = (Path(__file__).parents[3] / "docs" / "slam.md").read_text()


def program():
    """The program, as a reader copies it."""
    return _blocks("python")[0]


def dumps():
    """The bytes of each hex dump, without the words beside them."""
    return [bytes.fromhex(re.sub("#.*", "", block)) for block in _blocks("hex")]


def _blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)
