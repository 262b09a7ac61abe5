"""What is known exactly of one rod, to 30 digits, without any code of rodsweep.

A rod is a tuple (F, k1, k2, gamma3) of floats, which are exact. Candidates for its eigenvalues come from
`hard.integral_equation`, the digits from mpmath (`reference.determinant`).
"""

from functools import cache

import mpmath as mp
from reference import determinant as reference

from .integral_equation import dense_eigenvalues, fastest_wave, nodes_for

DIGITS = 30
CLOSE = 1e-2
"""Relative distance of eigenvalues below which the root of one is divided out before the next is sought."""
ASTRAY = 1e-3
"""Relative distance a candidate may move; farther off it would be another eigenvalue."""
NEAR_AXIS = 1e-4
"""Relative real part below which not the dense mesh but the exact root says on which side it lies."""
SHIFT = 1.05


@cache
def candidates(rod, modes=4, extra=0):
    """All eigenvalues that a dense mesh stands for, at least `modes`; `extra` makes another mesh of it."""
    nodes = nodes_for(rod, modes) + extra
    return dense_eigenvalues(rod, nodes, (SHIFT + extra / 100) * fastest_wave(rod)[0])


@cache
def leading(rod, modes):
    """The leading eigenvalues, of a pair the positive frequency first, as mpmath numbers."""
    found = []
    near = candidates(rod, modes)
    for candidate in near[: modes + 1]:
        if candidate.imag < 0 and found and abs(mp.conj(found[-1]) - candidate) < ASTRAY * abs(candidate):
            found.append(mp.conj(found[-1]))
        else:
            crowded = (abs(near - candidate) < CLOSE * abs(candidate)).sum() > 1
            found.append(_root(rod, complex(candidate), found, crowded))
    found.sort(key=lambda w: (-mp.re(w), -mp.im(w)))
    return found[:modes]


def _root(rod, candidate, known, crowded):
    """The zero of D at a candidate, other than the known ones nearby."""
    beside = [w for w in known if abs(w - candidate) < CLOSE * abs(candidate)]

    def deflated(w, F, k1, k2, gamma3, digits):
        value = reference.D_wedge(w, F, k1, k2, gamma3, digits)
        for zero in beside:
            value /= w - zero
        return value

    with mp.workdps(2 * DIGITS):
        start = mp.mpmathify(candidate)
        if crowded:  # of two that all but coincide the candidates do not tell whether they are real
            start += mp.mpc(0, 1e-8 * abs(candidate))
        root = mp.mpmathify(reference.refine(start, *rod, digits=DIGITS, det=deflated))
        if abs(root - candidate) > ASTRAY * abs(candidate) or root in known:
            raise ArithmeticError(f"{rod}: the candidate {candidate} went to {root}")
        return mp.re(root) if abs(mp.im(root)) < mp.mpf(10) ** -DIGITS * abs(root) else root


@cache
def unstable(rod):
    """The number of unstable modes by two dense meshes, which must agree, and by roots near the axis."""
    counts = []
    for extra in (0, 12):
        w = candidates(rod, extra=extra)
        near = abs(w.real) < NEAR_AXIS * abs(w)
        clear = int((w.real[~near] > 0).sum())
        roots = leading(rod, int(near.nonzero()[0].max()) + 1)[-int(near.sum()) :] if near.any() else []
        counts.append(clear + sum(mp.re(root) > 0 for root in roots))
    if counts[0] != counts[1]:
        raise ArithmeticError(f"{rod}: dense meshes count {counts}")
    return counts[0]


def sensitivity(w, rod):
    """|dw/dF| |F|/|w|: relative change of an eigenvalue in units of a relative change of the force."""
    slope, change = derivatives(w, rod, ("w", "F"))
    return float(abs(change * rod[0] / (slope * w)))


def derivatives(w, rod, names):
    """[dD/dname] at w, names among w, F, c1, c2, gamma3: D is entire in all, and so it is in the limits."""
    F, k1, k2, gamma3 = (mp.mpf(x) for x in rod)
    at = {"w": mp.mpmathify(w), "F": F, "c1": 1 / k1, "c2": 1 / k2, "gamma3": gamma3}

    def D(values):
        k1, k2 = (1 / values[c] if values[c] else mp.inf for c in ("c1", "c2"))
        return reference.D_wedge(values["w"], values["F"], k1, k2, values["gamma3"], 3 * DIGITS)

    def along(name):
        h = mp.mpf(10) ** -DIGITS * (abs(at[name]) if at[name] else 1)
        return (D(at | {name: at[name] + h}) - D(at | {name: at[name] - h})) / (2 * h)

    with mp.workdps(3 * DIGITS):
        return [along(name) for name in names]
