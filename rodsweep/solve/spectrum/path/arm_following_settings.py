"""Settings for spectra of arms along a path: followed modes, families of interpolated arms, hulls."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmFollowingSettings:
    """Settings for arms along a path: number of followed modes, families of interpolated arms, hulls."""

    further_mode_counts: tuple[int, ...] = (3, 9)
    """Numbers of modes followed in addition to the wanted modes. The second number is tried if, with the
    first number, fewer than `min_proved_fraction_without_more_modes` of the points are proved or too few
    growing modes."""
    min_proved_fraction_without_more_modes: float = 0.5
    """More modes are followed if the modes are proved complete at less than this fraction of the points, no
    counts follow, and more modes would prove a further point."""
    min_unproved_points: int = 64
    """Minimum number of points without a proof for which hulls are computed at more arms."""
    hulls_per_unproved_interval: int = 49
    """Number of hulls computed in an interval, instead of `hulls_per_interval`, if at least
    `min_unproved_points` points have no proof."""
    w_bound_ratio: float = 2.0
    """The propagators of a new family are valid at least up to W = `w_bound_ratio` * (largest |w| at the
    first point)."""
    min_reused_W_over_max_w: float = 1.25
    """The family of the previous interval is used again if its W is at least this multiple of the largest |w|
    at the first point of the new interval."""
    max_points_over_previous_family: int = 2
    """Maximum number of points of a new family, divided by the number reached with the previous family."""
    min_points: int = 4
    """Minimum number of points for which a family of arms is made."""
    accuracy: float = 1e-8
    """Relative accuracy of the eigenvalues of `FollowedArms`."""
    modes_beyond_growing: int = 2
    """Number of modes that a search for crossings requests in addition to the growing modes."""
    step_counts_from_nearest_point: tuple[int, ...] = (1, 4)
    """Eigenvalues at a path variable p are followed from the nearest solved point in this number of equal
    steps; the numbers are tried in turn."""
    hulls_per_interval: int = 13
    """Number of hulls computed in an interval of the path, at equally spaced arms; the hulls of all other
    arms are interpolated."""


ARM_FOLLOWING_SETTINGS = ArmFollowingSettings()
