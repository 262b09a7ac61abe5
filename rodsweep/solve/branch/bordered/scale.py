"""The three numbers in which branches are measured: deflection, log of the period, parameter.

These numbers mean the same on every mesh: the deflection at t = 0, in units of about its largest value over
the cycle; the logarithm of the period; the parameter's scaled coordinate. Arc length is measured in these
numbers; at a Hopf point the deflection passes through 0 and keeps arc length regular.

The deflection is the integral of (1 - s) c m3 over the rod, which is linear in the state; c is the bending
compliance of the arm's profile. For small cycles of a rod without taper it is the tip's y. Without c it would
depend on the mesh: at a jump of rubber m3, the moment of a linear rod with the same strain, differs between
both sides, and a mesh has only the mean strain. A moment at one place of the rod may vanish on large cycles,
as the clamp's does, and steps along a branch would become short there.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ....arrays import Array
from ....discretization.arm_on_mesh import profile_compliance_on
from ....discretization.elements.elements import ELEMENTS
from ....discretization.elements.mesh import Mesh
from ....discretization.state_layout import StateLayout
from ....model.material.build import Build
from ...orbit.orbit import Orbit


@dataclass(frozen=True, slots=True)
class Scale:
    """Units of the deflection (at least `least`) and of the parameter's coordinate; name of the parameter."""

    name: str
    deflection: float
    coordinate: float
    least: float

    @classmethod
    def of(cls, orbit: Orbit, name: str, least: float) -> "Scale":
        """The scale at an orbit."""
        largest = float(np.abs(orbit.points @ deflection_row(orbit)).max())
        # The least unit keeps the scale finite beside a Hopf point, where the deflection vanishes.
        return cls(name, float(np.hypot(largest, least)), abs(orbit.form.rod.coordinate(name)), least)

    def place(self, orbit: Orbit) -> Array:
        """(deflection, log of the period, coordinate) in units of the scale, (3,)."""
        deflection = deflection_of(orbit) / self.deflection
        at = orbit.form.rod.coordinate(self.name) / self.coordinate
        return np.array([deflection, np.log(orbit.period), at])

    def moved(self, orbit: Orbit, change: Array) -> Array:
        """Change of `place`, (3,), for a change of an orbit and the coordinate, (N + 1,)."""
        deflection = float(deflection_row(orbit) @ change[: orbit.form.unknowns]) / self.deflection
        return np.array([deflection, change[-2] / orbit.period, change[-1] / self.coordinate])


def deflection_of(orbit: Orbit) -> float:
    """Deflection at t = 0, when the tip's y is largest."""
    return float(deflection_row(orbit) @ orbit.start)


def deflection_row(orbit: Orbit) -> Array:
    """Row that gives the deflection of a state, (n,)."""
    form = orbit.form
    return _deflection_row(form.layout, form.mesh, form.rod.build)


@lru_cache(maxsize=ELEMENTS.max_meshes)
def _deflection_row(layout: StateLayout, mesh: Mesh, build: Build) -> Array:
    """`deflection_row`, (n,), shared by all callers and not to be changed."""
    # Small deflection at the tip: the curvature at u acts with the lever 1 - u. Tip values drop out.
    weights = mesh.quadrature * profile_compliance_on(build, mesh)
    return layout.vector({"m3": weights[:-1] * (1 - mesh.positions[:-1])})
