"""Peers of the study spectrum: dense LAPACK, ARPACK, displacement elements, Chebyshev collocation."""

from pathlib import Path

from rodsweep.bench.peers import PeerContribution
from rodsweep.bench.spectrum.arm_spectra import ARM_SPECTRUM_RACE_NAME
from rodsweep.bench.spectrum.study import SPECTRUM_RACE_NAME

from .eigensolvers import arm_contenders, contenders


def peers(quick: bool, folder: Path) -> PeerContribution:
    """All eigensolvers at all sizes. A quick study skips sizes itself; nothing is compiled in `folder`."""
    return PeerContribution({SPECTRUM_RACE_NAME: contenders(), ARM_SPECTRUM_RACE_NAME: arm_contenders()})
