"""A file that is there while the service works: a look at it costs nothing, where a liveliness token costs a session.

The environment names it, for containers and the like; without a name there is none.
"""

import os
from pathlib import Path

from cliffscan.common.runtime.config import ConfigError

VARIABLE = "CLIFFSCAN_ALIVE_FILE"


def mark_alive(works: bool) -> None:
    """Make the file, or take it away. Raises ConfigError where that cannot be done."""
    name = os.environ.get(VARIABLE)
    if not name:
        return
    try:
        if works:
            Path(name).touch()
        else:
            Path(name).unlink(missing_ok=True)
    except OSError as error:
        raise ConfigError(f"{VARIABLE}={name}: {error.strerror}: name a file that this user may write") from error
