"""Where numba keeps the compiled kernels, to be known before numba is imported.

Numba refuses to compile where it can write neither beside the sources nor to the user's cache, as with a home and a
package that are read-only.
"""

import logging
import os
import stat
import tempfile
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

VARIABLE = "NUMBA_CACHE_DIR"
COMMON = [Path(__file__).parents[1] / folder for folder in ("contract", "perception")]  # have kernels too

log = logging.getLogger(__name__)


def ensure_writable(package: Iterable[str]) -> None:
    """Have the kernels of a package, given by its `__path__`, kept in a temporary folder where nothing else will do."""
    named = os.environ.get(VARIABLE)
    beside = [folder / "__pycache__" for folder in (*map(Path, package), *COMMON)]
    user = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "numba"
    if (named and _writable(Path(named))) or _writable(user) or all(map(_writable, beside)):
        return
    os.environ[VARIABLE] = str(_own_folder())
    log.warning("no cache folder is writable: compiled kernels are kept in %s", os.environ[VARIABLE])


def _writable(folder: Path) -> bool:
    """Whether files can be made there, as numba tries it."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError:
        return False
    return True


def _own_folder() -> Path:
    """A folder that keeps the kernels from start to start, and that nobody else can put code into."""
    folder = Path(tempfile.gettempdir()) / f"cliffscan-kernels-{os.getuid()}"
    with suppress(FileExistsError):
        folder.mkdir(mode=0o700)
    found = folder.lstat()
    if stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid() and not found.st_mode & 0o022 and _writable(folder):
        return folder
    return Path(tempfile.mkdtemp(prefix="cliffscan-kernels-"))
