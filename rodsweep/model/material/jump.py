"""Stress of a rod at a jump of its material, as a function of the mean strain there; compiled, for every law.

Stress is continuous at a jump, strain is not. Let a and b be the unknowns of `response` on the base side and
on the tip side of the jump. Let w_a and w_b be the weights of both sides in the mean strain, with
w_a + w_b = 1 for each component. Then

    N(a) = N(b),    M(a) = M(b),    w_a a + w_b b = q,

where q are the unknowns at which a linear rod with the mean compliances has the mean strain. The linear law
has a = b = q. A weight is proportional to the side's compliance times its quadrature weight; the weights have
a limit for vanishing compliances.

Both sides of a jump are an array, (2, 7), with the columns `COLUMNS`. Strains on both sides follow from a and
b with the compliances of each side. The shear stress q2 is equal on both sides.
"""

from typing import NamedTuple

from ...arrays import Array
from ..compiled.compilation import compiled
from .response import LINEAR_LAW, LocalSection, Stress, Tangent, stress, stress_change, tangent

COLUMNS = ("nu", "c1", "c3", "share of c1", "share of c3", "share of the quadrature", "c2")
"""Columns of the array of both sides of a jump: fields of `LocalSection`, weights in the mean strain, and
c2."""
SHEAR = COLUMNS.index("c2")
"""Index of the shear compliance c2 in `COLUMNS`."""
MOST_ITERATIONS = 40
"""Maximum number of Newton iterations; after this number the last iterate is used."""
CONVERGED = 1e-9
"""Relative length of a Newton step after which the next step would be below rounding error."""
LEAST_STRETCH_KEPT = 0.1
"""Smallest ratio of the stretch h1 after a Newton step to h1 before; a longer step is shortened, because the
law is defined for h1 > 0 only."""


class Unknowns(NamedTuple):
    """The unknowns q1 (stretching) and q3 (bending) of a constitutive law at one point, as in `response`."""

    q1: float
    q3: float


@compiled
def _section(side: Array) -> LocalSection:
    return LocalSection(side[0], side[1], side[2])


@compiled
def _solved(T: Tangent, N: float, M: float) -> Unknowns:
    """Solution x of the 2 x 2 linear system T x = (N, M)."""
    determinant = T.N1 * T.M3 - T.N3 * T.M1
    return Unknowns((T.M3 * N - T.N3 * M) / determinant, (T.N1 * M - T.M1 * N) / determinant)


@compiled
def _allowed(at: LocalSection, q1: float, step: float) -> float:
    """Largest fraction, up to 1, of a Newton step `step` of q1 that leaves h1 at LEAST_STRETCH_KEPT h1."""
    h = at.nu + at.c1 * q1
    change = at.c1 * step
    if h + change >= LEAST_STRETCH_KEPT * h:
        return 1.0
    return (LEAST_STRETCH_KEPT - 1) * h / change


@compiled
def _small(step: Unknowns, at: Unknowns) -> bool:
    return abs(step.q1) <= CONVERGED * abs(at.q1) and abs(step.q3) <= CONVERGED * abs(at.q3)


@compiled
def unknowns_before_jump(law: int, sides: Array, q: Unknowns) -> Unknowns:
    """The unknowns a on the base side of a jump, from the mean unknowns q, by Newton's method.

    The equations are equal stresses on both sides. sides: (2, 7).
    """
    if law == LINEAR_LAW:
        return q
    one = _section(sides[0])
    other = _section(sides[1])
    # The mean is prescribed, so b decreases by this ratio times an increase of a.
    ratio1 = sides[0, 3] / sides[1, 3]
    ratio3 = sides[0, 4] / sides[1, 4]
    a = q
    for _ in range(MOST_ITERATIONS):
        b = unknowns_behind_jump(sides, q, a)
        s = stress(law, one, a.q1, a.q3)
        t = stress(law, other, b.q1, b.q3)
        S = tangent(law, one, a.q1, a.q3)
        T = tangent(law, other, b.q1, b.q3)
        # Newton's method for equal stresses on both sides: the derivative of their difference by a.
        J = Tangent(S.N1 + T.N1 * ratio1, S.N3 + T.N3 * ratio3, S.M1 + T.M1 * ratio1, S.M3 + T.M3 * ratio3)
        step = _solved(J, t.N - s.N, t.M - s.M)
        # Neither side may be crushed by a step, since the neo-Hookean stress is infinite there.
        share = min(_allowed(one, a.q1, step.q1), _allowed(other, b.q1, -ratio1 * step.q1))
        a = Unknowns(a.q1 + share * step.q1, a.q3 + share * step.q3)
        if _small(step, a):
            break
    return a


