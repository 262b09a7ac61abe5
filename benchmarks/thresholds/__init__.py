"""Peers of the thresholds: grids and root finding with SciPy, and continuation codes."""

from pathlib import Path

from rodsweep.bench.peers import Peers
from rodsweep.bench.thresholds.cases import HOPF, ONSET

from ..auto import AUTO
from .continuation import BEYOND_HOPF, PYCONT, continuation_codes
from .spectra_by_force import MARCH, MESH_ACCURACY, contenders

SEARCHES = (
    "The others search for the first one in 0 < F < 60 (140 for the narrow window of flutter, 74.83 to "
    f"75.98), prove nothing, and are given a mesh that leaves an error of {MESH_ACCURACY:.0e} there. Grids "
    "and steps: dense LAPACK (LU and geev) on rodsweep's pencil at every force; steps are of "
    f"{MARCH:g} in F until a sign changes. Continuation codes follow u = 0 of du/dt = M(F) u, the same "
    "pencil without the unknowns that carry no time derivative."
)
CODES = {
    AUTO: f"{AUTO} starts at F = 0; its times include the start of its program, not its compilation.",
    PYCONT: (
        f"{PYCONT} multiplies by M only. It is started where a pair leads already, and ended {BEYOND_HOPF:g} "
        "beyond the Hopf point: from F = 0, through the onset, it is by chance right, off by percents or "
        "without a result. Its first vectors are random, so that its numbers vary."
    ),
}


def peers(quick: bool, place: Path) -> Peers:
    """For the onset grids and searches, for the Hopf point continuation codes too."""
    codes, skipped = continuation_codes(place, quick)
    names = dict.fromkeys(code.method for code in codes)
    return Peers(
        contenders={ONSET: contenders(ONSET, quick), HOPF: contenders(HOPF, quick) + codes},
        notes=(SEARCHES, *(CODES[name] for name in names)),
        skipped=tuple(skipped),
    )
