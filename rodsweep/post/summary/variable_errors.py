"""Absolute errors of the variables in a result file, which limit the digits in a summary.
variables: variables of the file, by name."""

from collections.abc import Mapping

import numpy as np

RELATIVE_EIGENVALUE_ERROR = 1e-9
"""Relative error of the straight rod's eigenvalue in results of limit cycles, equal to the tolerance of the
eigenvalue solver."""
RELATIVE_ERROR_NAME_BY_VARIABLE = {
    "period": "period_error",
    "frequency": "period_error",
    "period_tau1": "period_error",
    "tip_y_max": "amplitude_error",
    "special_period": "special_period_error",
    "special_tip_y_max": "special_tip_y_max_error",
    "special_amplitude_coefficient": "special_amplitude_coefficient_error",
    "amplitude_coefficient": "amplitude_coefficient_error",
    "frequency_slope": "frequency_slope_error",
    "condition": "condition_error",
    "transient_growth": "growth_error",
    "longitudinal_rate": "longitudinal_error",
}
"""For each variable, the name of the variable that contains its relative error."""
ABSOLUTE_ERROR_NAMES = {
    "growth_rate": "error_estimate",
    "frequency": "error_estimate",
    "numerical_abscissa": "abscissa_error",
    "multiplier": "multiplier_error",
    "special_at": "special_error",
    "crossing_F": "crossing_error",
    "crossing_at": "crossing_error",
    "crossing_frequency": "crossing_frequency_error",
}
"""For each variable, the name of the variable that contains its absolute error. In files with a period, the
error of `frequency` is relative (see RELATIVE_ERROR_NAME_BY_VARIABLE)."""
COMPLEX_VARIABLES = ("landau", "growth_slope")
"""Complex variables, stored as real and imaginary part. The stored error is relative to the modulus."""
TIP_SCALED_ERROR_VARIABLES = ("tip_x_min", "tip_x_max", "tip_y_min", "tip_theta_max", "least_stretch")
"""Variables of a cycle whose stored error is the absolute error divided by tip_y_max."""
MAX_H1_DIP_BETWEEN_NODES = 4e-3
"""Assumed bound of (smallest nodal h1 - smallest h1 between nodes)/|1 - h1|; twice the largest ratio of tests
with arms of segments and of rubber."""
CYCLE_POWER_VARIABLE_NAMES = ("injection_mean", "injection_rms", "dissipation_mean", "dissipation_rms")
"""Mean powers and rms fluctuations. Their errors follow from the errors of amplitude, period and energy
balance."""
MAX_RELATIVE_ERROR_OF_GROWTH_TIME = 0.5
"""The time of the largest transient growth is treated as unknown if its relative error is at least this
number."""
STRAIGHT_ROD_EIGENVALUE_NAMES = ("linear_growth_rate", "linear_frequency")
"""Variables with the eigenvalue of the straight rod in results of limit cycles."""


RELATIVE_MODULATION_RATIO_ERROR = 1e-3
"""Relative error of modulation_ratio, five times the change with tighter tolerances and a finer mesh that was
measured on a torus."""


def absolute_errors(variables: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """Absolute errors of the variable `name`, of the shape of the variable; 0 for a variable without an
    error."""
    stem, _, part_name = name.rpartition("_")
    with np.errstate(invalid="ignore"):  # an infinite value times the error 0
        if stem in COMPLEX_VARIABLES and part_name != "error" and f"{stem}_error" in variables:
            return np.hypot(variables[f"{stem}_real"], variables[f"{stem}_imag"]) * variables[f"{stem}_error"]
        return _errors_of_real_variable(variables, name)


def _errors_of_real_variable(variables: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """Absolute errors of the variable `name`, which is not a part of a complex variable. The errors have the
    shape of the variable. NumPy may warn of infinite values."""
    values = np.abs(variables[name])
    if name in STRAIGHT_ROD_EIGENVALUE_NAMES:
        return RELATIVE_EIGENVALUE_ERROR * np.hypot(
            *(variables[part_name] for part_name in STRAIGHT_ROD_EIGENVALUE_NAMES)
        )
    if name in CYCLE_POWER_VARIABLE_NAMES and "amplitude_error" in variables:
        return values * relative_power_error(variables, fluctuation=name.endswith("rms"))
    if name in TIP_SCALED_ERROR_VARIABLES and "extrema_error" in variables:
        dip_error = MAX_H1_DIP_BETWEEN_NODES * np.abs(1 - variables[name]) if name == "least_stretch" else 0.0
        return variables["extrema_error"] * variables["tip_y_max"] + dip_error
    if name == "transient_time" and "growth_error" in variables:
        # The growth is quadratic near its maximum, and is 1 at t = 0.
        log_growth = np.maximum(1 - 1 / variables["transient_growth"], np.finfo(float).tiny)
        return values * np.sqrt(variables["growth_error"] / log_growth)
    relative_error = RELATIVE_ERROR_NAME_BY_VARIABLE.get(name, "")
    if name == "modulation_ratio" or relative_error in variables:
        return values * (variables[relative_error] if relative_error else RELATIVE_MODULATION_RATIO_ERROR)
    return (
        variables[ABSOLUTE_ERROR_NAMES[name]]
        if ABSOLUTE_ERROR_NAMES.get(name, "") in variables
        else np.zeros_like(values, float)
    )


def relative_power_error(variables: Mapping[str, np.ndarray], fluctuation: bool = False) -> np.ndarray:
    """Relative error of the mean power of cycles, or of the rms fluctuation of the power if `fluctuation`.
    variables: variables of the file, of equal shapes.

    The error includes the energy imbalance. For an integrated cycle, which has no multiplier, it also
    includes the error of the extrema: injection and dissipation then have a common error from the
    interpolation between steps, at most about as large.
    """
    error = (
        2 * variables["amplitude_error"] + variables["period_error"] + np.abs(variables["energy_imbalance"])
    )
    error = error + np.where(np.isnan(variables["multiplier"]), variables["extrema_error"], 0.0)
    return error + 2 * variables["extrema_error"] if fluctuation else error


def known_values_mask(variables: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """Mask of the known values of the variable `name`, of the shape of the variable.

    Only the time of the largest transient growth can be unknown: the error of this time is large if the
    growth hardly exceeds 1.
    """
    values = np.asarray(variables[name])
    if name != "transient_time" or "growth_error" not in variables:
        return np.ones(values.shape, bool)
    return (values == 0) | ~(absolute_errors(variables, name) >= MAX_RELATIVE_ERROR_OF_GROWTH_TIME * values)
