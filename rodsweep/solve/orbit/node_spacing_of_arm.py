"""Spacing of the nodes of an orbit's mesh for an arm whose stiffness varies along its elements."""

from dataclasses import dataclass, replace

import numpy as np

from ...discretization.elements.elements import ELEMENT_SETTINGS
from .orbit import Orbit
from .orbit_mesh import mesh_of_orbit


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeSpacingSettings:
    """Settings for the spacing of nodes within elements."""

    stiffness_exponent_of_spacing: float = 0.5
    """Exponent of the bending stiffness to which the distance of nodes is proportional: waves of a compressed
    arm are as long as the root of its stiffness. Best exponents for the periods of cones of radius 0.3, 0.5
    and 0.75 at the tip were 0.4, 0.5 and 0.6; errors of 1e-8 need 4 orders of 22 less than with equal
    spacing."""
    rounding_steps_of_ratio_per_unit: int = 64
    """Ratios are rounded to multiples of 1 over this number, so that neighbouring arms have equal meshes."""
    min_spacing_ratio: float = 0.125
    """Smallest ratio of the distances of nodes at both ends of an element, that of a cone with 0.35 of the
    radius at the tip."""


NODE_SPACING_SETTINGS = NodeSpacingSettings()


def with_node_spacing_of_arm(orbit: Orbit) -> Orbit:
    """The orbit on elements of the same edges and orders, whose nodes are closer where the arm is softer; the
    orbit itself if the stiffness does not vary along an element."""
    mesh = mesh_of_orbit(orbit)
    rod = orbit.form.rod
    offset = ELEMENT_SETTINGS.one_sided_node_offset
    edges = np.array(mesh.element_edges)
    ends = np.stack([edges[:-1] + offset, edges[1:] - offset])
    compliance = rod.material.relative_compliances(rod.taper, ends.ravel())[2].reshape(ends.shape)
    settings = NODE_SPACING_SETTINGS
    ratios = (compliance[0] / compliance[1]) ** settings.stiffness_exponent_of_spacing
    ratios = np.clip(ratios, settings.min_spacing_ratio, 1 / settings.min_spacing_ratio)
    ratios = (
        np.round(settings.rounding_steps_of_ratio_per_unit * ratios)
        / settings.rounding_steps_of_ratio_per_unit
    )
    spacing_ratios = () if (ratios == 1).all() else tuple(ratios.tolist())
    if spacing_ratios == mesh.spacing_ratios:
        return orbit
    return replace(mesh, spacing_ratios=spacing_ratios).interpolated_orbit(orbit)
