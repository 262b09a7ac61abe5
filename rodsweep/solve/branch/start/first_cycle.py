"""The first cycle of a branch, from the normal form of the Hopf point where the branch starts.

The normal form relates the amplitude of a cycle to the distance of the parameter from the Hopf point.
Newton's method starts at the cycle predicted for a small amplitude. The deflection is prescribed and the
parameter is unknown; this system is regular at the Hopf point too.
"""

from collections.abc import Sequence

import numpy as np

from ....discretization.stress.form import StressForm
from ...cycle.accuracy.newton_tolerances import allowed_distance_from_matrix_orbit
from ...cycle.accuracy.settings import REFINEMENT_SETTINGS
from ...cycle.hopf_start import orbit_of_amplitude
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.mesh_choice import cheapest_stage_count, mesh_from_coefficient_tails
from ...orbit.orbit import Orbit
from ...unsolvable import Unsolvable
from ..arc_length_step import BranchCycle
from ..bordered.border_condition import BorderCondition
from ..bordered.scale import ArcLengthScale, deflection_at_time_zero
from ..branch_errors import branch_newton_tolerance
from ..branch_mesh_choice import first_cycle_with_measured_errors
from ..settings import BRANCH_START_SETTINGS
from .hopf_point import HopfBranchStart
from .neighbouring_hopf_points import max_first_amplitude

DEFLECTION_UNIT_VECTOR = np.array([1.0, 0.0, 0.0])
"""Unit vector along the deflection, (3,), in components (deflection, log period, parameter)."""


def first_cycle(
    hopf: HopfBranchStart,
    accuracy: float,
    workspace: NewtonWorkspace,
    all_hopfs: Sequence[HopfBranchStart] = (),
) -> BranchCycle:
    """The first cycle of the branch from the Hopf point `hopf`, to a relative accuracy; raises Unsolvable.

    workspace: memory of Newton's matrices. all_hopfs: Hopf points at which the branch may end.
    """
    first = _cycle_near_hopf_point(hopf, max_first_amplitude(hopf, all_hopfs), accuracy, workspace)
    amplitude = first.cycle.measures.tip_y_max
    # The parameter moves against the normal form: the branch has a fold before this cycle.
    while (
        # With direction 0, where the sign of Re c is unknown, no fold can be inferred.
        first.parameter_per_arc_length * hopf.parameter_direction < 0
        and amplitude > BRANCH_START_SETTINGS.min_amplitude_before_fold
    ):
        amplitude /= 2
        try:
            first = _cycle_near_hopf_point(hopf, amplitude, accuracy, workspace)
        # The cycle beyond the fold is still a cycle of this branch.
        except Unsolvable:
            break
    return first


def _cycle_near_hopf_point(
    hopf: HopfBranchStart, max_amplitude: float, accuracy: float, workspace: NewtonWorkspace
) -> BranchCycle:
    """A first cycle for the branch from the Hopf point `hopf`, solved to a relative accuracy; raises
    Unsolvable. max_amplitude: upper limit of the largest tip y of the predicted cycle, in L."""
    a = abs(hopf.amplitude_coefficient)
    first_mesh_accuracy = max(accuracy, REFINEMENT_SETTINGS.min_first_mesh_accuracy)
    # On a coarse mesh the Hopf point is displaced, so that this mesh may have no cycle here.
    for mesh_accuracy, is_finer_start in (
        (first_mesh_accuracy, False),
        (REFINEMENT_SETTINGS.min_first_mesh_accuracy, True),
    ):
        for fraction in BRANCH_START_SETTINGS.first_amplitudes:
            amplitude = min(
                fraction, BRANCH_START_SETTINGS.max_amplitude_per_amplitude_coefficient * a, max_amplitude
            )
            try:
                return _cycle_of_amplitude(
                    hopf, amplitude, mesh_accuracy, is_finer_start, accuracy, workspace
                )
            except Unsolvable as error:
                reason = error
    raise Unsolvable(f"no cycle is solved near the Hopf point: {reason}") from reason


def _cycle_of_amplitude(
    hopf: HopfBranchStart,
    amplitude: float,
    mesh_accuracy: float,
    is_finer_start: bool,
    accuracy: float,
    workspace: NewtonWorkspace,
) -> BranchCycle:
    """The cycle near the cycle that the normal form of `hopf` predicts for the largest tip y `amplitude`, in
    L, solved to the relative `accuracy`; raises Unsolvable.

    The cycle is solved first on the starting mesh, then on a mesh chosen for the accuracy `mesh_accuracy`.
    is_finer_start: whether the starting mesh is chosen for `mesh_accuracy` too; otherwise the starting mesh
    is the coarser mesh of the normal form.
    """
    start = cycle_of_normal_form(hopf, amplitude)
    if is_finer_start:
        start = mesh_from_coefficient_tails(
            start, mesh_accuracy, cheapest_stage_count(mesh_accuracy)
        ).interpolated_orbit(start)
    min_deflection_unit = (
        abs(deflection_at_time_zero(start))
        * BRANCH_START_SETTINGS.amplitude_of_min_deflection_unit
        / amplitude
    )
    scale = ArcLengthScale.at_orbit(start, hopf.parameter_name, min_deflection_unit, hopf.min_coordinate_unit)
    # With the deflection prescribed, not the parameter, the cycle cannot collapse onto the straight rod.
    border = np.sign(deflection_at_time_zero(start)) * DEFLECTION_UNIT_VECTOR
    condition = BorderCondition.at_arc_length(scale, border, start)
    rough_orbit = condition.solve_cycle(start, REFINEMENT_SETTINGS.nearby_orbit_newton_tolerance, workspace)
    near_orbit = rough_orbit.orbit
    # The phase condition puts the largest y of the tip at t = 0.
    tip_y = float(near_orbit.form.tip_coordinates(near_orbit.start_state)[1])
    # A different cycle with the same deflection would have an amplitude far from the normal form's.
    least_ratio, largest_ratio = BRANCH_START_SETTINGS.allowed_amplitude_to_prediction_ratios
    if not least_ratio < tip_y / amplitude < largest_ratio:
        raise Unsolvable("Newton's method converged far from the cycle that the normal form predicts")
    mesh = mesh_from_coefficient_tails(near_orbit, mesh_accuracy, cheapest_stage_count(accuracy))
    first = condition.solve_on_mesh(
        mesh, rough_orbit, branch_newton_tolerance(accuracy), allowed_distance_from_matrix_orbit(accuracy)
    )
    arc_from_start = abs(deflection_at_time_zero(first.orbit)) / scale.deflection_unit
    return first_cycle_with_measured_errors(first, scale, border, arc_from_start, accuracy)


def cycle_of_normal_form(hopf: HopfBranchStart, amplitude: float) -> Orbit:
    """The cycle that the normal form predicts for the largest tip y `amplitude`, in L, on the normal form's
    mesh in space and a coarse mesh in time; raises Unsolvable."""
    change, frequency = hopf.parameter_change_and_frequency(amplitude)
    form = StressForm(hopf.rod, hopf.normal_form.mixed_form.mesh, hopf.is_omega_always_unknown)
    try:
        form = form.with_coordinate(hopf.parameter_name, hopf.parameter_coordinate + change)
    except (ValueError, ZeroDivisionError) as error:
        raise Unsolvable(f"the branch leaves the allowed range of the parameters: {error}") from error
    return orbit_of_amplitude(hopf.normal_form, form, amplitude, frequency)
