"""Taylor coefficients of the constitutive law s(S) about S = 0, at the nodes of a mesh.

s1 = N(S1, S3) and s3 = M(S1, S3) of `rodsweep.model.material.response`; s2 = S2.
"""

from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...model.balance import Values
from ...model.material.laws import LINEAR, Law
from ...model.rod import Rod
from ..nodal_rod import NodalRod


@dataclass(frozen=True)
class ChangeWithForce:
    """Derivatives with respect to F of nu, (nodes + 1,), and of the tangent, (3, nodes + 1)."""

    nu: Array
    tangent: Array


@dataclass(frozen=True)
class LawAtRest:
    """Derivatives of s(S) at S = 0.

    nonlinear: False for the linear law, s(S) = S. tangent: diagonal of ds/dS, (3, nodes + 1). change:
    derivatives with respect to F. N11, N33, M13: second derivatives; N111, N133, M113: third derivatives,
    (nodes + 1,) each.
    """

    nonlinear: bool
    tangent: Array
    change: ChangeWithForce
    N11: Array
    N33: Array
    M13: Array
    N111: Array
    N133: Array
    M113: Array

    def second(self, S: Values, T: Values) -> Values:
        """The second derivative of s applied to S and T; all (3, ..., nodes + 1)."""
        out = np.zeros(np.broadcast(S, T).shape, np.result_type(S, T))
        out[0] = self.N11 * S[0] * T[0] + self.N33 * S[2] * T[2]
        out[2] = self.M13 * (S[0] * T[2] + S[2] * T[0])
        return out

    def third(self, S: Values, T: Values, R: Values) -> Values:
        """The third derivative of s applied to S, T and R; all (3, ..., nodes + 1)."""
        out = np.zeros(np.broadcast(S, T, R).shape, np.result_type(S, T, R))
        mixed = S[0] * T[2] * R[2] + S[2] * T[0] * R[2] + S[2] * T[2] * R[0]
        out[0] = self.N111 * S[0] * T[0] * R[0] + self.N133 * mixed
        out[2] = self.M113 * (S[2] * T[0] * R[0] + S[0] * T[2] * R[0] + S[0] * T[0] * R[2])
        return out


def law_at_rest(rod: Rod, nodal: NodalRod) -> LawAtRest:
    """The law of a rod at the nodes of a mesh."""
    law: Law = rod.build.constitutive_law
    nu = nodal.rest[0]
    c1, _, c3 = nodal.compliance
    stiffness = law.stiffness(nu)
    slope = law.stiffness_slope(nu)
    bending = law.bending(nu)
    bending_slope = law.bending_slope(nu)
    bending_curvature = law.bending_curvature(nu)
    moved = -c1 / stiffness
    ones = np.ones_like(nu)
    change = ChangeWithForce(moved, np.array([slope * moved, 0 * ones, bending_slope * moved]))
    return LawAtRest(
        nonlinear=law is not LINEAR,
        tangent=np.array([stiffness, ones, bending]),
        change=change,
        N11=slope * c1,
        N33=bending_slope * c3,
        M13=bending_slope * c1,
        N111=law.stiffness_curvature(nu) * c1**2,
        N133=bending_curvature * c1 * c3,
        M113=bending_curvature * c1**2,
    )
