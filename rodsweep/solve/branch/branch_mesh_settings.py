"""Settings for the choice of meshes on a branch, and of the cycles whose errors are measured."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchMeshSettings:
    """Settings for the choice of meshes on a branch, and of the cycles whose errors are measured."""

    max_meshes: int = 8
    """Maximum number of meshes tried for one cycle."""
    max_cheaper_cost_ratio: float = 0.7
    """A mesh that is expected to suffice is replaced by a cheaper mesh only if the ratio of the new cost to
    the current cost is at most this number."""
    planned_error_ratio: float = 0.5
    """Error for which a mesh is chosen, divided by the accuracy; below 1, so that the mesh suffices for the
    next cycles too."""
    planned_error_ratio_of_cheaper_mesh: float = 0.25
    """The same number for a cheaper mesh that replaces a sufficient one: a mesh that turns out not to suffice
    costs several solutions."""
    min_rate_ratio_for_interpolation: float = 0.2
    """Errors are interpolated at a cycle only if |d(parameter)/ds|, s: arc length, is at least this number
    times the smaller of the two values at the measured cycles. Near a fold the derivative tends to 0, and
    errors measured far from the fold are no bound."""
    max_uncorrected_tail_growth: float = 2.0
    """Interpolated errors are multiplied by the growth that the coefficient tails predict, if it exceeds this
    factor since each of the two measured cycles; beyond `max_growth_since_measurement` they are measured."""
    max_steps_between_measurements: int = 3
    """Maximum number of steps between two cycles with measured errors."""
    max_steps_with_small_errors: int = 4
    """The same number if the last measured errors are so small that they stay within the accuracy when they
    grow by `max_growth_since_measurement`. With 6 or 8 steps errors that change their sign between two
    measured cycles exceeded their estimates, by up to 4 times."""
    max_planned_growth: float = 4.0
    """Largest expected growth of the errors up to the next measured cycle for which a finer mesh is
    chosen."""
    max_growth_since_measurement: float = 4.0
    """Errors are measured again if the coefficient tails predict that the errors have grown by more than this
    factor since the last measurement."""


BRANCH_MESH_SETTINGS = BranchMeshSettings()
