"""Peers of the study thresholds: grids and root finding with SciPy, and continuation codes."""

from pathlib import Path

from rodsweep.bench.peers import PeerContribution
from rodsweep.bench.thresholds.study import HOPF, ONSET

from ..auto import AUTO
from .continuation import BEYOND_HOPF, PYCONT, continuation_codes
from .spectra_by_force import BRACKETING_STEP, MESH_ACCURACY, contenders

SEARCHES = (
    "The peers search for the first change in 0 < F < 60 (140 for the narrow window of flutter, 74.83 to "
    f"75.98), prove nothing, and use a mesh with an error of {MESH_ACCURACY:.0e}. Grids and steps: dense "
    f"LAPACK (LU and geev) on rodsweep's pencil at every force; steps are {BRACKETING_STEP:g} in F until a "
    "sign "
    "changes. Continuation codes follow u = 0 of du/dt = M(F) u, the same pencil without the unknowns "
    "without time derivative."
)
"""Description of the peers' searches for the report."""
CODE_NOTES = {
    AUTO: f"{AUTO} starts at F = 0; the times include the start of the program, not the compilation.",
    PYCONT: (
        f"{PYCONT} multiplies by M only. It starts where a pair already leads, and ends {BEYOND_HOPF:g} "
        "beyond the Hopf point. If started from F = 0, through the onset, its result is right by chance, "
        "wrong by percents, or missing. The first vectors are random, and the results vary."
    ),
}
"""Remarks on the continuation codes for the report, by code."""


def peers(quick: bool, folder: Path) -> PeerContribution:
    """Grids and root finding for the onset; for the Hopf point also continuation codes.

    quick: fewer settings. folder: directory in which AUTO-07p is compiled.
    """
    codes, skipped = continuation_codes(folder, quick)
    names = dict.fromkeys(code.method for code in codes)
    return PeerContribution(
        contenders_by_race={ONSET: contenders(ONSET, quick), HOPF: contenders(HOPF, quick) + codes},
        contender_notes=(SEARCHES, *(CODE_NOTES[name] for name in names)),
        skipped_peer_sentences=tuple(skipped),
    )
