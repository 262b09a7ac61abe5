"""A reference rod with a known cycle, solved to warm up the solver and to check the PETSc options."""

from dataclasses import replace

from ...errors import EnvironmentIncomplete
from ...model.rod import Rod
from ..backend.petsc import user_options_text
from ..motion.time_scheme import CYCLE_OPTIONS_PREFIX
from .cycle_outcome import CycleRequest
from .limit_cycle import solve_cycle
from .status import CycleStatus

REFERENCE_ROD_PERIOD = 0.04204870
"""Period, in tau2, of the cycle of the reference rod with F, k1, k2, gamma3, gamma1 = 40, 1e4, 1e2, 1e-2, 1.
An independent displacement-form code confirms all digits."""
REFERENCE_REQUEST = CycleRequest(1e-3, 0.1, 1, 4, 1, 4, 50)
"""Request for the cycle of the reference rod: a low accuracy, with time series and one shape."""


def warm_up() -> None:
    """Loads compiled code and fills caches by solving the reference rod, so that the first point takes no
    extra time.

    Raises EnvironmentIncomplete if PETSc options with the prefix cycle_ are set and the cycle is wrong.
    """
    rod = Rod(F=40.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0)
    request = REFERENCE_REQUEST
    cycle = solve_cycle(rod, request, None, "F")
    # The second solve loads the code for the continuation along a chain.
    if cycle.start_for_next_rod is not None:
        solve_cycle(replace(rod, F=1.01 * rod.F), request, cycle.start_for_next_rod, "F")
    deviation = abs(cycle.measures.period / REFERENCE_ROD_PERIOD - 1)
    is_reproduced = cycle.status == CycleStatus.cycle and deviation < request.accuracy
    options = user_options_text(CYCLE_OPTIONS_PREFIX)
    if options and not is_reproduced:
        outcome = f"{cycle.status.name} {cycle.message}".strip()
        raise EnvironmentIncomplete(
            f"with the PETSc options '{options}' the known cycle of the reference rod is not found: "
            f"'{outcome}'; the task limit_cycle cannot run; remove these options"
        )
