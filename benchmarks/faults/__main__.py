"""Break something while the robot drives, again and again: python -m benchmarks.faults [--trials N] [--seed S]."""

import argparse
import logging
import random
from contextlib import suppress
from pathlib import Path

from benchmarks.faults.faults import known_faults
from benchmarks.faults.report import table
from benchmarks.faults.rig import running_rig
from benchmarks.faults.trial import Outcome, run_trial
from cliffscan.common.runtime.stop_signal import StopSignal
from evaluation.processes.driven import Interrupted
from evaluation.processes.service_log import ServiceLog

OUT = Path("out/faults.md")


def arguments() -> argparse.Namespace:
    """The options."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.faults", description=__doc__)
    parser.add_argument("--trials", type=int, default=48, help="how many in all, every fault as often as another (48)")
    parser.add_argument("--seed", type=int, default=1, help="of the order and the times (1)")
    parser.add_argument("--only", nargs="+", metavar="FAULT", help=f"these only, of {', '.join(known_faults())}")
    parser.add_argument("--out", type=Path, default=OUT, help=f"file of the table ({OUT})")
    return parser.parse_args()


def trials(count: int, names: list[str], rng: random.Random, stop: StopSignal) -> list[Outcome]:
    """Run so many trials, in rounds of all faults in random order; what is done when told to stop is the result."""
    faults, outcomes, order = known_faults(), list[Outcome](), list[str]()
    with suppress(Interrupted), running_rig(stop, rng) as rig:
        while len(outcomes) < count:
            order = order or rng.sample(names, len(names))
            name = order.pop()
            outcomes.append(run_trial(rig, name, faults[name], rng))
            told = outcomes[-1]
            end = "fell" if told.fell else f"on after {told.on:.1f} s"
            rest = f"at rest after {told.rest:.2f} s and {told.way:.2f} m, {told.left:.2f} m before the edge"
            text = f"{name} at {told.speed:.2f} m/s, {rest}, {end}"
            print(f"{len(outcomes)} of {count}: {text}", flush=True)
    return outcomes


def main() -> None:
    """Run the trials and tell what came of them."""
    asked = arguments()
    names = asked.only or list(known_faults())
    if unknown := set(names) - set(known_faults()):
        raise SystemExit(f"no such fault: {', '.join(unknown)}")
    logging.basicConfig(level=logging.ERROR)
    asked.out.parent.mkdir(parents=True, exist_ok=True)
    log = asked.out.with_suffix(".log")
    log.write_text("")
    with ServiceLog(log):
        outcomes = trials(asked.trials, names, random.Random(asked.seed), StopSignal())
    if not outcomes:
        raise SystemExit("ended before the first trial was")
    found = table(outcomes).markdown()
    asked.out.write_text(f"{found}\n", encoding="utf-8")
    print(found)


if __name__ == "__main__":
    main()
