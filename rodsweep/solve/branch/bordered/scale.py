"""Three dimensionless components that define arc length on a branch: deflection, logarithm of the period,
parameter.

The components have the same meaning on every mesh: the deflection at t = 0, divided by about the largest
deflection of the cycle; the logarithm of the period; the parameter coordinate (1/k for a stiffness k),
divided by its modulus, but at least by a fraction of the range of the branch, so that steps reach the
coordinate 0. Both divisors belong to one cycle, for which an `ArcLengthScale` is made. At a Hopf point the
deflection passes linearly through 0, so that arc length stays regular.

The deflection is the integral of (1 - s) c m3 over the rod, which is linear in the state; s is the position
on the rod and c the bending compliance of the arm's profile. For small cycles of a rod without taper the
deflection is the tip's y. Without c the integral would depend on the mesh: m3, the moment of a linear rod
with the same strain, is discontinuous at a material jump, where a mesh has only the mean strain. The moment
at a fixed position on the rod is not used, because it may vanish on large cycles; steps along a branch would
become short there.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ....arrays import Array
from ....discretization.coefficients_on_mesh import relative_bending_compliance_at_nodes
from ....discretization.elements.elements import ELEMENT_SETTINGS
from ....discretization.elements.mesh import Mesh
from ....discretization.state_layout import StateLayout
from ....model.material.rod_material import RodMaterial
from ...orbit.orbit import Orbit

PARAMETER_DIRECTION = np.array([0.0, 0.0, 1.0])
"""Unit vector along the parameter, (3,), in components (deflection, log period, parameter)."""


@dataclass(frozen=True, slots=True)
class ArcLengthScale:
    """Units of arc length on a branch at one cycle. deflection_unit: unit of the deflection, in L, at least
    `min_deflection_unit`. coordinate_unit: unit of the coordinate (1/k for a stiffness k) of the continuation
    parameter `parameter_name`, at least `min_coordinate_unit`."""

    parameter_name: str
    deflection_unit: float
    coordinate_unit: float
    min_deflection_unit: float
    min_coordinate_unit: float = 0.0

    @classmethod
    def at_orbit(
        cls, orbit: Orbit, name: str, min_deflection_unit: float, min_coordinate_unit: float = 0.0
    ) -> "ArcLengthScale":
        """The scale of an orbit. Unit of the deflection: sqrt(d^2 + min_deflection_unit^2), d: largest
        deflection over the orbit. Unit of the parameter coordinate: the larger of `min_coordinate_unit` and
        its modulus. name: continuation parameter. min_deflection_unit: smallest unit of the deflection, in L.
        min_coordinate_unit: smallest unit of the parameter coordinate."""
        max_deflection = float(np.abs(orbit.all_states @ deflection_functional(orbit)).max())
        # `min_deflection_unit` keeps the unit positive near a Hopf point, where the deflection vanishes.
        return cls(
            name,
            float(np.hypot(max_deflection, min_deflection_unit)),
            max(abs(orbit.form.rod.coordinate(name)), min_coordinate_unit),
            min_deflection_unit,
            min_coordinate_unit,
        )

    def components(self, orbit: Orbit) -> Array:
        """(deflection at t = 0, logarithm of the period, parameter coordinate) of an orbit, (3,), in units of
        the scale."""
        deflection = deflection_at_time_zero(orbit) / self.deflection_unit
        coordinate = orbit.form.rod.coordinate(self.parameter_name) / self.coordinate_unit
        return np.array([deflection, np.log(orbit.period), coordinate])

    def directional_derivative(self, orbit: Orbit, change: Array) -> Array:
        """Derivative of `components` at an orbit, (3,), along the variation `change` of orbit values and
        parameter coordinate, (N + 1,)."""
        deflection = (
            float(deflection_functional(orbit) @ change[: orbit.form.unknown_count]) / self.deflection_unit
        )
        return np.array([deflection, change[-2] / orbit.period, change[-1] / self.coordinate_unit])


def deflection_at_time_zero(orbit: Orbit) -> float:
    """Deflection of an orbit in L at t = 0, when the tip's y is largest; linear in the state."""
    return float(deflection_functional(orbit) @ orbit.start_state)


def deflection_functional(orbit: Orbit) -> Array:
    """The linear functional, (n,), whose product with a state of the orbit is the state's deflection in L."""
    form = orbit.form
    return _cached_deflection_functional(form.layout, form.mesh, form.rod.material)


@lru_cache(maxsize=ELEMENT_SETTINGS.max_cached_meshes)
def _cached_deflection_functional(layout: StateLayout, mesh: Mesh, material: RodMaterial) -> Array:
    """Cached `deflection_functional`, (n,); callers share the array and must not change it."""
    # In linear theory the curvature at u moves the tip by the lever 1 - u, which is 0 at the tip.
    weights = mesh.quadrature_weights * relative_bending_compliance_at_nodes(material, mesh)
    return layout.state_with_stresses({"m3": weights[:-1] * (1 - mesh.node_positions[:-1])})
