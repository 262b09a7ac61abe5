"""The absolute error of every variable that has one, so that no more digits are told than are known."""

from collections.abc import Mapping

import numpy as np

from .ranges import span

EIGENVALUE = 1e-9
"""Relative error of the eigenvalue of a straight rod beside a cycle: what its solver is asked for."""
RELATIVE = {
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
}
"""Variables whose error is stored relative to them."""
ABSOLUTE = {
    "growth_rate": "error_estimate",
    "frequency": "error_estimate",
    "numerical_abscissa": "abscissa_error",
    "multiplier": "multiplier_error",
    "special_at": "special_error",
    "crossing_F": "crossing_error",
    "crossing_at": "crossing_error",
    "crossing_frequency": "crossing_frequency_error",
}
"""Variables whose error is stored in their unit; `frequency` is one of these where there is no period."""
EXTREMA = ("tip_x_min", "tip_x_max", "tip_y_min", "tip_theta_max", "least_stretch")
"""Variables of a cycle whose error is stored in units of tip_y_max."""
BETWEEN_NODES = 1e-3
"""How much less h1 may be between nodes than at them, in units of how far it is from 1."""
POWERS = ("injection_mean", "injection_rms", "dissipation_mean", "dissipation_rms")
MIN_KNOWN = 0.5
"""Relative error from which not one digit of a time is known."""
OF_THE_STRAIGHT_ROD = ("linear_growth_rate", "linear_frequency")


def errors_of(v: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """The absolute errors of a variable of a file, of its shape: 0 where it is known to all digits."""
    with np.errstate(invalid="ignore"):  # inf, whose error is 0
        return _errors(v, name)


def _errors(v: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    values = np.abs(v[name])
    if name in OF_THE_STRAIGHT_ROD:
        return EIGENVALUE * np.hypot(*(v[part] for part in OF_THE_STRAIGHT_ROD))
    if name in POWERS and "amplitude_error" in v:
        return values * power_error(v, fluctuation=name.endswith("rms"))
    if name in EXTREMA and "extrema_error" in v:
        beside = BETWEEN_NODES * np.abs(1 - v[name]) if name == "least_stretch" else 0.0
        return v["extrema_error"] * v["tip_y_max"] + beside
    if name == "transient_time" and "growth_error" in v:
        # Next to its flat maximum the growth falls quadratically, down to 1 at t = 0.
        rise = np.maximum(1 - 1 / v["transient_growth"], np.finfo(float).tiny)
        return values * np.sqrt(v["growth_error"] / rise)
    if RELATIVE.get(name, "") in v:
        return values * v[RELATIVE[name]]
    return v[ABSOLUTE[name]] if ABSOLUTE.get(name, "") in v else np.zeros_like(values, float)


def power_error(v: Mapping[str, np.ndarray], fluctuation: bool = False) -> np.ndarray:
    """Relative error of a power of a cycle, of any shape: its mean goes with the amplitude's square."""
    mean = 2 * v["amplitude_error"] + v["period_error"] + np.abs(v["energy_imbalance"])
    return mean + 2 * v["extrema_error"] if fluctuation else mean


def is_known(v: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """Where a variable is known at all, a mask of its shape: a maximum hardly above 1 may be anywhere."""
    values = np.asarray(v[name])
    if name != "transient_time" or "growth_error" not in v:
        return np.ones(values.shape, bool)
    return (values == 0) | ~(errors_of(v, name) >= MIN_KNOWN * values)


def span_of(v: Mapping[str, np.ndarray], name: str, there: np.ndarray) -> str:
    """The range of a variable over the points that are `there`, a mask of their shape, as far as known."""
    there = there & is_known(v, name) if name == "transient_time" else there
    return span(v[name][there], errors_of(v, name)[there])
