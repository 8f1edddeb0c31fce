"""`python -m cliffscan` is the command `cliffscan`."""

from cliffscan.cli import main

main()
