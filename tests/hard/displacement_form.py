"""The rod in positions and angle, marched by SciPy: independent of the program from unknowns to clock.

The paper's Sec. II in the laboratory frame, in plain NumPy and without anything of rodsweep. Unknowns are x,
y and theta at the Lobatto points of one interval. The elastic forces are minus the gradient of the energy

    U = 1/2 int k1 (h1 - 1)^2 + k2 h2^2 + theta'^2 du,     (h1, h2) = R(theta)^T r',

by the quadrature on these points; at the tip acts -F along the axis there, and in the body frame a force
density drags with (gamma1, 1), a moment density with gamma3. Lengths in L, forces in k3/L^2, times in tau2.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre
from scipy.integrate import BDF

TINY = 1e-30
TOLERANCE = 1e-7
REPEATS, MOST_MAXIMA = 4e-5, 4
"""Relative difference of two maxima, as many apart as a period has, that are one and the same (the integrator
was seen to add 2e-5); how many a period may have."""
REPETITIONS = 3
"""Periods over which they have to repeat."""
FADED = 1e-3
"""Largest theta in units of that of the start at which a rod is straight."""
BISECTIONS = 35


def lobatto(order):
    """Points, weights and differentiation matrix on [0, 1] of order + 1 points."""
    top = legendre.Legendre.basis(order)
    nodes = np.concatenate([[-1.0], np.sort(top.deriv().roots().real), [1.0]])
    values = top(nodes)
    apart = nodes[:, None] - nodes
    np.fill_diagonal(apart, 1.0)
    D = values[:, None] / values / apart
    np.fill_diagonal(D, 0.0)
    D[0, 0], D[-1, -1] = -order * (order + 1) / 4, order * (order + 1) / 4
    return (nodes + 1) / 2, 1 / (order * (order + 1) * values**2), 2 * D


@dataclass(frozen=True)
class Displaced:
    """A rod; states q are x, y, theta at all points but the clamp, (..., 3 order)."""

    F: float
    k1: float
    k2: float
    gamma3: float
    gamma1: float
    order: int

    @cached_property
    def grid(self):
        return lobatto(self.order)

    @property
    def straight(self):
        """The rod at rest, compressed by F."""
        u = self.grid[0][1:]
        return np.concatenate([(1 - self.F / self.k1) * u, 0 * u, 0 * u])

    @cached_property
    def derivative(self):
        """The matrix from the points but the clamp to the derivative at all, transposed."""
        return np.ascontiguousarray(self.grid[2][:, 1:].T)

    def strains(self, q):
        """h1, h2, theta', cos theta and sin theta at all points."""
        fields = q.reshape(*q.shape[:-1], 3, self.order)
        slopes = fields @ self.derivative
        xs, ys, bend = slopes[..., 0, :], slopes[..., 1, :], slopes[..., 2, :]
        theta = np.zeros_like(bend)
        theta[..., 1:] = fields[..., 2, :]
        cos, sin = np.cos(theta), np.sin(theta)
        return xs * cos + ys * sin, ys * cos - xs * sin, bend, cos, sin

    def rate(self, q):
        """dq/dt of states, which may be complex."""
        w = self.grid[1]
        h1, h2, bend, cos, sin = self.strains(q)
        n1, n2 = self.k1 * (h1 - 1), self.k2 * h2
        lines = np.stack([n1 * cos - n2 * sin, n1 * sin + n2 * cos, bend], axis=-2)
        forces = -(w * lines) @ self.derivative.T
        cos, sin, w = cos[..., 1:], sin[..., 1:], w[1:]
        forces[..., 0, -1] -= self.F * cos[..., -1]
        forces[..., 1, -1] -= self.F * sin[..., -1]
        fx, fy = forces[..., 0, :] / w, forces[..., 1, :] / w
        v1, v2 = (fx * cos + fy * sin) / self.gamma1, fy * cos - fx * sin
        turning = forces[..., 2, :] / w - (h2 * n1 - h1 * n2)[..., 1:]
        return np.concatenate([v1 * cos - v2 * sin, v1 * sin + v2 * cos, turning / self.gamma3], axis=-1)

    def jacobian(self, q):
        return self.rate(q + 1j * TINY * np.eye(len(q))).imag.T / TINY

    def leading_mode(self):
        """(eigenvalue with Im >= 0, q beyond rest with tip y = 1) of the lateral mode that leads."""
        values, vectors = np.linalg.eig(self.jacobian(self.straight))
        tip = vectors[2 * self.order - 1]
        lateral = np.abs(tip) > 1e-9 * np.abs(vectors).max(axis=0)
        lead = int(np.argmax(np.where(lateral, values.real + 1e-9 * values.imag, -np.inf)))
        return values[lead], vectors[:, lead] / tip[lead]


