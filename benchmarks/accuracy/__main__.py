"""Score every method of negative on random scenes: python -m benchmarks.accuracy [--scenes N] [--seed S] ..."""

import argparse
import os
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from benchmarks.accuracy.cases import Case, some_cases
from benchmarks.accuracy.folders import folder_section
from benchmarks.accuracy.foreign import DEADLINE, ForeignError, ForeignProgram
from benchmarks.accuracy.frames import KNOWN, PLANES
from benchmarks.accuracy.measure import measure
from benchmarks.accuracy.report import report
from benchmarks.accuracy.rows import Row, Table, worst
from benchmarks.accuracy.scans import ANGLES, BEST, Others, known_scans
from benchmarks.accuracy.setups import SETUPS
from cliffscan.common.runtime.config import ConfigError
from cliffscan.common.runtime.network import BusError
from cliffscan.services.capture.window import Size
from evaluation.options import some_of
from evaluation.tables import unique, write_csv

OUT = Path("out/accuracy")
QUICK = 60  # scenes
PICTURES = 4  # of each plane mode


def arguments() -> argparse.Namespace:
    """The options."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.accuracy", description=__doc__)
    parser.add_argument("--scenes", type=int, default=400, help="about how many, level and mounted (400)")
    parser.add_argument("--seed", type=int, default=1, help="of all random numbers (1)")
    parser.add_argument("--methods", nargs="+", choices=[*known_scans()], default=[*known_scans()], help="all, if none")
    parser.add_argument(
        "--planes", type=some_of(PLANES), default=PLANES, help=f"with commas between ({','.join(PLANES)})"
    )
    parser.add_argument(
        "--setups", type=some_of(tuple(SETUPS)), default=tuple(SETUPS), help=f"with commas between ({','.join(SETUPS)})"
    )
    parser.add_argument("--out", type=Path, default=OUT, help=f"folder of the results ({OUT})")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes (one for each core)")
    parser.add_argument(
        "--every",
        type=int,
        choices=[size.value for size in Size],
        default=1,
        help="score frames as they go over a thin link: one of so many columns (1, all)",
    )
    parser.add_argument("--quick", action="store_true", help=f"{QUICK} scenes, plane known")
    parser.add_argument("--pictures", type=int, default=PICTURES, help=f"of the worst cases, each plane ({PICTURES})")
    parser.add_argument(
        "--foreign",
        metavar="COMMAND",
        help="score this program too: it connects to the Zenoh endpoint {endpoint} ($CLIFFSCAN_ENDPOINT), receives "
        "{robot}/camera/depth ($CLIFFSCAN_ROBOT) and publishes a LaserScan with each image's stamp at {robot}/KEY",
    )
    parser.add_argument("--key", metavar="KEY", help="on which that program publishes, as scan/mine")
    parser.add_argument("--deadline", type=float, default=DEADLINE, help=f"[s] for its scan of an image ({DEADLINE:g})")
    parser.add_argument(
        "--frames", type=Path, action="append", default=[], metavar="DIR", help="count the scans of a depth folder too"
    )
    parser.add_argument("--only", type=Case.parse, metavar="KIND:SEED", help="replay one case, in detail")
    options = parser.parse_args()
    if bool(options.foreign) != bool(options.key):
        parser.error("--foreign COMMAND and --key KEY are given together: the program, and where it publishes")
    return options


def show(rows: Sequence[Row], scans: Sequence[str], out: Path) -> None:
    """Write a picture of each row's case, all scans in it."""
    from benchmarks.accuracy.pictures import draw  # needs matplotlib

    out.mkdir(parents=True, exist_ok=True)
    for number, row in enumerate(rows, start=1):
        name = f"{row.plane}-{number}-{row.case.name}.png".replace(", ", "-").replace(":", "-")
        print(draw(row.case, row.plane, scans, out / name))


def replay(table: Table, scans: Sequence[str], out: Path) -> None:
    """Print all that was measured of one case, and write its picture in each plane mode."""
    for row in table.rows:
        print(", ".join(f"{key} {value}" for key, value in row.record().items()))
    show([row for row in table.rows if row.scan == scans[0]], scans, out)


def score(options: argparse.Namespace, foreign: ForeignProgram | None) -> None:
    """Measure, and write what was found. Raises ForeignError, ConfigError."""
    scenes = QUICK if options.quick else options.scenes
    cases = [options.only] if options.only else some_cases(scenes, options.seed, options.setups)
    modes = (KNOWN,) if options.quick else options.planes
    others: Others = {foreign.path: partial(foreign.beams, angles=ANGLES)} if foreign else {}
    options.out.mkdir(parents=True, exist_ok=True)
    table = measure(cases, options.methods, modes, 1 if foreign else options.jobs, others, options.every)
    if options.only:
        replay(table, options.methods, options.out)
        return
    folders = [folder_section(folder, options.methods, others) for folder in options.frames]
    text = report(table, [foreign.note] if foreign else [], folders)
    print(text)
    (options.out / "accuracy.md").write_text(text)
    if table.rows:
        write_csv((row.record() for row in table.rows), options.out / "cases.csv")  # a case is found and replayed by it
    pictures = options.out / "worst"
    for stale in pictures.glob("*.png"):
        stale.unlink()
    best = BEST if BEST in options.methods else options.methods[-1]
    for plane in unique(row.plane for row in table.rows):
        show(worst(table.rows, best, plane, options.pictures), options.methods, pictures)


def main() -> None:
    """Measure our methods, and beside them a program of somebody else's."""
    options = arguments()
    try:
        if options.foreign:
            with ForeignProgram(options.foreign, options.key, options.deadline) as foreign:
                score(options, foreign)
        else:
            score(options, None)
    except (ForeignError, ConfigError, BusError) as error:
        print(error, file=sys.stderr)
        raise SystemExit(2) from error


if __name__ == "__main__":
    main()
