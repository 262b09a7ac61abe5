"""The nonlinear arm in segments in positions and angle, by an element for each, marched by SciPy.

It shares nothing with the package: x, y and theta are the unknowns, which are continuous where the material
jumps, and the elastic forces are minus the gradient of the energy. Units as in `strain_collocation`.
"""

import numpy as np
from numpy.polynomial import legendre
from scipy.integrate import solve_ivp


def lobatto(order):
    """Points, weights and differentiation matrix on [0, 1] of order + 1 points."""
    top = legendre.Legendre.basis(order)
    x = np.concatenate([[-1.0], np.sort(top.deriv().roots().real), [1.0]])
    values = top(x)
    apart = x[:, None] - x + np.eye(order + 1)
    D = values[:, None] / values / apart
    np.fill_diagonal(D, 0.0)
    D[0, 0], D[-1, -1] = -order * (order + 1) / 4, order * (order + 1) / 4
    return (x + 1) / 2, 1 / (order * (order + 1) * values**2), 2 * D


class Segments:
    """Uniform segments. edges: their ends. stiffness, drag: three numbers for each of them."""

    def __init__(self, F, edges, stiffness, drag, law, order=14):
        self.F, self.law, self.order = F, law, order
        x, w, D = lobatto(order)
        lengths = np.diff(edges)
        self.u = np.concatenate([a + h * x[:-1] for a, h in zip(edges[:-1], lengths, strict=True)] + [[1.0]])
        self.places = [slice(e * order, (e + 1) * order + 1) for e in range(len(lengths))]
        self.k = [np.repeat(np.array(k, float)[:, None], order + 1, axis=1) for k in stiffness]
        self.w, self.D = [h * w for h in lengths], [D / h for h in lengths]
        self.weighted_drag = np.zeros((3, len(self.u)))
        for here, weights, own in zip(self.places, self.w, drag, strict=True):
            self.weighted_drag[:, here] += np.array(own)[:, None] * weights

    def rate(self, t, flat):
        fields = np.concatenate([np.zeros((3, 1)), flat.reshape(3, -1)], axis=1)
        force = np.zeros_like(fields)
        cos, sin = np.cos(fields[2]), np.sin(fields[2])
        for here, w, D, k in zip(self.places, self.w, self.D, self.k, strict=True):
            xs, ys, bend = fields[:, here] @ D.T
            c, s = cos[here], sin[here]
            h1, h2 = xs * c + ys * s, ys * c - xs * s
            n1, n2, m = self.law.stress(np.array([h1, h2, bend]), k)
            force[:, here] -= (w * np.array([c * n1 - s * n2, s * n1 + c * n2, m])) @ D
            force[2, here] -= w * (h2 * n1 - h1 * n2)
        force[:2, -1] -= self.F * np.array([cos[-1], sin[-1]])
        along, across, moment = (
            np.array([cos * force[0] + sin * force[1], cos * force[1] - sin * force[0], force[2]])
            / self.weighted_drag
        )
        return np.array([cos * along - sin * across, sin * along + cos * across, moment])[:, 1:].ravel()

    def cycle(self, start, period, turns=3, tolerance=1e-9):
        """(period, largest y of the tip) from x, y and theta at `u`, (3, nodes), after `turns` periods."""

        def crossing(t, flat):
            return flat[-1]

        crossing.direction = 1
        run = solve_ivp(
            self.rate,
            (0, (turns + 1.3) * period),
            start[:, 1:].ravel(),
            method="Radau",
            rtol=tolerance,
            atol=tolerance,
            events=crossing,
            dense_output=True,
        )
        times = run.t_events[0]
        last = times[-1] - times[-2]
        sampled = times[-2] + last * np.linspace(0, 1, 401)
        y = run.sol(sampled)[2 * len(self.u) - 3]
        top = int(np.argmax(y))
        near = slice(max(top - 3, 0), top + 4)
        fit = np.polyfit(sampled[near] - sampled[top], y[near], 4)
        at = np.roots(np.polyder(fit))
        at = at[abs(at.imag) < 1e-12].real
        return last, float(np.polyval(fit, at[np.argmin(abs(at))]))
