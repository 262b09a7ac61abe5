"""Settings for spectra of arms along a path: followed modes, families of interpolated arms, hulls."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmStretchSettings:
    """Settings for arms along a path: number of followed modes, families of interpolated arms, hulls of their
    spectra.
    """

    further_modes: tuple[int, ...] = (3, 9)
    """Numbers of modes followed beyond the wanted modes. The second is tried if the first proves too few
    points."""
    min_proved_fraction: float = 0.5
    """Fraction of points proved complete below which more modes are followed, provided that more modes prove
    a further point."""
    further_modes_of_rest: tuple[int, ...] = (9, 20)
    """Numbers of modes followed, one after the other, at the points of a stretch that the first pass did not
    prove."""
    min_points_of_rest: int = 64
    """Minimum number of such points: following so many with a family of their own costs as much as their
    counts."""
    parts_of_rest: int = 16
    """Number of equal parts of the unproved points, up to one of which those that more modes prove are
    found."""
    hull_arms_of_rest: int = 49
    """`hull_arms` for the counts at unproved points, if they are at least `min_points_of_rest`."""
    headroom: float = 2.0
    """Bound W of the |w| at which the propagators of a new family hold, in units of the largest |w| at the
    first point."""
    reused_headroom: float = 1.25
    """`headroom` that the family of the previous interval must still have to be used again."""
    max_points_growth: int = 2
    """Maximum number of points of a new family, in units of the points that the previous family reached."""
    min_points: int = 4
    """Minimum number of points for which a family of arms is made."""
    accuracy: float = 1e-8
    """Relative accuracy of the eigenvalues of `FollowedArms`."""
    modes_beyond_growing: int = 2
    """Number of modes that a search for crossings requests beyond the growing modes."""
    steps_from_nearest: tuple[int, ...] = (1, 4)
    """Numbers of equal steps tried, one after the other, to follow eigenvalues from the nearest point of the
    path to a p between points."""
    hull_arms: int = 13
    """Number of arms of an interval at which hulls are computed; hulls of the arms between are
    interpolated."""


ARM_STRETCH = ArmStretchSettings()
