"""`rodsweep merge`: the plan of a file that others are joined to, and what is said of it."""

from pathlib import Path

import click

from ..config.reading import canonical
from ..config.schema import Config
from ..results.file.creation import Plan
from ..results.file.merge import Merged, merge
from ..results.layouts import layout_of
from ..sweep.grid import Points
from ..tasks import TASKS
from ..wording import counted


def plan_without_solver(config: Config, points: Points) -> Plan:
    """The plan of a config on these points, without attributes and flags."""
    task = TASKS[config.task](config, points)
    resolved = canonical(config)
    return Plan(
        points=points,
        layout=layout_of(resolved),
        coordinates=task.coordinates(),
        constants=task.constants,
        config=resolved,
        attributes={},
        flags=(),
        chains=task.chains,
        stretches=task.stretches,
    )


def merge_files(output: Path, paths: tuple[Path, ...]) -> Merged:
    """Merges result files into `output` and says what came of it."""
    merged = merge(output, paths, plan_without_solver)
    click.echo(
        f"{output}: {merged.points} points from {counted(len(paths), 'file')}, {merged.missing} missing"
    )
    if merged.kernels:
        click.echo(f"{output}: {merged.kernels}")
    return merged
