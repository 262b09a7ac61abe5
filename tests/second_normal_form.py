"""Normal form of a Hopf point from independent equations, on different nodes, with third derivatives.

The unknowns are the shape (x, y, theta) of the rod at Chebyshev nodes, instead of stresses and velocities in
the body's frame. The equations contain sines and cosines and terms of third and higher order; derivatives
come from truncated power series. Only for finite k1, k2 and gamma3 > 0. Nothing is imported from rodsweep.
"""

import numpy as np

TERMS = 4
"""Of a power series in a small amplitude: up to its cube."""


def chebyshev(n):
    """(nodes on [0, 1] in increasing order, differentiation matrix)."""
    k = np.arange(n + 1)
    x = -np.cos(np.pi * k / n)
    c = np.where((k == 0) | (k == n), 2.0, 1.0) * (-1.0) ** k
    D = np.outer(c, 1 / c) / (x[:, None] - x + np.eye(n + 1))
    D -= np.diag(D.sum(axis=1))
    return (x + 1) / 2, 2 * D


def times(a, b):
    """The product of two series, (TERMS, n)."""
    return np.array([sum(a[j] * b[i - j] for j in range(i + 1)) for i in range(TERMS)])


def cos_sin(angle):
    """The cosine and the sine of a series, from (cos)' = -angle' sin, (sin)' = angle' cos."""
    c, s = np.zeros_like(angle), np.zeros_like(angle)
    c[0], s[0] = np.cos(angle[0]), np.sin(angle[0])
    for i in range(1, TERMS):
        c[i] = -sum(j * angle[j] * s[i - j] for j in range(1, i + 1)) / i
        s[i] = sum(j * angle[j] * c[i - j] for j in range(1, i + 1)) / i
    return c, s


class ArmGeometry:
    """d(x, y, theta)/dt of a rod with F, k1, k2, gamma3, gamma1 at n nodes beyond the clamp."""

    def __init__(self, F, k1, k2, gamma3, gamma1, n):
        self.F, self.k1, self.k2, self.gamma3, self.gamma1 = F, k1, k2, gamma3, gamma1
        self.u, self.D = chebyshev(n)
        self.n = n
        straight = (1 - F / k1) * self.u[1:]
        self.rest = np.concatenate([straight, np.zeros(2 * n)])

    def rate(self, X):
        """A series of states, (TERMS, 3 n), to that of their rates."""
        x, y, theta = (np.pad(part, ((0, 0), (1, 0))) for part in np.split(X, 3, axis=1))
        c, s = cos_sin(theta)
        dx, dy, kappa = x @ self.D.T, y @ self.D.T, theta @ self.D.T
        h1, h2 = times(c, dx) + times(s, dy), times(c, dy) - times(s, dx)
        n1, n2 = self.k1 * h1, self.k2 * h2
        n1[0] -= self.k1
        n1[:, -1], n2[:, -1], kappa[:, -1] = 0, 0, 0  # the tip: (-F, 0, 0), its strain (1 - F/k1, 0, 0)
        n1[0, -1] = -self.F
        h1[:, -1], h2[:, -1] = 0, 0
        h1[0, -1] = 1 - self.F / self.k1
        fx, fy = times(c, n1) - times(s, n2), times(s, n1) + times(c, n2)
        fx, fy = fx @ self.D.T, fy @ self.D.T
        v1, v2 = (times(c, fx) + times(s, fy)) / self.gamma1, times(c, fy) - times(s, fx)
        turning = (kappa @ self.D.T + times(h1, n2) - times(h2, n1)) / self.gamma3
        rates = times(c, v1) - times(s, v2), times(s, v1) + times(c, v2), turning
        return np.concatenate([rate[:, 1:] for rate in rates], axis=1)

    def along(self, direction):
        """The coefficients of the rate at rest + amplitude direction, (TERMS, 3 n)."""
        series = np.zeros((TERMS, 3 * self.n), complex)
        series[0], series[1] = self.rest, direction
        return self.rate(series)

    def linear(self):
        return np.array([self.along(each)[1].real for each in np.eye(3 * self.n)]).T

    def second(self, a, b):
        """The second derivative, B(a, b)."""
        return (self.along(a + b)[2] - self.along(a - b)[2]) / 2

    def third(self, q):
        """The third derivative, C(q, q, conj q)."""
        plus, minus = self.along(q + q.conj())[3], self.along(q - q.conj())[3]
        return plus - minus - 2 * self.along(q.conj())[3]


def coefficients(rod, w, n):
    """(c, dw/dF) of the eigenvalue nearest to w; rod: (F, k1, k2, gamma3, gamma1)."""
    shape = ArmGeometry(*rod, n)
    A = shape.linear()
    values, vectors = np.linalg.eig(A)
    at = np.argmin(abs(values - w))
    value, q = values[at], vectors[:, at]
    left_values, left = np.linalg.eig(A.T)
    p = left[:, np.argmin(abs(left_values - value))]
    q = q / (2 * q[2 * n - 1])
    p = p / (p @ q)
    h20 = np.linalg.solve(2j * value.imag * np.eye(3 * n) - A, shape.second(q, q))
    h11 = np.linalg.solve(-A, shape.second(q, q.conj()))
    c = p @ (shape.third(q) + shape.second(q.conj(), h20) + 2 * shape.second(q, h11)) / 2
    step = 1e-4 * rod[0]
    ends = [ArmGeometry(rod[0] + side * step, *rod[1:], n).linear() for side in (-1, 1)]
    return c, p @ ((ends[1] - ends[0]) / (2 * step)) @ q