@compiled
def unknowns_behind_jump(sides: Array, q: Unknowns, a: Unknowns) -> Unknowns:
    """The unknowns b on the tip side of a jump, from the mean unknowns q and a; sides: (2, 7)."""
    return Unknowns((q.q1 - sides[0, 3] * a.q1) / sides[1, 3], (q.q3 - sides[0, 4] * a.q3) / sides[1, 4])


@compiled
def stress_at_jump(law: int, sides: Array, q1: float, q3: float) -> Stress:
    """Stresses N and M at a jump, minus their values at rest, for the mean unknowns q1, q3; sides: (2, 7)."""
    a = unknowns_before_jump(law, sides, Unknowns(q1, q3))
    return stress(law, _section(sides[0]), a.q1, a.q3)


@compiled
def _compliance_at_jump(law: int, sides: Array, a: Unknowns, b: Unknowns) -> Tangent:
    """Derivatives of the mean unknowns at a jump by the stresses: (dq1/dN, dq1/dM, dq3/dN, dq3/dM).

    sides: (2, 7). a, b: unknowns on the base side and the tip side.
    """
    S = tangent(law, _section(sides[0]), a.q1, a.q3)
    T = tangent(law, _section(sides[1]), b.q1, b.q3)
    s = S.N1 * S.M3 - S.N3 * S.M1
    t = T.N1 * T.M3 - T.N3 * T.M1
    s1 = sides[0, 3] / s
    s3 = sides[0, 4] / s
    t1 = sides[1, 3] / t
    t3 = sides[1, 4] / t
    return Tangent(
        s1 * S.M3 + t1 * T.M3, -s1 * S.N3 - t1 * T.N3, -s3 * S.M1 - t3 * T.M1, s3 * S.N1 + t3 * T.N1
    )


@compiled
def changes_beside_jump(law: int, sides: Array, q: Unknowns, change: Unknowns) -> tuple[Unknowns, Unknowns]:
    """(change of a, change of b): changes of the unknowns on the base side and the tip side of a jump.

    change: infinitesimal change of the mean unknowns q. sides: (2, 7).
    """
    a = unknowns_before_jump(law, sides, q)
    b = unknowns_behind_jump(sides, q, a)
    stresses = _solved(_compliance_at_jump(law, sides, a, b), change.q1, change.q3)
    S = tangent(law, _section(sides[0]), a.q1, a.q3)
    T = tangent(law, _section(sides[1]), b.q1, b.q3)
    return _solved(S, stresses.q1, stresses.q3), _solved(T, stresses.q1, stresses.q3)


@compiled
def tangent_at_jump(law: int, sides: Array, q1: float, q3: float) -> Tangent:
    """Derivatives of the stresses N and M at a jump by the mean unknowns q1 and q3; sides: (2, 7)."""
    q = Unknowns(q1, q3)
    a = unknowns_before_jump(law, sides, q)
    Z = _compliance_at_jump(law, sides, a, unknowns_behind_jump(sides, q, a))
    determinant = Z.N1 * Z.M3 - Z.N3 * Z.M1
    return Tangent(Z.M3 / determinant, -Z.N3 / determinant, -Z.M1 / determinant, Z.N1 / determinant)


@compiled
def stress_change_at_jump(law: int, sides: Array, change: Array, q1: float, q3: float) -> Stress:
    """Derivatives of the stresses N and M at a jump with respect to a parameter, at fixed mean unknowns.

    sides: (2, 7). change: derivatives of nu, c1 and c3 of both sides with respect to the parameter, (2, 3).
    The weights in the mean strain do not change: a parameter scales the compliances of both sides alike.
    """
    q = Unknowns(q1, q3)
    a = unknowns_before_jump(law, sides, q)
    b = unknowns_behind_jump(sides, q, a)
    moved1 = 0.0
    moved3 = 0.0
    for i in range(2):
        at = _section(sides[i])
        x = a if i == 0 else b
        own = stress_change(law, at, _section(change[i]), x.q1, x.q3)
        # At fixed stress the unknowns would change by -back. The mean is fixed, so the stress changes
        # instead.
        back = _solved(tangent(law, at, x.q1, x.q3), own.N, own.M)
        moved1 += sides[i, 3] * back.q1
        moved3 += sides[i, 4] * back.q3
    out = _solved(_compliance_at_jump(law, sides, a, b), moved1, moved3)
    return Stress(out.q1, out.q3)
