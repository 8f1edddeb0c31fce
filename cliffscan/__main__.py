"""The command `cliffscan`, also as `python -m cliffscan`."""

import sys


def main() -> None:
    """Run one command; leaves with its exit code."""
    if sys.argv[1:2] == ["run"]:  # before the other commands' imports, which take a second
        from cliffscan.run import main as command
    else:
        from cliffscan.cli import main as command
    command()


if __name__ == "__main__":
    main()
