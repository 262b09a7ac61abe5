"""Derivatives of the constitutive law s(S) at S = 0, the straight rod, at the nodes of a mesh.

s1 = N(S1, S3) and s3 = M(S1, S3) of `rodsweep.model.material.stress_strain`, where S1 and S3 are called q1
and q3: the stresses of a linear rod with the same strain, minus their values at rest; s2 = S2. At a node
where the material jumps, N and M are the functions of the mean unknowns in `rodsweep.model.material.jump`.
"""

from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...model.balance import Values
from ...model.material.laws import LINEAR_CONSTITUTIVE_LAW, Law
from ...model.rod import Rod
from ..nodal_rod import NodalRod


@dataclass(frozen=True)
class DerivativesByForce:
    """Derivatives with respect to the force F at all nodes: of the stretch nu of the straight rod,
    (nodes + 1,), and of `LawDerivativesAtRest.law_tangent`, (3, nodes + 1)."""

    nu: Array
    law_tangent: Array


@dataclass(frozen=True)
class LawDerivativesAtRest:
    """Derivatives of the law s(S) at S = 0, at all nodes of a mesh.

    is_nonlinear: False for the linear law, s(S) = S. law_tangent: diagonal of ds/dS, (3, nodes + 1).
    derivatives_by_force: derivatives with respect to F. N11, N33, M13: second derivatives of N and M with
    respect to S1 and S3, (nodes + 1,). N111, N133, M113, M333: third derivatives, (nodes + 1,)."""

    is_nonlinear: bool
    law_tangent: Array
    derivatives_by_force: DerivativesByForce
    N11: Array
    N33: Array
    M13: Array
    N111: Array
    N133: Array
    M113: Array
    M333: Array

    def second_derivative_form(self, S: Values, T: Values) -> Values:
        """The second derivative of the law s(S) at S = 0, a bilinear form, applied to S and T; all (3, ...,
        nodes + 1)."""
        out = np.zeros(np.broadcast(S, T).shape, np.result_type(S, T))
        out[0] = self.N11 * S[0] * T[0] + self.N33 * S[2] * T[2]
        out[2] = self.M13 * (S[0] * T[2] + S[2] * T[0])
        return out

    def third_derivative_form(self, S: Values, T: Values, R: Values) -> Values:
        """The third derivative of the law s(S) at S = 0, a trilinear form, applied to S, T and R; all (3,
        ..., nodes + 1)."""
        out = np.zeros(np.broadcast(S, T, R).shape, np.result_type(S, T, R))
        mixed_sum = S[0] * T[2] * R[2] + S[2] * T[0] * R[2] + S[2] * T[2] * R[0]
        out[0] = self.N111 * S[0] * T[0] * R[0] + self.N133 * mixed_sum
        out[2] = self.M113 * (S[2] * T[0] * R[0] + S[0] * T[2] * R[0] + S[0] * T[0] * R[2])
        out[2] += self.M333 * S[2] * T[2] * R[2]
        return out


def law_derivatives_at_rest(rod: Rod, nodal: NodalRod) -> LawDerivativesAtRest:
    """Derivatives of a rod's constitutive law at rest, at the nodes of a mesh. nodal: the rod at the
    nodes."""
    law: Law = rod.material.constitutive_law
    nu = nodal.straight_state_strain[0]
    c1, _, c3 = nodal.compliance
    stiffness = law.stiffness(nu)
    slope = law.stiffness_slope(nu)
    bending = law.bending_factor(nu)
    bending_slope = law.bending_factor_slope(nu)
    bending_curvature = law.bending_factor_second_derivative(nu)
    # The force compresses the straight arm: d nu/dF = -c1/(dN/dS1).
    nu_derivative = -c1 / stiffness
    ones = np.ones_like(nu)
    derivatives_by_force = DerivativesByForce(
        nu_derivative, np.array([slope * nu_derivative, 0 * ones, bending_slope * nu_derivative])
    )
    derivatives = LawDerivativesAtRest(
        is_nonlinear=law is not LINEAR_CONSTITUTIVE_LAW,
        law_tangent=np.array([stiffness, ones, bending]),
        derivatives_by_force=derivatives_by_force,
        N11=slope * c1,
        N33=bending_slope * c3,
        M13=bending_slope * c1,
        N111=law.stiffness_second_derivative(nu) * c1**2,
        N133=bending_curvature * c1 * c3,
        M113=bending_curvature * c1**2,
        M333=0 * ones,
    )
    if derivatives.is_nonlinear and len(nodal.jump_nodes):
        _write_derivatives_at_jumps(derivatives, law, nodal)
    return derivatives


