"""Newton's method for a cycle with the parameter as a further unknown and one further equation.

Near a fold two cycles have the same parameter, so the parameter cannot be prescribed. The further equation
prescribes a linear combination of deflection, logarithm of the period, and parameter (`scale`). N is the
number of orbit values.
"""

from dataclasses import dataclass, replace

import numpy as np

from ....arrays import Array
from ....determinant.exponents import MACHINE_EPSILON
from ....discretization.stress.form import VELOCITY_ELIMINATION_SETTINGS, StressForm
from ....solve_progress import report
from ...orbit.matrix.workspace import NewtonWorkspace
from ...orbit.newton import ORBIT_NEWTON_SETTINGS, ConvergedOrbit, relative_change
from ...orbit.orbit import Orbit
from ...orbit.orbit_mesh import OrbitMesh
from ...unsolvable import Unsolvable
from .corrected_linearisation import LINEARISATION_CORRECTION_SETTINGS, corrected_linearisation
from .matrix import BorderedMatrix
from .scale import ArcLengthScale


@dataclass(frozen=True, eq=False)
class BorderCondition:
    """Equation that closes the bordered system of an orbit: `border` . `scale.components(orbit)` =
    `target_value`. border: row vector, (3,)."""

    scale: ArcLengthScale
    border: Array
    target_value: float

    @classmethod
    def at_arc_length(
        cls, scale: ArcLengthScale, border: Array, orbit: Orbit, length: float = 0.0
    ) -> "BorderCondition":
        """The condition that a new orbit lies farther along `border`, (3,), than the given `orbit`, by the
        arc length `length`. scale: units of the components."""
        return cls(scale, border, float(border @ scale.components(orbit)) + length)

    def residual(self, orbit: Orbit) -> float:
        """Residual of the condition at an orbit: `target_value` minus `border` .
        `scale.components(orbit)`."""
        return self.target_value - float(self.border @ self.scale.components(orbit))

    def solve_cycle(
        self,
        orbit: Orbit,
        tolerance: float,
        workspace: NewtonWorkspace,
        max_matrix_distance: float = np.inf,
        nearby: BorderedMatrix | None = None,
    ) -> ConvergedOrbit:
        """The cycle near `orbit` that fulfils the condition, by Newton's method; raises Unsolvable.

        tolerance: largest allowed relative error of the cycle. workspace: memory of Newton's matrices.
        max_matrix_distance: largest allowed relative error of multipliers and tangent. Estimates of this
        error: the distance of the cycle from the orbit at which the last matrix was assembled, or the error
        that remains after a correction. nearby: the last matrix of the workspace, assembled near `orbit`,
        with which the iteration begins, or None.
        """
        matrix = nearby or BorderedMatrix(orbit, self.scale, workspace)
        distance_from_matrix_orbit = matrix.relative_distance_to_orbit(orbit) if nearby else 0.0
        previous_change = np.inf
        step = self._newton_step(matrix, orbit)
        for _ in range(ORBIT_NEWTON_SETTINGS.max_iterations):
            report()
            change = self.require_small_relative_change(orbit, step)
            orbit = moved_orbit(orbit, self.scale.parameter_name, step)
            distance_from_matrix_orbit = distance_from_matrix_orbit + change
            # There is no rate at the first step with a matrix.
            is_first_step = previous_change == np.inf
            contraction = np.inf if is_first_step else change / previous_change
            # The next step would have the length change * rate; a negligible step is not made.
            is_contracting = contraction <= ORBIT_NEWTON_SETTINGS.max_step_ratio_with_old_matrix
            is_converged = change <= tolerance or (
                change * min(contraction, 1.0) <= tolerance and is_contracting
            )
            if is_converged:
                solved = self._with_accurate_linearisation(
                    orbit, matrix, distance_from_matrix_orbit, max_matrix_distance
                )
                if solved is not None:
                    return solved
            # Tangent and multipliers need a near matrix, so one step more follows even after convergence.
            if is_converged or not (is_first_step or is_contracting):
                matrix = BorderedMatrix(orbit, self.scale, workspace)
                distance_from_matrix_orbit = 0.0
                previous_change = np.inf
            else:
                previous_change = change
            step = self._newton_step(matrix, orbit)
        raise Unsolvable(
            f"Newton's method for the cycle does not converge: its last relative step is {change:.0e}"
        )

    def _newton_step(self, matrix: BorderedMatrix, orbit: Orbit) -> Array:
        """Newton's step at an orbit under this condition, (N + 1,), with `matrix`, assembled at this orbit or
        at a nearby orbit."""
        residual = self.residual(orbit)
        if matrix.orbit is orbit:
            return matrix.newton_step(self.border, residual)
        return matrix.newton_step_at_nearby_orbit(orbit, self.border, residual)

    def require_small_relative_change(self, orbit: Orbit, step: Array) -> float:
        """Relative change of orbit and parameter in Newton's step `step`, (N + 1,); raises Unsolvable if
        this change is too large."""
        change = max(relative_change(orbit, step[:-1]), abs(step[-1]) / self.scale.coordinate_unit)
        # Negated, so that a step of nan ends the search too.
        if not change <= ORBIT_NEWTON_SETTINGS.max_relative_step:
            raise Unsolvable("Newton's method for the cycle finds no cycle of the branch near the prediction")
        return change

    def _with_accurate_linearisation(
        self, orbit: Orbit, matrix: BorderedMatrix, distance: float, max_error: float
    ) -> ConvergedOrbit | None:
        """The solved `orbit` with tangent and multipliers of a relative error of at most `max_error`, either
        from `matrix` or corrected; None if the distance is too large for a correction, or if the corrections
        do not converge. distance: relative distance between the orbit and the orbit at which `matrix` was
        assembled."""
        if distance <= max_error:
            return ConvergedOrbit(orbit, matrix, distance)
        if distance > LINEARISATION_CORRECTION_SETTINGS.max_distance_from_matrix_orbit:
            return None
        corrected = corrected_linearisation(matrix, orbit, self.border, max_error)
        return None if corrected is None else ConvergedOrbit(orbit, corrected, corrected.relative_error)

    def solve_on_mesh(
        self, mesh: OrbitMesh, solved: ConvergedOrbit, tolerance: float, max_matrix_distance: float = np.inf
    ) -> ConvergedOrbit:
        """The cycle `solved` solved again on the mesh `mesh` under this condition; raises Unsolvable.
        tolerance: largest allowed relative error of the cycle. max_matrix_distance: largest allowed relative
        error of multipliers and tangent."""
        orbit = mesh.interpolated_orbit(solved.orbit)
        return self.solve_cycle(orbit, tolerance, solved.workspace, max_matrix_distance)


