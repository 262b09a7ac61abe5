"""`rodsweep merge`: the plan of a file that others are joined to, and what is said of it."""

from pathlib import Path

import click

from ..results.file.combination.merge import MergeResult, merge
from ..tasks.running.plan import plan_without_solver
from ..wording import counted


def merge_files(output: Path, paths: tuple[Path, ...]) -> MergeResult:
    """Merges result files into `output` and says what came of it."""
    merged = merge(output, paths, plan_without_solver)
    click.echo(
        f"{output}: {merged.points} points from {counted(len(paths), 'file')}, {merged.missing} missing"
    )
    if merged.kernels:
        click.echo(f"{output}: {merged.kernels}")
    return merged