def _write_derivatives_at_jumps(derivatives: LawDerivativesAtRest, law: Law, nodal: NodalRod) -> None:
    """Writes the derivatives of the law at the nodes where the material jumps into `derivatives`. nodal: the
    rod at the nodes."""
    nodes = nodal.jump_nodes
    sides = nodal.jump_side_coefficients
    nu = sides[..., 0]
    c1 = sides[..., 1]
    means = sides[..., 5]
    fractions = np.moveaxis(sides[..., 3:5], -1, 0)
    T = np.array([law.stiffness(nu), law.bending_factor(nu)])
    slopes = np.array([law.stiffness_slope(nu), law.bending_factor_slope(nu)])
    first, second, third = law_derivatives_by_mean_stresses(law, sides)
    nu_derivative = -c1 / T[0]
    tangent = 1 / (fractions / T).sum(axis=-1)
    for component, (value, force_derivative) in enumerate(
        zip(tangent, tangent**2 * (fractions * slopes * nu_derivative / T**2).sum(axis=-1), strict=True)
    ):
        # Components 0 and 2 of the stress; the shear component 1 is linear in every law.
        derivatives.law_tangent[2 * component, nodes] = value
        derivatives.derivatives_by_force.law_tangent[2 * component, nodes] = force_derivative
    derivatives.derivatives_by_force.nu[nodes] = (means * nu_derivative).sum(axis=-1)
    derivatives.N11[nodes] = second[:, 0, 0, 0]
    derivatives.N33[nodes] = second[:, 0, 1, 1]
    derivatives.M13[nodes] = second[:, 1, 0, 1]
    derivatives.N111[nodes] = third[:, 0, 0, 0, 0]
    derivatives.N133[nodes] = third[:, 0, 0, 1, 1]
    derivatives.M113[nodes] = third[:, 1, 0, 0, 1]
    derivatives.M333[nodes] = third[:, 1, 1, 1, 1]


DerivativeTensors = tuple[Array, Array, Array]
"""First, second and third derivatives of two functions of two variables: (..., 2, 2), (..., 2, 2, 2),
(..., 2, 2, 2, 2). The first of the listed indices is the function; all further indices are variables."""


def law_derivatives_by_mean_stresses(law: Law, sides: Array) -> DerivativeTensors:
    """Derivatives of N and M at rest with respect to the weighted mean unknowns q1 and q3, at k jumps. sides:
    material on both sides of each jump, (k, 2, 7), with the columns of `rodsweep.model.material.jump`.

    The unknowns on both sides are functions of N and M, and so are the means q1 and q3. N(q1, q3) and
    M(q1, q3) are the inverse of (N, M) -> (q1, q3).
    """
    fractions = sides[..., 3:5]
    unknowns = inverse_function_derivatives(
        _derivatives_beside_jump(law, *np.moveaxis(sides[..., :3], -1, 0))
    )
    mean_derivatives = [np.einsum("ksa,ksa...->ka...", fractions, derivative) for derivative in unknowns]
    return inverse_function_derivatives((mean_derivatives[0], mean_derivatives[1], mean_derivatives[2]))


def _derivatives_beside_jump(law: Law, nu: Array, c1: Array, c3: Array) -> DerivativeTensors:
    """Derivatives of N and M at rest by q1 and q3 on each side of a jump; nu, c1, c3: of equal shape."""
    first, second, third = (np.zeros((*nu.shape, *(2,) * order)) for order in (2, 3, 4))
    first[..., 0, 0] = law.stiffness(nu)
    first[..., 1, 1] = law.bending_factor(nu)
    second[..., 0, 0, 0] = law.stiffness_slope(nu) * c1
    second[..., 0, 1, 1] = law.bending_factor_slope(nu) * c3
    second[..., 1, 0, 1] = second[..., 1, 1, 0] = law.bending_factor_slope(nu) * c1
    third[..., 0, 0, 0, 0] = law.stiffness_second_derivative(nu) * c1**2
    bending_curvature = law.bending_factor_second_derivative(nu)
    for indices in ((0, 1, 1), (1, 0, 1), (1, 1, 0)):
        third[(..., 0, *indices)] = bending_curvature * c1 * c3
    for indices in ((1, 0, 0), (0, 1, 0), (0, 0, 1)):
        third[(..., 1, *indices)] = bending_curvature * c1**2
    return first, second, third


def inverse_function_derivatives(derivatives: DerivativeTensors) -> DerivativeTensors:
    """Derivatives of the inverse function g of f, by differentiating f(g(y)) = y. derivatives: derivatives of
    f."""
    f1, f2, f3 = derivatives
    g1 = np.linalg.inv(f1)
    g2 = -np.einsum("...ai,...ijk,...jb,...kc->...abc", g1, f2, g1, g1)
    composed = np.einsum("...ijkl,...jb,...kc,...ld->...ibcd", f3, g1, g1, g1)
    # The second derivative of g is needed for each pair of the three directions.
    for axes in ("bcd", "bdc", "cdb"):
        pair = axes[:2]
        last = axes[2]
        composed = composed + np.einsum(f"...ijk,...j{pair},...k{last}->...ibcd", f2, g2, g1)
    return g1, g2, -np.einsum("...ai,...ibcd->...abcd", g1, composed)
