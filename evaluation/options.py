"""Options that several benchmarks have."""

from argparse import ArgumentTypeError
from collections.abc import Callable, Sequence


def some_of(known: Sequence[str]) -> Callable[[str], tuple[str, ...]]:
    """What reads names with commas between. It raises ArgumentTypeError for one that is not known."""

    def read(text: str) -> tuple[str, ...]:
        names = tuple(text.split(","))
        if unknown := set(names) - set(known):
            raise ArgumentTypeError(f"{', '.join(unknown)}: expected some of {','.join(known)}")
        return names

    return read
