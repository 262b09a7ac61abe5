"""Compiled stress of a rod at a jump of its material as a function of the mean strain, for every law.

Stress is continuous at a jump, strain is not. Let a and b be the unknowns of `stress_strain`
on the base side and on the tip side of the jump. Let w_a and w_b be the weights of both sides in the mean
strain, with w_a + w_b = 1 for each component. Then

    N(a) = N(b),    M(a) = M(b),    w_a a + w_b b = q,

where q are the unknowns of a linear rod that has the mean compliances and the mean strain. For the linear law
a = b = q. The weight of a side is proportional to the compliance times the quadrature weight of the side; the
weights have a limit if both compliances tend to 0.

The argument `sides` of all functions describes both sides of a jump, (2, 7), with the columns
`JUMP_SIDE_COLUMNS`. The strains on both sides follow from a and b and the compliances of both sides. The
shear stress q2 is equal on both sides.
"""

from typing import NamedTuple

from ...arrays import Array
from ..compiled.compilation import compiled
from .stress_strain import (
    LINEAR_LAW_NUMBER,
    LocalSection,
    StressMinusRestStress,
    TangentMatrix,
    stress_minus_rest_stress,
    stress_parameter_derivative,
    stress_tangent,
)

JUMP_SIDE_COLUMNS = ("nu", "c1", "c3", "share of c1", "share of c3", "share of the quadrature", "c2")
"""Columns of the array that describes both sides of a jump: the fields of `LocalSection`, the side's weights
w in the mean of q1 and of q3, the side's fraction of the quadrature weight of the node, and c2."""
SHEAR_COMPLIANCE_COLUMN = JUMP_SIDE_COLUMNS.index("c2")
"""Index of the shear compliance c2 in `JUMP_SIDE_COLUMNS`."""
MAX_JUMP_ITERATIONS = 40
"""Maximum number of Newton iterations; without convergence the last iterate is used."""
CONVERGED_RELATIVE_STEP = 1e-9
"""Newton's method stops when |step| <= CONVERGED_RELATIVE_STEP * |unknown|, as the next step would be
rounding."""
MIN_STEP_STRETCH_RATIO = 0.1
"""A Newton step is shortened so that the stretch h1 after the step is at least this fraction of h1 before the
step, because the law is defined for h1 > 0 only."""


class LawUnknowns(NamedTuple):
    """The unknowns q1 (stretching) and q3 (bending) of a law at one point, as in `stress_strain`."""

    q1: float
    q3: float


@compiled
def _section_of_side(side: Array) -> LocalSection:
    """The section on one side of a jump. side: the values of this side, (7,), in the order of
    JUMP_SIDE_COLUMNS."""
    return LocalSection(side[0], side[1], side[2])


@compiled
def _solve_tangent_system(T: TangentMatrix, N: float, M: float) -> LawUnknowns:
    """Solution x of the linear system T x = (N, M), with the 2 x 2 matrix T = ((N1, N3), (M1, M3))."""
    determinant = T.N1 * T.M3 - T.N3 * T.M1
    return LawUnknowns((T.M3 * N - T.N3 * M) / determinant, (T.N1 * M - T.M1 * N) / determinant)


@compiled
def _largest_step_fraction(material: LocalSection, q1: float, step: float) -> float:
    """Largest fraction, up to 1, of a step of q1 after which h1 >= MIN_STEP_STRETCH_RATIO times h1 before the
    step. material, q1: section and unknown before the step. step: increment of q1."""
    h = material.nu + material.c1 * q1
    change = material.c1 * step
    if h + change >= MIN_STEP_STRETCH_RATIO * h:
        return 1.0
    return (MIN_STEP_STRETCH_RATIO - 1) * h / change


@compiled
def _is_negligible(step: LawUnknowns, unknowns: LawUnknowns) -> bool:
    """Whether a Newton step is small enough to stop; unknowns: the unknowns after the step."""
    return abs(step.q1) <= CONVERGED_RELATIVE_STEP * abs(unknowns.q1) and abs(
        step.q3
    ) <= CONVERGED_RELATIVE_STEP * abs(unknowns.q3)


