"""Natural continuation of cycles along one parameter: a polynomial predicts the next cycle, Newton's method
corrects the prediction.

The polynomial interpolates normalised values and parameter derivatives of the last cycles. A step that is too
long for Newton's method is divided.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf

import numpy as np

from ...arrays import Array
from ...discretization.stress.form import StressForm
from ..continuation.curve import StepControl, StepResult, next_solution_and_step_length
from ..orbit.matrix.workspace import NewtonWorkspace
from ..orbit.newton import ConvergedOrbit, newton_step_if_matrix_distant, relative_change, solve_by_newton
from ..orbit.normalised_orbit import (
    extrapolated_change_weights,
    normalisation_arrays,
    normalised_orbit_values,
    predicted_normalised_values,
    tangent_of_normalised_orbit,
    values_from_normalised,
)
from ..orbit.orbit import Orbit
from ..orbit.orbit_mesh import OrbitMesh, mesh_of_orbit
from ..unsolvable import Unsolvable


@dataclass(frozen=True, slots=True, kw_only=True)
class CyclePredictionSettings:
    """Settings for the polynomial prediction of cycles along one parameter."""

    max_distance_from_prediction: float = 0.3
    """Largest relative distance of a cycle from its prediction; a cycle at a larger distance is rejected,
    because the cycle may lie on another branch."""
    max_distance_from_matrix_orbit: float = 1e-2
    """The tangent is computed from Newton's last matrix if the matrix was assembled at most at this relative
    distance from the solution; otherwise a new matrix is assembled."""
    max_earlier_orbits: int = 4
    """Maximum number of earlier orbits whose values enter the predicting polynomial."""
    min_orbits_replacing_second_tangent: int = 3
    """The tangent of the previous orbit enters the polynomial only if there are fewer earlier orbits than
    this; otherwise the tangent would make the prediction less accurate."""


CYCLE_PREDICTION_SETTINGS = CyclePredictionSettings()


PARAMETER_STEP_CONTROL = StepControl(
    first_length=0.5,
    max_length=1.0,
    min_length=2.0**-6,
    target_prediction_error=0.15,
    prediction_order=3,
    max_angle=inf,
    max_successive_length_ratio=3.0,
    max_solutions=100,
)
"""Control of the steps into which a parameter change is divided; a step length is a fraction of this change.
Newton's method needs two matrices for a prediction error of `target_prediction_error`. `max_prediction_error`
is infinite, because `orbit_near_prediction` already rejects cycles far from the prediction."""


@dataclass(frozen=True, eq=False)
class CyclePredictor:
    """Polynomial in one parameter that predicts orbits on the branch of the solved orbit `orbit`, by Hermite
    interpolation.

    values_and_derivatives: values of orbits as in `normalised_values`, or their parameter derivatives, (m, N
    + 1), N: number of orbit values; the first row is the derivative at the solved orbit. parameter_offsets:
    parameter coordinate of each row minus the parameter coordinate of the solved orbit, (m,).
    derivative_orders: 0 for values, 1 for a derivative, (m,).
    """

    orbit: Orbit
    parameter_offsets: Array
    derivative_orders: Array
    values_and_derivatives: Array

    @property
    def tangent_of_normalised_orbit(self) -> Array:
        """Parameter derivative of the normalised values at the solved orbit, (N + 1,)."""
        return self.values_and_derivatives[0]

    @cached_property
    def normalised_values(self) -> Array:
        """Values of the solved orbit, followed by its squared size, (N + 1,). Values that change sign under
        the reflection are divided by the size."""
        return normalised_orbit_values(self.orbit)

    def prediction_weights(self, step: float) -> Array:
        """Weights, (m,), of the rows of `values_and_derivatives` in the predicted change over a step of the
        parameter coordinate; see `extrapolated_change_weights`."""
        weights: Array = extrapolated_change_weights(self.parameter_offsets, self.derivative_orders, step)
        return weights

    def predicted_orbit(self, form: StressForm, name: str) -> Orbit:
        """The predicted orbit of the rod in `form`, on the mesh of the solved orbit; the mesh of `form` is
        ignored.

        name: the varied parameter. Raises Unsolvable if the predicted squared size of the orbit is
        not positive.
        """
        step = form.rod.coordinate(name) - self.orbit.form.rod.coordinate(name)
        values = predicted_normalised_values(
            self.normalised_values,
            self.values_and_derivatives,
            self.derivative_orders,
            self.prediction_weights(step),
        )
        # The last value, the squared size, goes linearly through 0 at a Hopf point, where cycles end.
        if not values[-1] > 0:
            raise Unsolvable("no cycle is predicted: the branch ends before this parameter value")
        target = replace(form, mesh=self.orbit.form.mesh)
        return replace(
            self.orbit, form=target, values=values_from_normalised(values, normalisation_arrays(self.orbit))
        )

    def on_mesh(self, target: OrbitMesh) -> "CyclePredictor":
        """This predictor with the solved orbit and all values and derivatives interpolated to the mesh
        `target`."""
        if target == mesh_of_orbit(self.orbit):
            return self
        rows = [
            np.append(interpolated_change(self.orbit, row[:-1], target), row[-1])
            for row in self.values_and_derivatives
        ]
        return replace(
            self, orbit=target.interpolated_orbit(self.orbit), values_and_derivatives=np.array(rows)
        )


def interpolated_change(orbit: Orbit, change: Array, target: OrbitMesh) -> Array:
    """The change `change` of the values of `orbit`, (N,), interpolated to the mesh `target` by a linear map,
    (N of the target,)."""
    return orbit.change_on_mesh(change, target.space_mesh, target.time_mesh)


def predictor_from(solved: ConvergedOrbit, previous: CyclePredictor | None, name: str) -> CyclePredictor:
    """The predictor at the orbit `solved`, which was solved with its tangent. previous: predictor at the
    previous orbit, or None; unused if its orbit has the same parameter value. name: the varied
    parameter. Raises ValueError if the orbit has no tangent.

    A tangent is as inaccurate as the prediction of its orbit; the values of an orbit are far more accurate.
    With CYCLE_PREDICTION_SETTINGS.min_orbits_replacing_second_tangent or more earlier orbits, a second
    tangent makes the prediction worse. Between two meshes, the values of an orbit differ more than the
    tangent, so only tangents are used after a change of mesh."""
    orbit = solved.orbit
    if solved.matrix.tangent is None:
        raise ValueError("the orbit was solved without its tangent")
    tangent = tangent_of_normalised_orbit(orbit, solved.matrix.tangent)
    step = orbit.form.rod.coordinate(name) - previous.orbit.form.rod.coordinate(name) if previous else 0.0
    if previous is None or step == 0:
        return CyclePredictor(orbit, np.zeros(1), np.ones(1), tangent[None])
    last_predictor = previous.on_mesh(mesh_of_orbit(orbit))
    # Earlier orbits have other meshes; only their tangents are interpolated to a new mesh.
    # `on_mesh` returns the predictor itself if the mesh is the same.
    if last_predictor is not previous:
        return CyclePredictor(
            orbit,
            np.array([0.0, -step]),
            np.ones(2),
            np.array([tangent, last_predictor.tangent_of_normalised_orbit]),
        )
    older_indices = np.flatnonzero(previous.derivative_orders == 0)[
        : CYCLE_PREDICTION_SETTINGS.max_earlier_orbits - 1
    ]
    offsets = [0.0, -step, *(previous.parameter_offsets[older_indices] - step)]
    # All offsets shift by the step, because the newest orbit has the offset 0.
    rows = [tangent, previous.normalised_values, *previous.values_and_derivatives[older_indices]]
    orders = [1.0] + [0.0] * (1 + len(older_indices))
    if 1 + len(older_indices) < CYCLE_PREDICTION_SETTINGS.min_orbits_replacing_second_tangent:
        offsets.append(-step)
        rows.append(previous.tangent_of_normalised_orbit)
        orders.append(1.0)
    return CyclePredictor(orbit, np.array(offsets), np.array(orders), np.array(rows))


def relative_parameter_difference(first: StressForm, second: StressForm, name: str) -> float:
    """|a - b|/max(|a|, |b|), where a and b are the coordinates (1/k for a stiffness k, else the value) of the
    parameter `name` for the rods in the forms `first` and `second`; 0 if a = b."""
    a = first.rod.coordinate(name)
    b = second.rod.coordinate(name)
    return abs(a - b) / max(abs(a), abs(b)) if a != b else 0.0


def orbit_near_prediction(
    predicted: Orbit, tolerance: float, workspace: NewtonWorkspace, name: str
) -> ConvergedOrbit:
    """The orbit near `predicted` with its tangent along the parameter `name`, by Newton's method to
    a relative tolerance; raises Unsolvable if the method does not converge, or if the orbit is farther from
    `predicted` than CYCLE_PREDICTION_SETTINGS.max_distance_from_prediction."""
    solved = solve_by_newton(predicted, tolerance, workspace, name)
    if _prediction_error(predicted, solved) > CYCLE_PREDICTION_SETTINGS.max_distance_from_prediction:
        raise Unsolvable("the cycle is too far from its prediction")
    return solved


def _prediction_error(predicted: Orbit, solved: ConvergedOrbit) -> float:
    """Relative distance of a solved orbit from its prediction `predicted`."""
    return relative_change(predicted, solved.orbit.values - predicted.values)


def orbit_followed_in_parameter_steps(
    start: CyclePredictor, form: StressForm, name: str, tolerance: float, workspace: NewtonWorkspace
) -> ConvergedOrbit:
    """The orbit of the rod in `form`, followed from the orbit of `start` in several steps of the parameter
    `name`; raises Unsolvable.

    tolerance: relative tolerance of Newton's method. workspace: memory of Newton's matrices.
    """
    first = start.orbit.form.rod.coordinate(name)
    last = form.rod.coordinate(name)
    fraction = 0.0
    length = PARAMETER_STEP_CONTROL.first_length
    predictor = start
    control = PARAMETER_STEP_CONTROL
    max_distance = CYCLE_PREDICTION_SETTINGS.max_distance_from_matrix_orbit

    def step(length: float) -> StepResult[ConvergedOrbit]:
        end_fraction = fraction + length
        # The last step ends exactly at the given rod, not at a rounded coordinate.
        form_at_end = (
            form if end_fraction >= 1.0 else form.with_coordinate(name, first + end_fraction * (last - first))
        )
        predicted = predictor.predicted_orbit(form_at_end, name)
        solved = orbit_near_prediction(predicted, tolerance, workspace, name)
        return StepResult(solved, _prediction_error(predicted, solved), 1.0)

    for _ in range(control.max_solutions):
        length = min(length, 1.0 - fraction)
        try:
            solved_orbit, length = next_solution_and_step_length(step, length, control)
        except Unsolvable as reason:
            raise Unsolvable(
                "the branch of cycles cannot be followed: it ends, has a fold, or needs shorter steps"
            ) from reason
        fraction += length
        if fraction >= 1.0:
            return solved_orbit.solution
        solved = newton_step_if_matrix_distant(solved_orbit.solution, max_distance, name)
        predictor = predictor_from(solved, predictor, name)
        length = control.next_length(length, solved_orbit, control.prediction_order)
    raise Unsolvable(f"the branch of cycles was not followed to its end in {control.max_solutions} steps")
