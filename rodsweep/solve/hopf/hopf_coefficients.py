"""Normal form coefficients of a Hopf point, with error estimates from two meshes and from the determinant D.

The Landau coefficient c is computed on successively finer meshes, at least two. The value of the last mesh is
stored. The error estimate, some decades larger than the error, is the difference from the value of a mesh
with the same elements of a lower order. The effects of rounding and of the error of the Hopf point are added.
The slope dw/dF is the slope of the root of D, free of mesh error; its difference from the slope on the last
mesh is the error estimate. For arms, the slope on the last mesh is stored, with its error estimated from the
same two meshes as that of c.
"""

import math
from dataclasses import dataclass, replace

from ...determinant.parameter_path import ParameterPath
from ...discretization.elements.elements import Elements
from ...model.rod import Rod
from ..changes.arm.path import path_problem
from ..changes.threshold_kinds import Threshold
from .normal_form import (
    NORMAL_FORM_SETTINGS,
    NormalForm,
    elements_for_landau_coefficient,
    elements_with_third_more_unknowns,
    normal_form_on,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class HopfCoefficientSettings:
    """Settings for the coefficients of a Hopf point and their errors, and for the cache of searches."""

    order_increase: int = 4
    """Increase of the element order from the first mesh to the second, by which the error of the Landau
    coefficient falls by a factor of 10 to 10^4."""
    max_finer_meshes: int = 5
    """Maximum number of meshes after the first. A change of the Landau coefficient between meshes of
    different element lengths is not used as error estimate."""
    coarsest_accuracy: float = 1e-2
    """Coarsest relative accuracy for which the first mesh is chosen: the mesh must identify the
    eigenvalue."""
    landau_rounding_per_condition_number: float = 1.5e-14
    """Relative rounding error of the Landau coefficient, divided by the condition number of the eigenvalue.
    Most rods have 1e-15; the largest measured value is 9e-15, for nearly crushed rods that are soft in
    stretch and shear."""
    max_landau_force_sensitivity: float = 20.0
    """Bound on |dc/dF|/|c|, c: Landau coefficient, divided by |w''|/|w'| + 1/|F| + 1/|Fc - F|; w: eigenvalue,
    primes: d/dF, Fc: crushing force. The largest measured value is 10, for high modes of rods soft in shear;
    where a flutter window closes the value is 1."""
    relative_force_step: float = 1e-5
    """Force step of the difference quotient for the second derivative of w(F), divided by |F|."""
    max_cached_searches: int = 8
    """Number of searches for Hopf points in the cache; rods that differ only in gamma1 share a search."""


HOPF_COEFFICIENT_SETTINGS = HopfCoefficientSettings()


@dataclass(frozen=True, slots=True, kw_only=True)
class HopfCoefficients:
    """The normal form of one Hopf point, dZ/dt = growth_slope (F - F_H) Z + landau |Z|^2 Z, tip y = Re Z.

    growth_slope in L^2/(k3 tau2), landau in 1/(tau2 L^2). amplitude_coefficient a in L, frequency_slope b in
    L^2/(k3 tau2): defined in `NormalForm`. elements, order: number and order of the elements of the last
    mesh. If the computation failed, all coefficients and errors are NaN, and `message` states the cause.
    """

    growth_slope: complex = complex(math.nan, math.nan)
    growth_slope_error: float = math.nan
    """Estimated error of `growth_slope`, divided by |growth_slope|."""
    landau: complex = complex(math.nan, math.nan)
    landau_error: float = math.nan
    """Estimated error of `landau`, divided by |landau|."""
    amplitude_coefficient: float = math.nan
    amplitude_coefficient_error: float = math.nan
    """Estimated relative error of `amplitude_coefficient`."""
    frequency_slope: float = math.nan
    frequency_slope_error: float = math.nan
    """Estimated relative error of `frequency_slope`."""
    elements: int = 0
    order: int = 0
    message: str = ""

    @property
    def are_known(self) -> bool:
        """Whether the coefficients were computed; otherwise they are NaN."""
        return not math.isnan(self.landau_error)

    @property
    def criticality(self) -> float:
        """Sign of Re c, c: Landau coefficient: -1 (supercritical) or 1 (subcritical); 0 if |Re c| is not
        larger than the error of c; nan if the coefficients are not known."""
        if not self.are_known:
            return math.nan
        if abs(self.landau.real) <= self.landau_error * abs(self.landau):
            return 0.0
        return math.copysign(1.0, self.landau.real)


def hopf_coefficients(rod: Rod, hopf: Threshold, accuracy: float) -> HopfCoefficients:
    """The normal form coefficients at the Hopf point `hopf`, with the Landau coefficient to the relative
    `accuracy`; raises Unsolvable. rod: the rod at the force of `hopf`. The Landau coefficient is less
    accurate if its rounding error exceeds `accuracy`, or if the finest mesh does not suffice."""
    settings = HOPF_COEFFICIENT_SETTINGS
    w = complex(0.0, hopf.frequency)
    fine_form, landau_change, slope_change = _form_and_changes(rod, w, accuracy)
    rounding_error = _rounding_error(fine_form)
    # The slope of the root of D has no error of a mesh.
    slope, second_derivative = _eigenvalue_slope_and_curvature(rod, w)
    if rod.is_uniform_and_linear:
        slope_difference = abs(fine_form.eigenvalue_slope - slope) / abs(slope)
    else:  # for an arm the root's slope is a difference quotient, less accurate than the slope on the mesh
        slope = fine_form.eigenvalue_slope
        slope_difference = slope_change
    # c was computed at the force of `hopf`: an error of this force changes c.
    sensitivity_unit = second_derivative / abs(slope) + 1 / abs(rod.F) + 1 / abs(rod.crushing_force - rod.F)
    force_effect = settings.max_landau_force_sensitivity * hopf.error * sensitivity_unit
    landau_error = max(landau_change, rounding_error) + force_effect
    slope_error = max(slope_difference, rounding_error) + hopf.error * second_derivative / abs(slope)
    return _coefficients_with_errors(
        replace(fine_form, eigenvalue_slope=slope), landau_error, slope_error, hopf.error / abs(rod.F)
    )


def _form_and_changes(rod: Rod, w: complex, accuracy: float) -> tuple[NormalForm, float, float]:
    """Returns (normal form of the eigenvalue w on the last mesh, relative change of the Landau coefficient c,
    relative change of dw/dF). Both changes are between the last two successive meshes with equal elements and
    different orders; inf without such meshes. The refinement ends when the change of c is at most `accuracy`,
    or at most the rounding error of c."""
    settings = HOPF_COEFFICIENT_SETTINGS
    # The worst-case factor of the mesh rule is not needed: here the second mesh measures the actual error.
    first_elements = elements_for_landau_coefficient(
        rod,
        w,
        min(accuracy / NORMAL_FORM_SETTINGS.mesh_accuracy_ratio, settings.coarsest_accuracy),
    )
    form = normal_form_on(first_elements, rod, w, settings.coarsest_accuracy)
    landau_change = slope_change = math.inf
    for refinement in range(settings.max_finer_meshes):
        elements = Elements(form.mixed_form.mesh.edges, form.mixed_form.mesh.order)
        finer_elements = (
            elements_with_third_more_unknowns(elements)
            if refinement
            else Elements(elements.edges, elements.order + settings.order_increase)
        )
        coarse_form = form
        form = normal_form_on(finer_elements, rod, w, settings.coarsest_accuracy)
        if finer_elements.edges != elements.edges:
            # Halved elements of a lower order may be no more accurate: the change says nothing of the error.
            continue
        landau_change = abs(1 - coarse_form.landau / form.landau)
        slope_change = abs(1 - coarse_form.eigenvalue_slope / form.eigenvalue_slope)
        if landau_change <= max(accuracy, _rounding_error(form)):
            break
    return form, landau_change, slope_change


def _rounding_error(form: NormalForm) -> float:
    """Relative rounding error of the Landau coefficient, from the condition number of the eigenvalue."""
    product_sizes = form.transverse_matrices.A_product_magnitude(form.p, form.q)
    return HOPF_COEFFICIENT_SETTINGS.landau_rounding_per_condition_number * product_sizes / abs(form.w)


def _coefficients_with_errors(
    normal: NormalForm, landau_error: float, slope_error: float, force_error: float
) -> HopfCoefficients:
    """The coefficients of the normal form `normal` and their relative errors, from three relative errors:
    `landau_error` of c, `slope_error` of dw/dF, and `force_error` of F. If Re c = 0 after rounding, as at a
    generalised Hopf point, the errors of a and b are infinite."""
    c = normal.landau
    slope = normal.eigenvalue_slope
    absolute_slope_error = slope_error * abs(slope)
    absolute_c_error = landau_error * abs(c)
    a = normal.amplitude_coefficient
    b = normal.frequency_slope
    a_error = absolute_b_error = math.inf
    if c.real != 0:
        # b = Im w' - r Re w', r = Im c/Re c: an error d of w' changes b by at most |d| hypot(1, r).
        absolute_b_error = math.hypot(1, c.imag / c.real) * (
            absolute_slope_error + abs(slope.real / c.real) * absolute_c_error
        )
    if c.real != 0 and slope.real != 0:
        # Half of the sum, because a is a square root.
        a_error = absolute_slope_error / abs(slope.real) + absolute_c_error / abs(c.real) + force_error
        a_error /= 2
    return HopfCoefficients(
        growth_slope=slope,
        growth_slope_error=slope_error,
        landau=c,
        landau_error=landau_error,
        amplitude_coefficient=a,
        amplitude_coefficient_error=a_error,
        frequency_slope=b,
        frequency_slope_error=absolute_b_error / abs(b) if 0 < abs(b) < math.inf else math.inf,
        elements=normal.mixed_form.mesh.element_count,
        order=normal.mixed_form.mesh.order,
    )


def _eigenvalue_slope_and_curvature(rod: Rod, w: complex) -> tuple[complex, float]:
    """Returns (dw/dF, |d^2w/dF^2|) of the root near w of the determinant D of `rod`."""
    # A one-sided difference suffices: the second derivative only enters error estimates.
    step = HOPF_COEFFICIENT_SETTINGS.relative_force_step * abs(rod.F)
    problem = path_problem(ParameterPath(rod, "F"))
    _, slope, _ = problem.eigenvalue_with_slope_and_error(w, rod.F)
    _, slope_before, _ = problem.eigenvalue_with_slope_and_error(w - slope * step, rod.F - step)
    return complex(slope), abs(slope - slope_before) / step
