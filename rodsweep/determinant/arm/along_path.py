"""D of arms along a path of one parameter: eigenvalues with their slopes, and double eigenvalues.

D depends on the parameter through all coefficients along the arm, so that derivatives by the parameter are
central differences between the determinants of neighbouring arms. They need not be accurate: they steer
Newton's method and predict, while D itself decides.
"""

import math

from ..newton import FAILED, JACOBIAN_STEP, LAST_NEWTON_STEP, MOST_NEWTON_STEPS, Zero
from ..parameter_path import Path
from ..value import ROUND_OFF, Value
from .determinant import ArmDeterminant, arm_determinant
from .roots import refined, root_error, second_derivative


class ArmAlongPath:
    """D of the arms of one path; p: the path variable."""

    def __init__(self, path: Path):
        self.path = path

    def determinant(self, p: float) -> ArmDeterminant:
        """D of the arm at p."""
        return arm_determinant(self.path.at(p))

    def eigenvalue(self, guess: complex, p: float) -> tuple[complex, complex, float]:
        """(eigenvalue near the guess, its slope by p, its error) at p."""
        here = self.determinant(p)
        w = refined(guess, here)
        value = here.value(w)
        return w, -self.derivative(w, p, value.S) / value.D_w, root_error(w, here)

    def derivative(self, w: complex, p: float, S: float) -> complex:
        """dD/dp exp(-S) at w and p."""
        h = self._step(p)
        after, before = self.determinant(p + h).value(w), self.determinant(p - h).value(w)
        return (after.D * math.exp(after.S - S) - before.D * math.exp(before.S - S)) / (2 * h)

    def double(self, x: float, p: float, reach: float) -> Zero:
        """The double real eigenvalue near (x, p): D = D_w = 0, p at most `reach` away."""
        start, first, last = x, p, math.inf
        for _ in range(2 * MOST_NEWTON_STEPS):
            here = self.determinant(p)
            value = here.value(complex(x, 0.0))
            D, D_w, S, noise = value.D.real, value.D_w.real, value.S, value.noise
            D_ww = second_derivative(complex(x, 0.0), S, here).real
            k = min(JACOBIAN_STEP * reach, self._step(p))
            after, before = self._real(x, p + k, S), self._real(x, p - k, S)
            D_p, D_wp = ((a - b) / (2 * k) for a, b in zip(after, before, strict=True))
            cross = D_w * D_wp - D_p * D_ww
            if cross == 0 or not math.isfinite(cross):
                return FAILED
            in_x, in_p = (D_p * D_w - D_wp * D) / cross, (D_ww * D - D_w * D_w) / cross
            blur = noise + ROUND_OFF * abs(p * D_p)
            e_p = blur * abs(D_ww) / abs(cross)
            e_x = (blur * abs(D_wp) + noise / max(abs(x), 1e-300) * abs(D_p)) / abs(cross)
            x += in_x
            p += in_p
            if not abs(p - first) <= 2 * reach or not x * start > 0:
                return FAILED
            small = abs(in_p) <= LAST_NEWTON_STEP * e_p
            if small and (abs(in_x) <= LAST_NEWTON_STEP * e_x or abs(in_x) > last / 2):
                return Zero(x, p, max(e_x, abs(in_x)), max(e_p, abs(in_p)))
            last = abs(in_x)
        return FAILED

    def _real(self, x: float, p: float, S: float) -> tuple[float, float]:
        """(D, D_w) exp(-S) at real w = x."""
        value: Value = self.determinant(p).value(complex(x, 0.0))
        scale = math.exp(value.S - S)
        return value.D.real * scale, value.D_w.real * scale

    def _step(self, p: float) -> float:
        """Step of a difference by p; no arm within it is crushed."""
        step = JACOBIAN_STEP * max(abs(p), 1.0)
        if self.path.name == "F":
            step = min(step, (self.path.rod.crushing_force - p) / 4)
        return step