def require_equal_unknowns(form: StressForm, orbit: Orbit) -> None:
    """Raises Unsolvable if the states of `form` have other unknowns than the states of `orbit`, so that they
    cannot be compared."""
    if form.unknown_velocity_components != orbit.form.unknown_velocity_components:
        settings = VELOCITY_ELIMINATION_SETTINGS
        raise Unsolvable(
            "the solver changes its unknowns at a rotational drag of "
            f"{settings.min_eliminated_rotational_drag:.0e} gamma2 L^2 and at an axial drag of "
            f"{settings.min_eliminated_axial_drag:.0e} gamma2, and one of "
            "these values lies between the two cycles: choose a range on one side of it"
        )


def moved_orbit(orbit: Orbit, name: str, change: Array) -> Orbit:
    """An orbit plus a change, (N + 1,), of the orbit values and of the coordinate (1/k for a stiffness k) of
    the parameter `name`; raises Unsolvable if the new parameter value is not allowed, if Omega becomes an
    unknown or is eliminated at this value, or if the new period is not positive."""
    try:
        coordinate = orbit.form.rod.coordinate(name)
        new_coordinate = coordinate + float(change[-1])
        if new_coordinate < 0 < new_coordinate + MACHINE_EPSILON * abs(coordinate):  # 0 but for rounding
            new_coordinate = 0.0
        form = orbit.form.with_coordinate(name, new_coordinate)
    except (ValueError, ZeroDivisionError) as error:
        raise Unsolvable(f"the branch leaves the allowed range of the parameters: {error}") from error
    require_equal_unknowns(form, orbit)
    result = replace(orbit, form=form, values=orbit.values + change[:-1])
    if not result.period > 0:
        raise Unsolvable("Newton's method for the cycle diverges: the period is not positive")
    return result
