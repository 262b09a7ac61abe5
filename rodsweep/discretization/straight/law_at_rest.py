"""Derivatives of a constitutive law at rest, at the nodes of a mesh: s(S) of the mixed form about S = 0.

s1 = N(S1, S3) and s3 = M(S1, S3) of `rodsweep.model.material.response`, and s2 = S2.
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
    """Derivatives by F of nu, (nodes + 1,), and of the tangent, (3, nodes + 1)."""

    nu: Array
    tangent: Array


@dataclass(frozen=True)
class LawAtRest:
    """The law about the straight rod.

    nonlinear: whether there are terms beyond the first. tangent: the diagonal of ds/dS, (3, nodes + 1).
    N11, N33, M13: second derivatives; N111, N133, M113: third derivatives, (nodes + 1,) each.
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
        """The second derivative of s applied to S and T, (3, ..., nodes + 1) all."""
        out = np.zeros(np.broadcast(S, T).shape, np.result_type(S, T))
        out[0] = self.N11 * S[0] * T[0] + self.N33 * S[2] * T[2]
        out[2] = self.M13 * (S[0] * T[2] + S[2] * T[0])
        return out

    def third(self, S: Values, T: Values, R: Values) -> Values:
        """The third derivative of s applied to S, T and R, (3, ..., nodes + 1) all."""
        out = np.zeros(np.broadcast(S, T, R).shape, np.result_type(S, T, R))
        mixed = S[0] * T[2] * R[2] + S[2] * T[0] * R[2] + S[2] * T[2] * R[0]
        out[0] = self.N111 * S[0] * T[0] * R[0] + self.N133 * mixed
        out[2] = self.M113 * (S[2] * T[0] * R[0] + S[0] * T[2] * R[0] + S[0] * T[0] * R[2])
        return out


def law_at_rest(rod: Rod, nodal: NodalRod) -> LawAtRest:
    """The law of a rod at the nodes of a mesh."""
    law: Law = rod.build.constitutive_law
    nu, (c1, _, c3) = nodal.rest[0], nodal.compliance
    stiffness, slope = law.stiffness(nu), law.stiffness_slope(nu)
    bending, bending_slope, bending_curvature = (
        f(nu) for f in (law.bending, law.bending_slope, law.bending_curvature)
    )
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
