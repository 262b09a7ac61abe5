"""Settings for the start of a branch of cycles from the normal form of a Hopf point."""

from dataclasses import dataclass

from ...model.rod import Rod
from ..orbit.matrix.workspace import require_enough_stages


@dataclass(frozen=True, slots=True, kw_only=True)
class HopfStartSettings:
    """Settings for the search for the Hopf point below a force, and for Newton's method from this point."""

    relative_force_decrease_in_scan: float = 0.07
    """Relative decrease between successive forces at which the search evaluates the leading growth rate."""
    min_force: float = 1e-2
    """Force, in k3/L^2, at which the search for a Hopf point ends: at smaller forces no rod oscillates,
    because F nu (nu + F c2) must exceed a number of the order of pi^2; nu: stretch, c2 = 1/k2."""
    relative_hopf_eigenvalue_tolerance: float = 1e-6
    """A Hopf point is accepted if |Re w| and |Im w - frequency| <= relative_hopf_eigenvalue_tolerance |w|; w:
    leading eigenvalue at this point. Bisection ends at this relative width of the interval of the force."""
    max_newton_steps: int = 15
    """Maximum number of Newton steps to a Hopf point."""
    converged_growth_in_errors: float = 4.0
    """Newton's method for the Hopf point has converged if |Re w| <= converged_growth_in_errors times the
    error estimate of w."""
    relative_converged_force_step: float = 1e-15
    """Newton's method for the Hopf point has also converged if |step of F| <= relative_converged_force_step
    |F|."""
    normal_form_accuracy: float = 1e-3
    """Relative accuracy of the normal form's coefficients; the truncation error of the normal form is
    larger."""
    max_axial_drag_for_refinement: float = 1e-2
    """If the smallest axial drag along the rod is below this number, the mesh of the normal form is finer in
    proportion: mesh errors of the axial force are divided by the drag in the axial velocity, and the Landau
    coefficient would have an error of 3 percent at a drag of 1e-4 and of 100 times its value at 1e-6."""
    finest_normal_form_accuracy: float = 1e-15
    """Smallest relative accuracy for which the mesh of the normal form is chosen: rounding error."""
    start_force_distances: tuple[float, ...] = (0.3, 0.12, 0.03, 0.006, 1e-3, 2e-4)
    """Relative distances of the force above the Hopf point at which Newton's method starts from the normal
    form's orbit, tried in this order until Newton's method succeeds. For most rods the amplitude of the
    normal form has an error of 25 percent at the first distance, of 10 percent at the second. The last two
    are for rods of small axial drag, whose cycles may grow ten times as fast."""
    start_amplitudes: tuple[float, ...] = (0.3, 0.15, 0.08, 0.04)
    """Largest y, in L, of the normal form's orbits from which the branch is followed in stages, tried in this
    order if Newton's method fails from all `start_force_distances`. Rods of small axial drag have y = 0.6 at
    a relative distance of 1e-3 above the Hopf point; 14 of 16 such rods reach their cycle from one of these
    orbits. The other two have y > 1 already at 3e-4 by the normal form, which then fails everywhere."""
    force_distance_ratio_of_stage: float = 3.0
    """The branch from the Hopf point is followed to the requested force in stages: relative distance of the
    force from the Hopf point at the end of a stage, divided by its value at the start of the stage."""
    allowed_squared_amplitude_ratios: tuple[float, float] = 0.3, 3.0
    """Smallest and largest allowed ratio of the squared largest y of the solved orbit to the squared largest
    y of the normal form."""
    max_direct_start_force_distance: float = 1e-2
    """Up to this relative distance of the force above the Hopf point, Newton's method starts from the normal
    form's orbit at the given force itself, with an error of its amplitude of 1 percent for most rods."""
    max_direct_start_tip_y: float = 0.7
    """Newton's method does not start at the given force if the largest y of the normal form's orbit there, in
    L, exceeds this number: the true cycle of a rod of small axial drag then has less than half this y."""
    coarse_time_interval_count: int = 8
    """Number of time intervals, over half a period, of the coarse mesh of the intermediate orbits on the
    branch from the Hopf point to the cycle."""
    coarse_stage_count: int = 3
    """Number of collocation stages per time interval of the coarse mesh of the intermediate orbits."""
    intermediate_orbit_tolerance: float = 3e-3
    """Relative tolerance of Newton's method for the intermediate orbits on the branch."""

    def __post_init__(self) -> None:
        require_enough_stages(self.coarse_stage_count)


HOPF_START_SETTINGS = HopfStartSettings()


def normal_form_accuracy(rod: Rod) -> float:
    """Relative accuracy for which the mesh of the normal form of `rod` is chosen, for the start of a
    branch."""
    settings = HOPF_START_SETTINGS
    refinement = min(1.0, rod.least_axial_drag / settings.max_axial_drag_for_refinement)
    return max(settings.normal_form_accuracy * refinement, settings.finest_normal_form_accuracy)