@compiled
def unknowns_before_jump(law: int, sides: Array, q: LawUnknowns) -> LawUnknowns:
    """The unknowns a on the base side of a jump, from the mean unknowns q. law: number of the constitutive
    law. sides: both sides, (2, 7), with the columns JUMP_SIDE_COLUMNS. Newton's method solves the equations
    of equal stresses on both sides."""
    # With stresses as unknowns a linear rod has the same unknown on both sides.
    if law == LINEAR_LAW_NUMBER:
        return q
    base_side = _section_of_side(sides[0])
    tip_side = _section_of_side(sides[1])
    # The mean is prescribed, so db = -ratio da.
    ratio1 = sides[0, 3] / sides[1, 3]
    ratio3 = sides[0, 4] / sides[1, 4]
    a = q
    for _ in range(MAX_JUMP_ITERATIONS):
        b = unknowns_behind_jump(sides, q, a)
        s = stress_minus_rest_stress(law, base_side, a.q1, a.q3)
        t = stress_minus_rest_stress(law, tip_side, b.q1, b.q3)
        S = stress_tangent(law, base_side, a.q1, a.q3)
        T = stress_tangent(law, tip_side, b.q1, b.q3)
        # J is the derivative of (stress on the base side - stress on the tip side) with respect to a.
        J = TangentMatrix(
            S.N1 + T.N1 * ratio1, S.N3 + T.N3 * ratio3, S.M1 + T.M1 * ratio1, S.M3 + T.M3 * ratio3
        )
        # A direct formula for two unknowns, as a call of a linear solver would cost more than the rest.
        step = _solve_tangent_system(J, t.N - s.N, t.M - s.M)
        # No side may be crushed by a step, since the neo-Hookean stress is infinite at h1 = 0.
        fraction = min(
            _largest_step_fraction(base_side, a.q1, step.q1),
            _largest_step_fraction(tip_side, b.q1, -ratio1 * step.q1),
        )
        a = LawUnknowns(a.q1 + fraction * step.q1, a.q3 + fraction * step.q3)
        if _is_negligible(step, a):
            break
    return a


@compiled
def unknowns_behind_jump(sides: Array, q: LawUnknowns, a: LawUnknowns) -> LawUnknowns:
    """The unknowns b on the tip side of a jump, from the mean unknowns q and the unknowns a on the base side.
    sides: both sides, (2, 7), with the columns JUMP_SIDE_COLUMNS."""
    return LawUnknowns((q.q1 - sides[0, 3] * a.q1) / sides[1, 3], (q.q3 - sides[0, 4] * a.q3) / sides[1, 4])


@compiled
def stress_at_jump(law: int, sides: Array, q1: float, q3: float) -> StressMinusRestStress:
    """Stresses N and M at a jump, minus their values at rest, for the mean unknowns q1, q3. law: number of
    the constitutive law. sides: both sides, (2, 7), with the columns JUMP_SIDE_COLUMNS."""
    # The stress is equal on both sides, so one side suffices.
    a = unknowns_before_jump(law, sides, LawUnknowns(q1, q3))
    return stress_minus_rest_stress(law, _section_of_side(sides[0]), a.q1, a.q3)


@compiled
def _compliance_at_jump(law: int, sides: Array, a: LawUnknowns, b: LawUnknowns) -> TangentMatrix:
    """Derivatives of the mean unknowns q with respect to the stresses: (dq1/dN, dq1/dM, dq3/dN, dq3/dM). law:
    number of the constitutive law. a, b: unknowns on the base side and on the tip side. sides: both sides,
    (2, 7), with the columns JUMP_SIDE_COLUMNS."""
    S = stress_tangent(law, _section_of_side(sides[0]), a.q1, a.q3)
    T = stress_tangent(law, _section_of_side(sides[1]), b.q1, b.q3)
    # Compliances of the two sides add in the mean, stiffnesses do not, so both tangents are inverted.
    s = S.N1 * S.M3 - S.N3 * S.M1
    t = T.N1 * T.M3 - T.N3 * T.M1
    s1 = sides[0, 3] / s
    s3 = sides[0, 4] / s
    t1 = sides[1, 3] / t
    t3 = sides[1, 4] / t
    return TangentMatrix(
        s1 * S.M3 + t1 * T.M3, -s1 * S.N3 - t1 * T.N3, -s3 * S.M1 - t3 * T.M1, s3 * S.N1 + t3 * T.N1
    )


