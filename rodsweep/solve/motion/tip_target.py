"""The rod bent until its tip is at a given point (x, y): a start of a motion chosen by the user.

Of all curvatures Pi for which the tip is at (x, y), the bent rod has the curvature with the smallest integral
of Pi^2. A rod of constant bending stiffness under a force at the tip, without moment, has this shape (an
elastica). Stretch and shear are as in the straight rod under its follower force. Pi vanishes at the tip, so
the state satisfies the boundary conditions there. Newton's method solves for the curvatures and the force f,
with W the weights of the quadrature,

    W Pi - f . d(x, y)/dPi = 0,    (x, y)(Pi) = target,

for targets along a path that starts at the tip of a slightly bent rod.
"""

from dataclasses import dataclass
from math import atan2, hypot

import numpy as np

from ...arrays import Array
from ...discretization.elements.mesh import shape_from_strains
from ...discretization.explicit_system import ExplicitSystem


@dataclass(frozen=True, slots=True, kw_only=True)
class TipTargetSettings:
    """Settings of the rod that is bent until its tip is at a given point."""

    max_clamp_distance_over_length: float = 0.98
    """Largest distance of the tip from the clamp, divided by the straight length: at 1 the rod cannot be
    bent."""
    start_tip_angle: float = 0.8
    """Angle theta of the tip, in rad, at the start of the path of targets; not 0, because the tip of a
    straight rod cannot move towards the clamp."""
    first_target_step_fraction: float = 0.1
    """First step of the target, as a fraction of the path of targets."""
    min_target_step_fraction: float = 1e-3
    """If a step of the target, as a fraction of the path, is at most this, the search ends at the last target
    reached."""
    max_newton_iterations: int = 12
    """Maximum number of Newton iterations for one target."""
    target_tolerance: float = 1e-10
    """Tolerance of Newton's method: larger component of the vector from the tip to its target, in L."""
    max_rotation_per_newton_step: float = 1.0
    """Newton's method fails if a step turns theta by more than this, in rad: such a step may lead to another
    shape."""


TIP_TARGET_SETTINGS = TipTargetSettings()


def bent_state_with_tip_at(system: ExplicitSystem, x: float, y: float) -> Array:
    """The state z, (unknowns,), of the rod bent until the tip is at (x, y), in L. A target beyond
    `TipTargetSettings.max_clamp_distance_over_length` is moved towards the clamp. If Newton's method fails on
    the path of targets, the state for the last target reached is returned."""
    bending = _BentRod(system)
    sign_of_y = -1.0 if y < 0 else 1.0
    # The curvature falls to 0 at the free tip, as under a force at the tip; its integral is the angle.
    Pi: Array = 2 * sign_of_y * TIP_TARGET_SETTINGS.start_tip_angle * (1 - system.mesh.node_positions)
    first_tip = bending.tip_position(Pi)
    start_radius_and_angle = np.array([hypot(*first_tip), atan2(first_tip[1], first_tip[0])])
    # At a distance equal to its length the rod would be straight, and the force not determined.
    end_radius_and_angle = np.array(
        [min(hypot(x, y), TIP_TARGET_SETTINGS.max_clamp_distance_over_length * bending.length), atan2(y, x)]
    )
    force: Array = np.zeros(2)
    solved_fraction = 0.0
    fraction_step = TIP_TARGET_SETTINGS.first_target_step_fraction
    while solved_fraction < 1 and fraction_step > TIP_TARGET_SETTINGS.min_target_step_fraction:
        fraction = min(1.0, solved_fraction + fraction_step)
        # In polar coordinates the path of targets does not pass through the clamp.
        radius, angle = start_radius_and_angle + fraction * (end_radius_and_angle - start_radius_and_angle)
        solution = bending.newton_to_target(Pi, force, radius * np.array([np.cos(angle), np.sin(angle)]))
        if solution is None:
            fraction_step /= 2
        else:
            solved_fraction = fraction
            (Pi, force) = solution
    return bending.state(Pi)


class _BentRod:
    """Bending of a rod with fixed stretch and shear: position of the tip as a function of the curvatures Pi
    at the nodes. length: length of the straight rod, in L."""

    def __init__(self, system: ExplicitSystem) -> None:
        self.mesh = system.mesh
        self._straight_system = system
        self.h1, self.h2 = system.strains(np.zeros(system.unknown_count))[:2]
        size = system.mesh.node_count + 1
        self.length = float(self.h1 @ system.mesh.quadrature_weights)
        unit = np.zeros((3, size, self.mesh.element_node_indices.size))
        unit[2] = np.eye(size)[:, self.mesh.element_node_indices]
        self.angle_matrix = shape_from_strains(system.mesh, unit, np.zeros(3))[2].T
        """Matrix from the curvatures Pi to the angles theta, both at all nodes, (nodes + 1, nodes + 1); at a
        jump of the material Pi is the mean of both sides."""

    def tip_position(self, Pi: Array) -> Array:
        """Position (x, y) of the tip, (2,), for curvatures Pi at all nodes, (nodes + 1,)."""
        end: Array = self._straight_system.tip_coordinates(self.state(Pi))[:2]
        return end

    def state(self, Pi: Array) -> Array:
        """The state z, (unknowns,), for curvatures Pi at all nodes, (nodes + 1,)."""
        return self._straight_system.state_of_strains(np.stack([self.h1, self.h2, Pi]))

    def newton_to_target(self, Pi: Array, force: Array, target: Array) -> tuple[Array, Array] | None:
        """Returns (Pi, force), (nodes + 1,) and (2,): the curvatures and the force for which the tip is at
        the point `target`, (2,), by Newton's method from `Pi` and `force`; None if Newton's method fails."""
        size = len(Pi)
        weights = self.mesh.quadrature_weights
        matrix = np.zeros((size + 2, size + 2))
        for _ in range(TIP_TARGET_SETTINGS.max_newton_iterations):
            tip_derivative, second_derivative = self._tip_jacobian_and_weighted_hessian(Pi, force)
            # Bending energy minus the work of the force, with the tip's position as two constraints.
            matrix[:size, :size] = np.diag(weights) - second_derivative
            matrix[:size, size:] = -tip_derivative.T
            matrix[size:, :size] = tip_derivative
            tip_error = target - self.tip_position(Pi)
            change = np.linalg.solve(matrix, np.append(tip_derivative.T @ force - weights * Pi, tip_error))
            # A step that turns the rod by a radian is outside the range of the linearisation.
            if (
                not np.abs(self.angle_matrix @ change[:size]).max()
                < TIP_TARGET_SETTINGS.max_rotation_per_newton_step
            ):
                return None
            Pi = Pi + change[:size]
            force = force + change[size:]
            if np.abs(tip_error).max() < TIP_TARGET_SETTINGS.target_tolerance:
                return Pi, force
        return None

    def _tip_jacobian_and_weighted_hessian(self, Pi: Array, force: Array) -> tuple[Array, Array]:
        """Returns (d(x, y)/dPi, d^2(f . (x, y))/dPi^2), (2, nodes + 1) and (nodes + 1, nodes + 1), by
        quadrature. (x, y): the tip. Pi: curvatures at all nodes, (nodes + 1,). force: f, (2,)."""
        A = self.angle_matrix
        w = self.mesh.quadrature_weights
        c = np.cos(A @ Pi)
        s = np.sin(A @ Pi)
        tangent = np.array([c * self.h1 - s * self.h2, s * self.h1 + c * self.h2])
        normal = np.array([-tangent[1], tangent[0]])
        return (w * normal) @ A, -A.T @ ((w * (force @ tangent))[:, None] * A)
