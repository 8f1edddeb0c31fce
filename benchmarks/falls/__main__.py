"""Let robots wander through random worlds, and count what happens to them: python -m benchmarks.falls ..."""

import argparse
import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import get_args

from benchmarks.falls.bases import Base
from benchmarks.falls.cases import Case, all_cases, length
from benchmarks.falls.log import Outcome
from benchmarks.falls.perception import Mode
from benchmarks.falls.process_trial import OVERRIDES, through_processes
from benchmarks.falls.report import event_record, report, run_record, write
from benchmarks.falls.trial import Trial, measure
from evaluation.options import some_of
from evaluation.workers import counted

OUT = Path("out/falls")
SPEEDS = (0.2, 0.35, 0.5)  # [m/s]
MODES: tuple[Mode, ...] = get_args(Mode)
BASES: tuple[Base, ...] = get_args(Base)


def arguments() -> argparse.Namespace:
    """The options."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.falls", description=__doc__)
    parser.add_argument(
        "--minutes", type=minutes, default=1000.0, help="to simulate in each mode, if nobody falls (1000)"
    )
    parser.add_argument("--worlds", type=int, default=60, help="how many, shared by the speeds (60)")
    parser.add_argument("--speeds", type=speeds, default=SPEEDS, help="[m/s], with commas between (0.2,0.35,0.5)")
    parser.add_argument("--modes", type=some_of(MODES), default=MODES, help=f"with commas between ({','.join(MODES)})")
    parser.add_argument(
        "--base", choices=BASES, default=BASES[0], help="the robot; all but a TurtleBot 2 are behind services/gate"
    )
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes (one for each core)")
    parser.add_argument("--seed", type=int, default=0, help="of the first world (0)")
    parser.add_argument("--out", type=Path, default=OUT, help=f"folder of the results ({OUT})")
    parser.add_argument("--only", type=Case.parse, metavar="MODE:SPEED:SEED[:BASE]", help="replay one run, and draw it")
    parser.add_argument(
        "--processes",
        action="store_true",
        help="through the real services, one run after the other, at the clock's pace",
    )
    options = parser.parse_args()
    if options.processes and options.base != BASES[0]:
        parser.error(f"--processes runs a {BASES[0]}: leave out --base {options.base}")
    if options.processes and options.only:
        parser.error("--only replays what the processes do not: a run that is the same again")
    if options.processes and (unknown := set(options.modes) - set(OVERRIDES)):
        parser.error(f"no services for the mode {', '.join(unknown)}: say --modes {','.join(OVERRIDES)}")
    return options


def minutes(text: str) -> float:
    """A time span [min]. Raises ArgumentTypeError for what is none."""
    value = float(text)
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} minutes, expected more than 0")
    return value


def speeds(text: str) -> tuple[float, ...]:
    """The speeds [m/s] of an option. Raises ArgumentTypeError for what is none."""
    try:
        values = tuple(map(float, text.split(",")))
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None
    if not all(0.0 < value <= 1.0 for value in values):
        raise argparse.ArgumentTypeError("expected speeds above 0, up to 1 m/s")
    return values


def replay(case: Case, metres: float, out: Path) -> None:
    """Print what happens in one run, and write its picture."""
    from benchmarks.falls.pictures import draw  # needs matplotlib

    trial = Trial(case)
    outcome = trial.run(metres / case.speed)
    print(", ".join(f"{key} {value}" for key, value in run_record(outcome).items()))
    for event in outcome.events:
        print(", ".join(f"{key} {value}" for key, value in event_record(outcome, event).items()))
    picture = out / f"{case.file_name}.png"
    draw(outcome, trial.log.track, trial.robot.world, trial.robot.size.radius, picture)
    print(picture)


def noted(runs: Iterator[Outcome], count: int, metres: float, out: Path) -> list[Outcome]:
    """What comes of all runs; the progress is shown, and after each run the files tell of it."""
    outcomes: list[Outcome] = []

    def so_far() -> str:
        minutes, falls = sum(o.seconds for o in outcomes) / 60, sum(o.count("fall") for o in outcomes)
        return f"{minutes:.0f} min simulated, {falls} falls, "

    for outcome in counted(runs, count, so_far):
        outcomes.append(outcome)
        write(outcomes, out)
        (out / "falls.md").write_text(report(outcomes, metres))
    return outcomes


def main() -> None:
    """Measure, and write what was found."""
    options = arguments()
    options.out.mkdir(parents=True, exist_ok=True)
    metres = length(options.minutes, options.worlds, options.speeds)
    if options.only:
        replay(options.only, metres, options.out)
        return
    cases = all_cases(options.modes, options.speeds, options.worlds, options.seed, options.base)
    out = options.out
    runs = through_processes(cases, metres, out) if options.processes else measure(cases, metres, options.jobs)
    if outcomes := noted(runs, len(cases), metres, out):
        print(report(outcomes, metres))


if __name__ == "__main__":
    main()
