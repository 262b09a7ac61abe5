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
    """The distance between nodes is proportional to this power of the bending stiffness, because the
    wavelength in a compressed arm is proportional to the square root of the stiffness. Best exponents for the
    periods of cones of radius 0.3, 0.5 and 0.75 at the tip were 0.4, 0.5 and 0.6; for errors of 1e-8 an order
    of 18 suffices instead of 22 with equal spacing."""
    rounding_steps_of_ratio_per_unit: int = 64
    """Ratios are rounded to multiples of 1 over this number, so that neighbouring arms have equal meshes."""
    min_spacing_ratio: float = 0.125
    """Smallest ratio of the distances between nodes at the two ends of an element: the ratio for a cone whose
    tip has 0.35 of the radius of its base."""


NODE_SPACING_SETTINGS = NodeSpacingSettings()


def with_node_spacing_of_arm(orbit: Orbit) -> Orbit:
    """The orbit on elements of the same edges and orders, whose nodes are closer where the arm is softer; the
    orbit itself if its nodes already have this spacing."""
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