@compiled
def side_increments_at_jump(
    law: int, sides: Array, q: LawUnknowns, change: LawUnknowns
) -> tuple[LawUnknowns, LawUnknowns]:
    """Returns (increment of a, increment of b): increments of the unknowns on the base side and the tip side
    of a jump. law: number of the constitutive law. q: mean unknowns. change: infinitesimal increment of q.
    sides: both sides, (2, 7), with the columns JUMP_SIDE_COLUMNS."""
    a = unknowns_before_jump(law, sides, q)
    b = unknowns_behind_jump(sides, q, a)
    # First the common stress that the mean increment causes, then the increment of each side by its own law.
    stresses = _solve_tangent_system(_compliance_at_jump(law, sides, a, b), change.q1, change.q3)
    S = stress_tangent(law, _section_of_side(sides[0]), a.q1, a.q3)
    T = stress_tangent(law, _section_of_side(sides[1]), b.q1, b.q3)
    return _solve_tangent_system(S, stresses.q1, stresses.q3), _solve_tangent_system(
        T, stresses.q1, stresses.q3
    )


@compiled
def tangent_at_jump(law: int, sides: Array, q1: float, q3: float) -> TangentMatrix:
    """Derivatives of the stresses N and M at a jump with respect to the mean unknowns q1, q3. law: number of
    the constitutive law. sides: both sides, (2, 7), with the columns JUMP_SIDE_COLUMNS."""
    q = LawUnknowns(q1, q3)
    a = unknowns_before_jump(law, sides, q)
    Z = _compliance_at_jump(law, sides, a, unknowns_behind_jump(sides, q, a))
    determinant = Z.N1 * Z.M3 - Z.N3 * Z.M1
    return TangentMatrix(Z.M3 / determinant, -Z.N3 / determinant, -Z.M1 / determinant, Z.N1 / determinant)


@compiled
def stress_parameter_derivative_at_jump(
    law: int, sides: Array, change: Array, q1: float, q3: float
) -> StressMinusRestStress:
    """Derivatives of the stresses N and M at a jump with respect to a parameter, at fixed mean unknowns q1,
    q3.

    law: number of the constitutive law. sides: both sides, (2, 7), with the columns JUMP_SIDE_COLUMNS.
    change: derivatives of nu, c1 and c3 of both sides with respect to the parameter, (2, 3). The weights in
    the mean strain are constant, because a parameter multiplies the compliances of both sides by the same
    factor.
    """
    q = LawUnknowns(q1, q3)
    a = unknowns_before_jump(law, sides, q)
    b = unknowns_behind_jump(sides, q, a)
    q1_derivative = 0.0
    q3_derivative = 0.0
    for i in range(2):
        material = _section_of_side(sides[i])
        unknowns = a if i == 0 else b
        stress_derivative = stress_parameter_derivative(
            law, material, _section_of_side(change[i]), unknowns.q1, unknowns.q3
        )
        # At fixed stress this is minus the derivative of the unknowns of this side. The derivative of the
        # stress keeps the mean unknowns fixed.
        unknowns_derivative = _solve_tangent_system(
            stress_tangent(law, material, unknowns.q1, unknowns.q3), stress_derivative.N, stress_derivative.M
        )
        q1_derivative += sides[i, 3] * unknowns_derivative.q1
        q3_derivative += sides[i, 4] * unknowns_derivative.q3
    # The stress must change so that its effect on the mean cancels that of the parameter.
    out = _solve_tangent_system(_compliance_at_jump(law, sides, a, b), q1_derivative, q3_derivative)
    return StressMinusRestStress(out.q1, out.q3)
