"""Peers of the spectrum: dense LAPACK, ARPACK, displacement elements, Chebyshev collocation."""

from pathlib import Path

from rodsweep.bench.peers import Peers
from rodsweep.bench.spectrum.arms import ARM_RACE
from rodsweep.bench.spectrum.study import RACE

from .eigensolvers import arm_contenders, contenders


def peers(quick: bool, place: Path) -> Peers:
    """All of them, quick or not: who is quick takes fewer of their sizes; nothing is compiled in `place`."""
    return Peers({RACE: contenders(), ARM_RACE: arm_contenders()})
