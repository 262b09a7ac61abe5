"""Settings for the start of a branch of cycles at a Hopf point, and for its accuracy there."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchStartSettings:
    """Settings for the first cycle of a branch near its Hopf point."""

    first_amplitudes: tuple[float, ...] = (0.02, 0.008, 0.003)
    """Amplitudes (largest tip y, in L) of the first cycle, tried in this order."""
    max_amplitude_per_coefficient: float = 0.05
    """Upper limit of the amplitude of the first cycle, divided by
    |`HopfBranchStart.amplitude_coefficient`|. At larger amplitudes the third-order normal form is too
    inaccurate."""
    max_first_amplitude_per_half_axis: float = 0.5
    """Upper limit of the amplitude of the first cycle on a branch between two Hopf points close together,
    divided by the largest amplitude on this branch: the parameter then changes by a fifteenth of the distance
    between both points."""
    last_amplitude_per_half_axis: float = 0.2
    """Near two Hopf points close together, the last cycle of a branch is moved towards its Hopf point, down
    to this fraction of half the axis of the ellipse or hyperbola of the cycles: at this amplitude the
    parabola of one Hopf point alone misses the parameter by 4 % of the distance from the Hopf point."""
    min_amplitude_of_deflection_unit: float = 0.1
    """The unit of deflection of an `ArcLengthScale` is at least the deflection that a cycle of this amplitude
    (largest tip y, in L) has by linear theory."""
    allowed_amplitude_ratios: tuple[float, float] = 0.5, 2.0
    """Smallest and largest allowed ratio of the solved amplitude of the first cycle to the amplitude
    predicted by the normal form."""
    min_amplitude_before_fold: float = 5e-4
    """If the branch has a fold between its Hopf point and its first cycle, the first cycle is moved towards
    the Hopf point, down to this amplitude (largest tip y, in L); likewise the last cycle of a branch that
    ends at a Hopf point."""
    max_harmless_amplitude_coefficient: float = 3.0
    """Largest amplitude coefficient |a| of a Hopf point, in L, that does not affect the accuracy of the
    cycles. A larger |a| means that a generalised Hopf point is close; a coarse mesh then displaces folds, or
    has folds that the rod does not have."""
    max_accuracy_if_degenerate: float = 5e-7
    """Largest relative accuracy of the cycles of a rod with a Hopf point of |a| =
    `max_harmless_amplitude_coefficient`. For larger |a| the largest accuracy is proportional to 1/a^2, like
    the distance of the fold from the Hopf point."""
    min_accuracy_if_degenerate: float = 1e-8
    """Lower limit of the accuracy that is required because of a large |a|. With this limit, for ten rods at
    distances of 1e-7 to 1e-3 from a generalised Hopf point, no false fold was found, and all folds farther
    than 1e-11 F from the Hopf point were found."""
    coefficient_accuracies: tuple[float, ...] = (1e-8, 1e-3)
    """Relative accuracies of the Landau coefficient of a Hopf point, tried in this order. The first one costs
    as much as the second (1.9 s for 88 Hopf points of random rods); a mesh that misses the eigenvalue at the
    first may identify it at the second."""
    frequency_rounding: float = 1e-14
    """Relative rounding error of the frequency at a Hopf point, which is computed as a root of the
    determinant D."""


BRANCH_START_SETTINGS = BranchStartSettings()
