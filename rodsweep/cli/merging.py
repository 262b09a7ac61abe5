"""The command `merge`: merges result files and prints a summary."""

from pathlib import Path

import click

from ..results.file.combination.merge import MergeResult, merge
from ..tasks.running.job import plan_without_solver
from ..wording import counted


def merge_files(output: Path, paths: tuple[Path, ...]) -> MergeResult:
    """Merges result files into `output` and prints the number of points and missing points."""
    merged = merge(output, paths, plan_without_solver)
    sources = counted(len(paths), "file")
    click.echo(f"{output}: {merged.points} points from {sources}, {merged.missing} missing")
    if merged.kernels:
        click.echo(f"{output}: {merged.kernels}")
    return merged
