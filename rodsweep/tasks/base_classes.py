"""Base classes of tasks: `CertifiedTask` of tasks with a certificate, `ModesOfPointsTask` of tasks on modes,
`HopfPointTask` of tasks on cycles."""

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..discretization.elements.elements import Elements
from ..discretization.elements.resolution import mesh_accuracy
from ..model.rod import Rod
from ..results.layouts.variables import FilledVariable
from ..solve.changes.spectrum_samples import SPECTRUM_SAMPLE_SETTINGS
from ..sweep.finest_initial_mesh import finest_initial_mesh, spectrum_mesh
from .check_rows import arms_line, stretch_shear_and_drag_rows, varying_arm_and_law_rows
from .hopf.thresholds_along_force import force_threshold_variables
from .protocol import CheckRow, Task


@dataclass(frozen=True, slots=True)
class CertifiedTask(Task):
    """Base class of tasks with a certificate, which proves that the list of modes or crossings is
    complete."""

    uncertified_risk: ClassVar[str]
    """Consequence of a missing certificate, as `check` prints it."""
    modes_counted_per: ClassVar[str] = ""
    """Rods at which the certificate counts modes: "point" for every point, "line" for some rods on each line
    of points along F."""
    never_modelled_effects: ClassVar[tuple[str, str]] = (
        "gravity, inertia, nonlinear motion",
        "not part of the linear overdamped problem",
    )
    """(effects that the task never models, reason), as `check` prints them."""

    @abstractmethod
    def rows_on_requested_results(self) -> list[CheckRow]:
        """Rows of `check` on the results that the task's options request."""

    @property
    def parameter_values_with_searches(self) -> dict[str, np.ndarray]:
        """Values of each parameter at points, at the ends of searched ranges, and among the task's
        coordinates, by name of the parameter or coordinate, in arrays of any shape."""
        return self.points.parameter_values_of_rods | self.searched_range_ends() | self.coordinates()

    def arms_line(self) -> str:
        return arms_line(self.config, self.parameter_values_with_searches, self.finest_initial_mesh)

    def finest_initial_mesh(self) -> Elements | None:
        """The finest of the initial meshes of all points; None if the rod model applies to no point.

        By default the mesh of a search, along the parameter in `searched_range_ends`, for eigenvalues on the
        imaginary axis.
        """
        accuracy = mesh_accuracy(SPECTRUM_SAMPLE_SETTINGS.arm_eigenvalue_accuracy, needs_vectors=False)

        def mesh_of(rod: Rod) -> Elements:
            return spectrum_mesh(rod, SPECTRUM_SAMPLE_SETTINGS.min_computed_modes, accuracy)

        return finest_initial_mesh(self.points, mesh_of, self.searched_range_ends())

    def searched_range_ends(self) -> dict[str, np.ndarray]:
        """Ends of the searched range, (1,) or (2,), by name of the parameter: the largest F of a search along
        F; empty for tasks without a search."""
        options = getattr(self.config, self.config.task)
        return {"F": np.array([options.F_max])} if hasattr(options, "F_max") else {}

    def has_certificate_and_reason(self) -> tuple[bool, str]:
        """Returns (whether the run proves completeness, method of the proof or reason why there is no
        proof)."""
        task = self.config.task
        if not getattr(self.config, task).certify:
            return False, f"{task}.certify: false; {self.uncertified_risk}"
        proof = "winding number of D"
        if self.modes_counted_per == "line" and not self.config.is_uniform_and_linear:
            proof += " at some rods, with some bounds estimated; between them slopes of the eigenvalues"
        if self.modes_counted_per == "point" and self._has_varying_arm:
            proof += ", with some bounds estimated"
        return True, proof

    @property
    def _has_varying_arm(self) -> bool:
        """Whether the material or the cross-section of some arm varies along its length. The characteristic
        determinant D then has no closed form."""
        tapers = self.points.columns_by_name.get("taper", np.ones(1))
        return self.config.rod_material.profile is not None or bool((tapers != 1).any())

    def rows_of_check(self) -> list[CheckRow]:
        """Rows of the table of modelled and neglected effects, with a row on the certificate."""
        quantity, reason = self.never_modelled_effects
        values = self.parameter_values_with_searches
        rows = [
            *stretch_shear_and_drag_rows(values),
            *varying_arm_and_law_rows(self.config, values),
            *self.rows_on_requested_results(),
        ]
        return [*rows, ("certificate", *self.has_certificate_and_reason()), (quantity, False, reason)]


@dataclass(frozen=True, slots=True)
class ModesOfPointsTask(CertifiedTask):
    """Base class of the tasks spectrum and modes, which compute the leading modes at every point."""

    uncertified_risk: ClassVar[str] = "modes may be missed"
    """Consequence of a missing certificate, as `check` prints it."""
    modes_counted_per: ClassVar[str] = "point"
    """The certificate counts the modes of the rod of every point."""

    def variables_from_points(self, values: Mapping[str, Any]) -> tuple[FilledVariable, ...]:
        """Thresholds of the rods along F; empty if any arm is not uniform or not of linear material. values:
        variables of the points by name, shape (points, own dimensions), readable by slices."""
        return force_threshold_variables(self.points, values) if self.config.is_uniform_and_linear else ()


@dataclass(frozen=True, slots=True)
class HopfPointTask(CertifiedTask):
    """Base class of the tasks criticality and branch, which start from the Hopf points of a rod."""

    uncertified_risk: ClassVar[str] = "Hopf points may be missed"
    """Consequence of a missing certificate, as `check` prints it."""
    never_modelled_effects: ClassVar[tuple[str, str]] = (
        "gravity, inertia, motion out of the plane",
        "not part of the overdamped problem",
    )
    """(effects that the task never models, reason), as `check` prints them; nonlinear motion is modelled."""
    AXIAL_DRAG_ROW: ClassVar[CheckRow]
    """Row of `check` on the axial drag."""
    AXIAL_DRAG_ROW = "axial drag", True, "parameters.gamma1; it changes cycles, but no Hopf point"
