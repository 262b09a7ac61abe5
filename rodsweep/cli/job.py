"""From a config file to everything a run needs that is neither PETSc nor MPI."""

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..config import Config, load_config
from ..config.reading import canonical
from ..discretization.quadrature import lobatto_points
from ..errors import InputError
from ..model.longitudinal import longitudinal_rates
from ..model.rod import ALLOWED, admissible
from ..results.schema import Layout, Variable, spectrum_layout
from ..sweep.grid import Points, grid_size, points_of


@dataclass(frozen=True, slots=True)
class Job:
    """A validated config with its points and the layout of its results."""

    path: Path
    config: Config
    text: str
    points: Points

    @property
    def vector_nodes(self) -> int:
        return self.config.spectrum.nodes if self.config.spectrum.vectors else 0

    @property
    def layout(self) -> Layout:
        return spectrum_layout(self.config.spectrum.modes, self.vector_nodes)

    @property
    def resolved(self) -> dict:
        return canonical(self.config)

    @property
    def coordinates(self) -> dict[str, np.ndarray]:
        """The material coordinate of the vectors' nodes, where there are vectors."""
        if not self.vector_nodes:
            return {}
        return {"u": lobatto_points(self.vector_nodes)}

    @property
    def constants(self) -> tuple[tuple[Variable, np.ndarray], ...]:
        """The longitudinal rates, where they are asked for: along k1 on a grid, along the points else."""
        gamma1 = self.config.parameters.gamma1
        if gamma1 is None:
            return ()
        k1 = self.points.columns[1]
        rates = np.array([longitudinal_rates(float(k), gamma1, self.config.spectrum.modes) for k in k1])
        dims = ("k1" if self.points.is_grid else "point", "mode")
        meaning = f"longitudinal eigenvalue, real, for gamma1 = {gamma1:g}"
        return ((Variable("longitudinal_rate", "<f8", np.nan, "1/tau2", meaning, dims), rates),)


def make_job(path: Path, overrides: tuple[str, ...]) -> Job:
    """The job of a config file; InputError for everything that can be known to be wrong beforehand."""
    config, text = load_config(path, overrides)
    _refuse_too_many(path, config, grid_size(config.parameters))
    job = Job(path, config, text, points_of(config.parameters, path.parent))
    gamma1 = config.parameters.gamma1
    if gamma1 is not None:
        if not admissible("gamma1", gamma1):
            raise InputError(f"{path}: parameters.gamma1 = {gamma1:g} is not {ALLOWED['gamma1']}")
        if np.isinf(job.points.columns[1]).any():
            raise InputError(
                f"{path}: spectrum.longitudinal needs finite k1: a rod with k1 = inf cannot stretch"
            )
    return job


def _refuse_too_many(path: Path, config: Config, count: int) -> None:
    """InputError where the results of a grid would not fit in memory; before any axis is made."""
    options = config.spectrum
    layout = spectrum_layout(options.modes, options.nodes if options.vectors else 0)
    size = count * layout.bytes_per_point
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if size > memory:
        raise InputError(
            f"{path}: parameters make a grid of {count:.6g} points, whose results take {size / 1e9:.3g} GB, "
            f"more than the {memory / 1e9:.3g} GB of memory of this machine; use fewer points or modes"
        )
