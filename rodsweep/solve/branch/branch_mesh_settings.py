"""Settings for the choice of meshes on a branch, and of the cycles whose errors are measured."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchMeshSettings:
    """Settings for the choice of meshes on a branch, and of the cycles whose errors are measured."""

    max_meshes: int = 8
    """Maximum number of meshes tried for one cycle."""
    max_cheaper_cost_ratio: float = 0.5
    """A mesh that is expected to suffice is replaced by a cheaper mesh only if the ratio of the new cost to
    the current cost is at most this number."""
    planned_error_ratio: float = 0.5
    """Error for which a mesh is chosen, divided by the accuracy; below 1, so that the mesh suffices for the
    next cycles too."""
    min_parameter_rate_ratio: float = 0.7
    """Errors are interpolated at a cycle only if |d(parameter)/ds|, s: arc length, is at least this number
    times the smaller of the two values at the measured cycles. Near a fold the derivative tends to 0, and
    errors measured away from the fold are no bound."""
    max_tail_growth: float = 2.0
    """Errors are measured, not interpolated, if the coefficient tails predict that the errors have grown by
    more than this factor since each of the two measured cycles."""
    max_steps_between_measurements: int = 3
    """Maximum number of steps between two cycles with measured errors."""
    max_planned_growth: float = 4.0
    """Largest expected growth of the errors up to the next measured cycle for which a finer mesh is
    chosen."""
    max_growth_since_measurement: float = 4.0
    """Errors are measured again if the coefficient tails predict that the errors have grown by more than this
    factor since the last measurement."""


BRANCH_MESH_SETTINGS = BranchMeshSettings()
