"""Peers of the study spectrum: dense LAPACK, ARPACK, displacement elements, Chebyshev collocation."""

from pathlib import Path

from rodsweep.bench.peers import PeerContribution
from rodsweep.bench.spectrum.arm_spectra import ARM_SPECTRUM_RACE
from rodsweep.bench.spectrum.study import SPECTRUM_RACE

from .eigensolvers import arm_contenders, contenders


def peers(quick: bool, folder: Path) -> PeerContribution:
    """All eigensolvers at all sizes. A quick study skips sizes itself; nothing is compiled in `folder`."""
    return PeerContribution({SPECTRUM_RACE: contenders(), ARM_SPECTRUM_RACE: arm_contenders()})