@dataclass(frozen=True)
class Verdict:
    """What became of a rod: its word, and period, largest y of the tip where it beats."""

    word: str
    period: float = np.nan
    tip_y_max: float = np.nan
    time: float = np.nan


def march(rod, amplitude, periods, tolerance=TOLERANCE):
    """The verdict on the motion from the leading mode, with a deflection of the tip, in so many periods."""
    w, mode = rod.leading_mode()
    end = periods * 2 * np.pi / w.imag if w.imag else periods / abs(w.real)
    return march_from(rod, amplitude * mode.real, end, tolerance, tolerance * amplitude)


def march_from(rod, start, end, tolerance=TOLERANCE, least=TOLERANCE):
    """The verdict on the motion from a start, (3 order,) beyond rest, until a time.

    tolerance: relative, least: absolute.
    """
    tip = 2 * rod.order - 1
    run = BDF(
        lambda _, q: rod.rate(q), 0.0, rod.straight + start, end, rtol=tolerance, atol=least,
        jac=lambda _, q: rod.jacobian(q),
    )  # fmt: skip
    size, maxima, rising = np.abs(start[2 * rod.order :]).max(), [], []
    velocity = rod.rate(run.y)[tip]
    while run.status == "running":
        last, before = run.y[tip], velocity
        run.step()
        velocity = rod.rate(run.y)[tip]
        if rod.strains(run.y)[0].min() <= 0:
            return Verdict("left_the_model", time=run.t)
        if np.abs(run.y[2 * rod.order :]).max() < FADED * size:
            return Verdict("straight", time=run.t)
        if last < 0 <= run.y[tip]:
            rising.append(_root(run, lambda q: -q[tip])[0])
        if before > 0 >= velocity:
            maxima.append(_root(run, lambda q: rod.rate(q)[tip]))
            count = _repeating([state[tip] for _, state in maxima])
            if count:
                begin, end = (maxima[k][0] for k in (-1 - REPETITIONS * count, -1))
                inside = [when for when in rising if begin < when < end]
                crossings = len(inside) // REPETITIONS
                span = inside[-1] - inside[-1 - (REPETITIONS - 1) * crossings]
                largest = max(state[tip] for _, state in maxima[-count:])
                return Verdict("cycle", span / (REPETITIONS - 1), largest, run.t)
    return Verdict("undecided" if run.status == "finished" else "failed", time=run.t)


def _root(run, falling):
    """Time and state within the last step where a function of the state falls through 0."""
    state, low, high = run.dense_output(), run.t_old, run.t
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        low, high = (middle, high) if falling(state(middle)) > 0 else (low, middle)
    return low, state(low)


def _repeating(heights):
    """After how many maxima they repeat; 0 if they do not."""
    for count in range(1, MOST_MAXIMA + 1):
        last = np.array(heights[-(REPETITIONS + 1) * count :])
        if len(last) < (REPETITIONS + 1) * count or last[-count:].max() <= 0:
            return 0
        if np.abs(last[count:] - last[:-count]).max() <= REPEATS * np.abs(last).max():
            return count
    return 0
