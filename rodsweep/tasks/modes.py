"""The task modes: leading modes with their adjoint modes, and transient growth of the non-normal operator."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..config.task.modes import ModesConfig
from ..discretization.elements.elements import Elements
from ..discretization.elements.quadrature import lobatto_points
from ..discretization.elements.resolution import mesh_accuracy
from ..model.rod import Rod
from ..results.layouts.modes import GROWTH_VARIABLES, MODE_SCALAR_VARIABLES
from ..results.layouts.spectrum import MODE_VARIABLES, POINT_VARIABLES
from ..results.layouts.variables import outcome_values
from ..sweep.cost_estimate import CostEstimate, modes_cost, spectra_cost
from ..sweep.finest_initial_mesh import finest_initial_mesh, spectrum_mesh
from .base_classes import ModesOfPointsTask
from .check_rows import point_count_text
from .protocol import CheckRow, Solver

if TYPE_CHECKING:
    from ..solve.modes.leading_modes import Modes


@dataclass(frozen=True, slots=True)
class ModesTask(ModesOfPointsTask):
    """The task modes: leading modes and transient growth at every point."""

    config: ModesConfig
    """The config, with the section `modes`."""

    def coordinates(self) -> dict[str, np.ndarray]:
        """Material coordinates u of the nodes at which modes are stored, (nodes,), by name of the
        dimension."""
        return {"u": lobatto_points(self.config.modes.nodes)}

    def headline_of_check(self) -> str:
        options = self.config.modes
        return (
            f"{point_count_text(self.points)}, {options.modes} leading modes each, on {options.nodes} nodes"
        )

    def rows_on_requested_results(self) -> list[CheckRow]:
        growth = self.config.modes.growth
        norm_text = "in the norm of the dissipation" if growth else "modes.growth: false"
        return [
            ("transverse modes and their adjoints", True, "task: modes"),
            ("transient growth, numerical abscissa", growth, norm_text),
            ("longitudinal modes", False, "they decouple; the task spectrum has them"),
        ]

    def finest_initial_mesh(self) -> Elements | None:
        accuracy = mesh_accuracy(self.config.accuracy, needs_vectors=False)
        mode_count = self.config.modes.modes
        return finest_initial_mesh(self.points, lambda rod: spectrum_mesh(rod, mode_count, accuracy))

    def cost(self) -> CostEstimate:
        options = self.config.modes
        accuracy = mesh_accuracy(self.config.accuracy, needs_vectors=False)
        spectra_estimate = spectra_cost(self.points, options.modes, accuracy, options.certify)
        return modes_cost(spectra_estimate, self.points, options.modes, options.growth)

    def solver(self) -> Solver:
        from ..solve.modes.leading_modes import ModesRequest, solve_modes
        from ..solve.spectrum.status import SpectrumStatus

        options = self.config.modes
        requested_numbers = options.modes, self.config.accuracy, options.nodes
        request = ModesRequest(*requested_numbers, options.growth, options.certify)
        warm_up_request = ModesRequest(2, 1e-4, 9, options.growth, True)
        return Solver(
            possible_statuses=tuple(SpectrumStatus),
            warm_up=lambda: solve_modes(Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4), warm_up_request),
            solve=lambda index: solve_modes(self.points.rod(index), request),
            file_values_of_outcome=lambda index, result: mode_values(result, options.growth),
        )


def mode_values(result: "Modes", growth: bool) -> dict[str, Any]:
    """Variables of the file for the modes of one rod; growth: whether transient growth was computed."""
    vectors = result.mode_vectors
    attribute_names = {"elements": "element_count"}
    sources = vectors.resolution, result, result.spectrum
    values = outcome_values(MODE_VARIABLES + POINT_VARIABLES, *sources, names=attribute_names)
    values |= outcome_values(MODE_SCALAR_VARIABLES, vectors)
    field_names = ("Y", "Theta", "h2", "Pi", "adjoint_Y", "adjoint_Theta")
    fields = (*vectors.right_modes, *vectors.mode_strains, *vectors.left_modes)
    for name, mode_field in zip(field_names, fields, strict=True):
        values[f"{name}_real"] = mode_field.real
        values[f"{name}_imag"] = mode_field.imag
    if growth:
        values |= outcome_values(GROWTH_VARIABLES, result.growth)
    return values
