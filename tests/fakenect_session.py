"""fakenect: libfreenect's own stand-in, which plays a recorded session through the real interface.

A session is a folder. INDEX.txt names one file per line; d-<unix time [s]>-<60 MHz ticks>.pgm is a depth frame of
640 x 480 raw 11-bit values. fakenect keeps the pace of the times in the names. A process chooses its libraries when
it starts, so each player below runs in one of its own: `python -m tests.fakenect_session PLAYER ARGUMENT ...`.
"""

import os
import subprocess
import sys
from collections.abc import Callable, Iterable
from contextlib import closing
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cliffscan.common.contract.camera import Camera, FloorPlane, Intrinsics
from cliffscan.services.capture.sources.depth_source import DepthFrame, SourceLost
from cliffscan.services.capture.sources.kinect import DepthStream, Kinect

CAMERA = Camera(640, 480, Intrinsics(575.8, 575.8, 314.5, 235.5), (0.5, 4.5), FloorPlane.from_mount(0.30))
HEADER = b"P5 640 480 65535\n"
START = 1_700_000_000.0  # [s since the epoch] any time but 0, which fakenect takes for "no frame yet"


def write_session(folder: Path, frames: Iterable[NDArray[np.uint16]], period: float) -> None:
    """Write depth frames, (480, 640) raw values 0 ... 2047, `period` [s] apart. fakenect checks no size: we do."""
    names = []
    for number, frame in enumerate(frames):
        assert frame.shape == (480, 640)
        seconds = number * period
        names.append(f"d-{START + seconds:.6f}-{round(seconds * 60e6)}.pgm")
        (folder / names[-1]).write_bytes(HEADER + frame.astype("<u2").tobytes())
    (folder / "INDEX.txt").write_text("".join(f"{name}\n" for name in names))


def library_folder() -> Path | None:
    """Where fakenect's libfreenect.so lies, or None. Debian's libfreenect0.5 brings it along with the real one."""
    candidates = [*Path("/usr/lib").glob("*/fakenect"), Path("/usr/local/lib/fakenect")]
    return next((folder for folder in candidates if any(folder.glob("libfreenect.so*"))), None)


def play(session: Path, player: Callable[..., None], *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run a player with fakenect in libfreenect's place."""
    return run(player, *arguments, **session_environment(session))


def session_environment(session: Path) -> dict[str, str]:
    """What makes a process find fakenect and its session; versions after 0.5.3 would loop unless told not to."""
    return {"LD_LIBRARY_PATH": str(library_folder()), "FAKENECT_PATH": str(session), "FAKENECT_LOOP": "0"}


def run(player: Callable[..., None], *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a player with the libraries that the environment names."""
    command = [sys.executable, "-m", "tests.fakenect_session", player.__name__, *arguments]
    settings = os.environ | environment
    root = Path(__file__).parents[1]
    return subprocess.run(command, cwd=root, env=settings, capture_output=True, text=True, timeout=60, check=False)


def serve_all(result: str) -> None:
    """Every frame of the stream, as raw values, into result.npy; nothing can get lost, for there is no queue."""
    frames: list[NDArray[np.uint16]] = []
    with closing(DepthStream("11bit", 0, lambda picture: frames.append(picture[0]))) as stream:
        try:
            while True:
                stream.serve()
        except SourceLost as lost:
            sys.stderr.write(f"{lost}\n")
    np.save(result, np.array(frames))


def read_all(result: str) -> None:
    """What a source's reader gets until the source is lost, into result.npz: depth [mm] and stamp [ns]."""
    frames: list[DepthFrame] = []
    with closing(Kinect(CAMERA, "11bit")) as source:
        try:
            while True:
                frame = source.read(timeout=1.0)
                if frame:
                    frames.append(frame)
        except SourceLost as lost:
            sys.stderr.write(f"{lost}\n")
    np.savez(result, depth=[frame.depth for frame in frames], stamp=[frame.stamp for frame in frames])


def read_two() -> None:
    """Close while the session goes on."""
    with closing(Kinect(CAMERA, "11bit")) as source:
        stamps = [frame.stamp for frame in (source.read(timeout=20.0), source.read(timeout=20.0)) if frame]
    assert len(set(stamps)) == 2


def open_camera_99() -> None:
    """Open a camera that nobody has, and leave with the reason."""
    try:
        Kinect(CAMERA, index=99)
    except SourceLost as lost:
        sys.exit(str(lost))


PLAYERS: dict[str, Callable[..., None]] = {f.__name__: f for f in (serve_all, read_all, read_two, open_camera_99)}

if __name__ == "__main__":
    PLAYERS[sys.argv[1]](*sys.argv[2:])
