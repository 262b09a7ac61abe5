"""`python -m rodsweep` is the command `rodsweep`."""

from .cli import main

main()
