"""Score every method of negative on random scenes: python -m benchmarks.accuracy [--scenes N] [--seed S] ..."""

import argparse
import os
from collections.abc import Sequence
from pathlib import Path

from benchmarks.accuracy.cases import Case, some_cases
from benchmarks.accuracy.frames import KNOWN, PLANES
from benchmarks.accuracy.measure import measure
from benchmarks.accuracy.report import report
from benchmarks.accuracy.rows import Row, Table, worst
from benchmarks.accuracy.scans import BEST, known_scans
from benchmarks.accuracy.setups import SETUPS
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
    parser.add_argument("--quick", action="store_true", help=f"{QUICK} scenes, plane known")
    parser.add_argument("--pictures", type=int, default=PICTURES, help=f"of the worst cases, each plane ({PICTURES})")
    parser.add_argument("--only", type=Case.parse, metavar="KIND:SEED", help="replay one case, in detail")
    return parser.parse_args()


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


def main() -> None:
    """Measure, and write what was found."""
    options = arguments()
    scenes = QUICK if options.quick else options.scenes
    cases = [options.only] if options.only else some_cases(scenes, options.seed, options.setups)
    modes = (KNOWN,) if options.quick else options.planes
    options.out.mkdir(parents=True, exist_ok=True)
    table = measure(cases, options.methods, modes, options.jobs)
    if options.only:
        replay(table, options.methods, options.out)
        return
    text = report(table)
    print(text)
    (options.out / "accuracy.md").write_text(text)
    write_csv((row.record() for row in table.rows), options.out / "cases.csv")  # by which a case is found and replayed
    pictures = options.out / "worst"
    for stale in pictures.glob("*.png"):
        stale.unlink()
    best = BEST if BEST in options.methods else options.methods[-1]
    for plane in unique(row.plane for row in table.rows):
        show(worst(table.rows, best, plane, options.pictures), options.methods, pictures)


if __name__ == "__main__":
    main()
