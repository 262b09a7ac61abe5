"""The task spectrum: the leading eigenvalues at every point."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..config.task.spectrum import SpectrumConfig
from ..discretization.elements.elements import Elements
from ..discretization.elements.quadrature import lobatto_points
from ..discretization.elements.resolution import mesh_accuracy
from ..discretization.straight.longitudinal_modes import (
    longitudinal_eigenvalues,
    longitudinal_eigenvalues_and_errors,
)
from ..errors import InputError
from ..model.material.laws import LINEAR_CONSTITUTIVE_LAW
from ..model.material.rod_material import RodMaterial
from ..model.rod import Crushed, Rod
from ..results.layouts.spectrum import (
    FOLLOWED_POINT_VARIABLES,
    MODE_VARIABLES,
    longitudinal_eigenvalue_variables,
    longitudinal_parameter_names,
)
from ..results.layouts.variables import FilledVariable, outcome_values
from ..sweep.cost_estimate import CostEstimate, followed_spectra_cost, spectra_cost, two_meshes_cost
from ..sweep.finest_initial_mesh import finest_initial_mesh, spectrum_mesh
from ..sweep.points.groups import GroupResult, PointGroups, groups_along_longest_axis
from .base_classes import ModesOfPointsTask
from .check_rows import point_count_text
from .protocol import CheckRow, MapInOrder, Solver, map_on_one_rank

if TYPE_CHECKING:
    from ..solve.spectrum.search import Spectrum, SpectrumRequest


@dataclass(frozen=True, slots=True)
class SpectrumTask(ModesOfPointsTask):
    """The task spectrum: the leading eigenvalues of the straight rod at every point."""

    config: SpectrumConfig
    """The config, with the section `spectrum`."""

    def __post_init__(self) -> None:
        if self.config.spectrum.longitudinal and np.isinf(self.points.columns_by_name["k1"]).any():
            raise InputError(
                "spectrum.longitudinal: true needs finite parameters.k1, because a rod with k1 = inf cannot "
                "stretch; remove inf from k1, or spectrum.longitudinal"
            )

    @property
    def _eigenvector_node_count(self) -> int:
        return self.config.spectrum.nodes if self.config.spectrum.vectors else 0

    @property
    def groups(self) -> PointGroups | None:
        """Groups of points along which eigenvalues are followed; None if eigenvalues are not followed."""
        if not self.config.follows_eigenvalues:
            return None
        return groups_along_longest_axis(self.points.shape, self.points.varied_parameter_by_axis)

    def coordinates(self) -> dict[str, np.ndarray]:
        """Material coordinates u of the nodes of eigenvectors, (nodes,), by name of the dimension; empty if
        no eigenvectors are requested."""
        return {"u": lobatto_points(self._eigenvector_node_count)} if self._eigenvector_node_count else {}

    def variables_from_config(self, in_order: MapInOrder = map_on_one_rank) -> tuple[FilledVariable, ...]:
        """Longitudinal growth rates, along the parameters on which these rates depend; for arms that are not
        uniform or not of linear material, also their relative errors. Empty if longitudinal modes are not
        requested."""
        gamma1 = self.config.parameters.constant_parameters.get("gamma1")
        if gamma1 is None:
            return ()
        dimensions, points_shape, columns = self._points_with_distinct_longitudinal_rates()
        mode_count = self.config.spectrum.modes
        is_closed_form = self.config.is_uniform_and_linear
        variables = longitudinal_eigenvalue_variables(gamma1, *dimensions, is_closed_form=is_closed_form)
        if is_closed_form:
            rates = [longitudinal_eigenvalues(float(k1), gamma1, mode_count) for k1 in columns["k1"]]
            return ((variables[0], np.reshape(rates, (*points_shape, mode_count))),)
        values = zip(*(column.tolist() for column in columns.values()), strict=True)
        rods = [dict(zip(columns, rod_values, strict=True)) | {"gamma1": gamma1} for rod_values in values]
        table = np.array(
            in_order(
                rods,
                lambda rod: longitudinal_rates_and_errors_of_arm(rod, self.config.rod_material, mode_count),
            )
        )
        return tuple(
            (variable, table[:, i].reshape(*points_shape, mode_count)) for i, variable in enumerate(variables)
        )

    def _points_with_distinct_longitudinal_rates(
        self,
    ) -> tuple[tuple[str, ...], tuple[int, ...], dict[str, np.ndarray]]:
        """Returns (dimensions, shape, columns) of the points at which longitudinal rates differ. dimensions:
        names of the dimensions of these points. shape: their lengths. columns: values of the parameters on
        which the rates depend, by name, flattened to (points,)."""
        points = self.points
        linear = self.config.rod_material.constitutive_law is LINEAR_CONSTITUTIVE_LAW
        parameter_names = longitudinal_parameter_names(self.config.is_uniform_and_linear, linear)
        names = [name for name in parameter_names if name in points.columns_by_name]
        columns = {name: points.columns_by_name[name] for name in names}
        if points.arm_axes or not points.is_grid:
            dimensions = tuple(points.arm_axes) or ("point",)
            return dimensions, points.shape, {name: column.ravel() for name, column in columns.items()}
        grid = np.meshgrid(*columns.values(), indexing="ij")
        return (
            tuple(names),
            grid[0].shape,
            dict(zip(names, (coordinate.ravel() for coordinate in grid), strict=True)),
        )

    def headline_of_check(self) -> str:
        return f"{point_count_text(self.points)}, {self.config.spectrum.modes} leading modes each"

    def rows_on_requested_results(self) -> list[CheckRow]:
        options = self.config.spectrum
        vectors_text = f"on {options.nodes} nodes" if options.vectors else "spectrum.vectors adds them"
        longitudinal_text = "they decouple; spectrum.longitudinal adds them"
        if options.longitudinal:
            is_closed_form = self.config.is_uniform_and_linear
            longitudinal_text = "closed form, no mesh" if is_closed_form else "on elements of their own"
        return [
            ("transverse modes", True, "task: spectrum"),
            ("longitudinal modes", options.longitudinal, longitudinal_text),
            ("eigenvectors", options.vectors, vectors_text),
        ]

    def finest_initial_mesh(self) -> Elements | None:
        options = self.config.spectrum
        accuracy = self.config.accuracy
        if options.vectors or options.method == "determinant":
            accuracy = mesh_accuracy(accuracy, options.vectors)
        return finest_initial_mesh(self.points, lambda rod: spectrum_mesh(rod, options.modes, accuracy))

    def has_certificate_and_reason(self) -> tuple[bool, str]:
        if self.config.spectrum.method == "determinant":
            return ModesOfPointsTask.has_certificate_and_reason(self)
        return False, f"spectrum.method: {self.config.spectrum.method}; {self.uncertified_risk}"

    def cost(self) -> CostEstimate:
        options = self.config.spectrum
        if options.method == "krylov_schur":
            return two_meshes_cost(self.points, options.modes, self.config.accuracy)
        accuracy = mesh_accuracy(self.config.accuracy, options.vectors)
        unfollowed = spectra_cost(self.points, options.modes, accuracy, self.config.certifies)
        if self.groups is None:
            return unfollowed
        return followed_spectra_cost(unfollowed, self.groups, self.points, options.modes)

    def solver(self) -> Solver:
        from ..solve.spectrum.krylov_schur_on_two_meshes import solve_on_two_meshes
        from ..solve.spectrum.path.neighbouring_rods import warm_up as warm_up_following
        from ..solve.spectrum.search import SpectrumRequest, solve_spectrum, warm_up
        from ..solve.spectrum.status import SpectrumStatus

        options = self.config.spectrum
        accuracy, certifies = self.config.accuracy, self.config.certifies
        request = SpectrumRequest(options.modes, accuracy, certifies, self._eigenvector_node_count)
        groups = self.groups
        solve = solve_spectrum if options.method == "determinant" else solve_on_two_meshes
        return Solver(
            possible_statuses=tuple(SpectrumStatus),
            warm_up=warm_up_following if groups else warm_up,
            solve=lambda index: solve(self.points.rod(index), request),
            file_values_of_outcome=lambda index, result: spectrum_values(result),
            groups_and_group_solver=(groups, lambda indices: self._solve_group(indices, request))
            if groups
            else None,
        )

    def _solve_group(self, indices: NDArray[np.int64], request: "SpectrumRequest") -> GroupResult:
        """Results for the points of a group to which eigenvalues are followed. indices: flat indices,
        (n,)."""
        from ..determinant.parameter_path import ParameterPath
        from ..solve.spectrum.path.neighbouring_rods import NeighbouringRods, follow_spectra

        groups = self.groups
        assert groups is not None
        followed_parameter = self.points.varied_parameter_by_axis[groups.axis]
        path = ParameterPath(self.points.rod(int(indices[0])), followed_parameter)
        rods = NeighbouringRods(path, self.points.parameter_values_of_points(indices)[followed_parameter])
        followed = follow_spectra(rods, request)
        return GroupResult(spectrum_values(followed.spectra), followed.is_solved)


def longitudinal_rates_and_errors_of_arm(
    values: dict[str, float], material: RodMaterial, mode_count: int
) -> np.ndarray:
    """(longitudinal growth rates in 1/tau2, relative errors) of an arm, (2, modes); NaN for a crushed arm.
    values: parameters of the arm by name; without a value F and gamma3 are 0 and k2 is inf."""
    try:
        rod = Rod(**{"F": 0.0, "k2": np.inf, "gamma3": 0.0} | values, material=material)
    except Crushed:
        return np.full((2, mode_count), np.nan)
    return np.array(longitudinal_eigenvalues_and_errors(rod, mode_count))


def spectrum_values(result: "Spectrum") -> dict[str, Any]:
    """Variables of the file for the spectrum of a point, or for the spectra of points that are solved
    together."""
    values = outcome_values(MODE_VARIABLES + FOLLOWED_POINT_VARIABLES, result)
    if result.vectors is not None:
        for field_name, component in zip(("Y", "Theta"), result.vectors, strict=True):
            values[f"{field_name}_real"] = component.real
            values[f"{field_name}_imag"] = component.imag
    return values
