"""The nonlinear arm in strains by Chebyshev collocation in strong form, marched by SciPy's Radau.

It shares nothing with the package: strains are the unknowns, boundary values are imposed at the nodes, and
time is integrated by SciPy. Lengths in L, forces in k3/L^2, times in tau2, stiffnesses and drags as functions
of u.
"""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq


def chebyshev(order):
    """Nodes on [0, 1], increasing, and the differentiation matrix."""
    k = np.arange(order + 1)
    x = -np.cos(np.pi * k / order)
    c = np.where((k == 0) | (k == order), 2.0, 1.0) * (-1.0) ** k
    apart = x[:, None] - x + np.eye(order + 1)
    D = np.outer(c, 1 / c) / apart
    D -= np.diag(D.sum(axis=1))
    return (x + 1) / 2, 2 * D


class Law:
    """U = k1 W(h) + k2 g^2/2 + k3 B(h) kappa^2/2: its derivatives by (h, g, kappa)."""

    def __init__(self, law, section):
        self.rubber, self.swelling = law == "neo_hookean", section == "swelling"

    def stress(self, E, k):
        h, g, kappa = E
        pull = (h - h**-2) / 3 if self.rubber else h - 1
        B, slope = 1.0, 0.0
        if self.swelling:
            B, slope = (1 + 2 / h**3) / (3 * h), -(1 + 8 / h**3) / (3 * h**2)
        return np.array([k[0] * pull + k[2] * slope * kappa**2 / 2, k[1] * g, k[2] * B * kappa])

    def rest(self, load):
        """The stretch under a load F/k1."""
        if not self.rubber:
            return 1 - load
        return brentq(lambda h: (h - h**-2) / 3 + load, 1e-3, 10, xtol=1e-15)


class Arm:
    """An arm of one smooth piece. stiffness, drag: functions of u that give three numbers each."""

    def __init__(self, F, stiffness, drag, law, order=36):
        self.F, self.law = F, law
        self.u, self.D = chebyshev(order)
        self.k = np.array([stiffness(u) for u in self.u]).T
        self.gamma = np.array([drag(u) for u in self.u]).T
        self.tip = np.array([law.rest(F / self.k[0, -1]), 0.0, 0.0])

    def velocities(self, E):
        n1, n2, m = S = self.law.stress(E, self.k)
        dn1, dn2, dm = S @ self.D.T
        h1, h2, kappa = E
        forces = np.array([dn1 - kappa * n2, dn2 + kappa * n1, dm + h1 * n2 - h2 * n1])
        V = forces / self.gamma
        V[:, 0] = 0.0
        return V

    def rate(self, t, flat):
        E = np.concatenate([flat.reshape(3, -1), self.tip[:, None]], axis=1)
        h1, h2, kappa = E
        v1, v2, turn = V = self.velocities(E)
        rates = V @ self.D.T + np.array([h2 * turn - kappa * v2, kappa * v1 - h1 * turn, 0 * turn])
        return rates[:, :-1].ravel()

    def start(self, strains):
        """Unknowns from strains (h1, h2, kappa) as a function of u."""
        return np.array([strains(u) for u in self.u[:-1]]).T.ravel()

    def tip_of(self, flat):
        """(x, y, theta) of the tip."""
        E = np.concatenate([flat.reshape(3, -1), self.tip[:, None]], axis=1)
        inverse = np.linalg.inv(self.D[1:, 1:])
        theta = np.append(0.0, inverse @ E[2, 1:])
        # theta(0) = 0: the integral of a field f solves D y = f with y(0) = 0.
        dx = np.cos(theta) * E[0] - np.sin(theta) * E[1]
        dy = np.sin(theta) * E[0] + np.cos(theta) * E[1]
        return np.array([(inverse @ d[1:])[-1] for d in (dx, dy)] + [theta[-1]])

    def cycle(self, start, period, turns=4, tolerance=1e-10):
        """(period, largest y of the tip) of the motion from a start, after `turns` periods."""

        def crossing(t, flat):
            return self.tip_of(flat)[2]

        crossing.direction = 1
        run = solve_ivp(
            self.rate,
            (0, (turns + 1.3) * period),
            start,
            method="Radau",
            rtol=tolerance,
            atol=tolerance,
            events=crossing,
            dense_output=True,
        )
        times = run.t_events[0]
        last = times[-1] - times[-2]
        sampled = times[-2] + last * np.linspace(0, 1, 401)
        y = [self.tip_of(run.sol(t))[1] for t in sampled]
        top = int(np.argmax(y))
        near = slice(max(top - 3, 0), top + 4)
        fit = np.polyfit(sampled[near] - sampled[top], y[near], 4)
        at = np.roots(np.polyder(fit))
        at = at[abs(at.imag) < 1e-12].real
        at = at[np.argmin(abs(at))]
        return last, float(np.polyval(fit, at))
