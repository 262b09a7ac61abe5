"""Peers of the study limit_cycle: time integrators, and AUTO-07p, which continues the cycle in F."""

from functools import partial
from pathlib import Path

from rodsweep.bench.limit_cycle.study import CYCLE_FOLLOWING_RACE_NAME, SETTLING_TO_CYCLE_RACE_NAME
from rodsweep.bench.peers import PeerContribution

from ..auto import AUTO_SKIPPED, auto_program
from .auto_equations import EQUATIONS
from .continuation import compare_with_auto
from .integrators import CVODE, CVODE_SKIPPED, installed_families


def peers(quick: bool, folder: Path) -> PeerContribution:
    """All installed integrators, and AUTO-07p, compiled in `folder`. quick: fewer settings of AUTO-07p."""
    every, program = installed_families(), auto_program(folder, EQUATIONS)
    skipped = [] if CVODE in [family.name for family in every] else [CVODE_SKIPPED]
    return PeerContribution(
        contenders_by_race={
            CYCLE_FOLLOWING_RACE_NAME: [
                contender for family in every for contender in family.following_contenders()
            ],
            SETTLING_TO_CYCLE_RACE_NAME: [
                contender for family in every for contender in family.settling_contenders()
            ],
        },
        section_functions=(partial(compare_with_auto, program, quick),) if program else (),
        skipped_peer_sentences=skipped if program else [*skipped, AUTO_SKIPPED],
    )
