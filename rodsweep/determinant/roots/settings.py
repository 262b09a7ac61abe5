"""Settings for the refinement of eigenvalues of a mesh to roots of D, and for Newton's method on D."""

from dataclasses import dataclass

from ...model.compiled.kernel_constants import KernelConstants


@dataclass(frozen=True, slots=True, kw_only=True)
class RootSettings(KernelConstants):
    """Settings for the refinement of eigenvalues of a mesh to roots of D."""

    max_newton_correction_over_w_scale: float = 1e-2
    """An eigenvalue of the mesh approximates a root of D if |D/D'| <= this number times the change of w over
    which an exponent of D changes by 1; otherwise, unless it belongs to a close pair, it is an artefact of
    the mesh."""
    max_pair_correction_over_w_scale: float = 0.1
    """Two close eigenvalues of the mesh approximate two roots of D if |D/D'| of each eigenvalue is at most
    this number times the change of w over which an exponent of D changes by 1."""
    max_pair_distance_in_errors: float = 4.0
    """Two eigenvalues of the mesh are moved to the roots of a quadratic Taylor polynomial of D before
    Newton's method if their distance is at most this number times the sum of their Newton corrections."""
    successive_parabolas_per_pair: int = 2
    """Number of successive quadratic Taylor polynomials of D for two close eigenvalues, each about the middle
    of the two roots of its predecessor."""
    imaginary_axis_tolerance: float = 1e-13
    """An eigenvalue is taken to be imaginary if |Re w| <= this number times |w|."""
    imaginary_axis_tolerance_in_errors: float = 4.0
    """An eigenvalue is also taken to be imaginary if |Re w| <= this number times the error of w."""
    min_double_root_correction_over_w: float = 1e-11
    """An eigenvalue w is checked for a double root if |D/D'| > this number times |w|."""
    min_ill_conditioned_relative_error: float = 1e-15
    """An eigenvalue w is ill-conditioned if its error, estimated from the typical rounding error of D,
    exceeds this number times |w|. Below this limit, `SpectrumErrorSettings.rounding_error_in_ulps` covers the
    largest rounding errors of D."""
    rounding_bound_fraction_at_root: float = 0.3
    """The rounding error of D at an ill-conditioned eigenvalue is estimated by this fraction of its bound
    `rounding_error_at_root`. With 0.22, 3 in 10000 of 46000 ill-conditioned eigenvalues of random rods near
    double eigenvalues had errors above the estimate, up to 1.13 times; close to the worst of them, and under
    another BLAS kernel, 12 in 10000. With 0.3, no error of 30000 eigenvalues close to the worst exceeds 0.9
    times the estimate."""
    min_half_root_distance_in_corrections: float = 16.0
    """The Newton correction e/|D'| is a valid error estimate if |D'|^2 >= this number times e |D''|, with the
    error e of D: the next root, at 2 |D'/D''|, is then at least 32 corrections away."""
    same_root_distance_in_errors: float = 4.0
    """Two computed roots may be the same root of D if their distance, divided by the sum of their errors, is
    at most this number."""
    same_root_fraction_of_next_distance: float = 0.25
    """Two roots that may be the same by `same_root_distance_in_errors` are the same root of D if their
    distance is below this fraction of 2 |D'/D''|, the estimated distance to the next root."""


ROOT_SETTINGS = RootSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class RootNewtonSettings(KernelConstants):
    """Settings of Newton's method for eigenvalues, crossings and double eigenvalues."""

    max_steps_to_crossing: int = 15
    """Maximum number of Newton steps to a crossing, and half the maximum number to a double eigenvalue."""
    max_steps_to_eigenvalue: int = 12
    """Maximum number of Newton steps to an eigenvalue."""
    max_step_over_expected_value: float = 20.0
    """Newton's method for a crossing fails if a step of the frequency eta or of p exceeds this number times
    the expected size of eta or p."""
    converged_step_in_rounding_errors: float = 4.0
    """Newton's method has converged if |step| <= this number times the rounding error of the zero."""
    relative_jacobian_difference_step: float = 1e-5
    """Steps of the differences in the Jacobian of a double eigenvalue, divided by |x| for x and by the
    expected distance for p. The Jacobian need not be accurate."""
    min_stagnant_step_ratio: float = 0.5
    """A Newton step of at least this number times the previous step is rounding error: the method has
    converged as far as rounding allows."""
    max_stagnant_step_over_p: float = 1e-9
    """Newton's method for a crossing has also converged if |step| is below this number times |p| and above
    `min_stagnant_step_ratio` times the previous |step|."""
    real_axis_tolerance: float = 1e-14
    """An eigenvalue w is set to Re w if |Im w| <= this number times |w|, the size of rounding errors."""


ROOT_NEWTON_SETTINGS = RootNewtonSettings()
