"""The command `merge`: shards into one file, and what is still missing."""

from pathlib import Path

import click

from ..results.file.merge import merge
from .running import CONTINUE


def merge_files(output: Path, shards: tuple[Path, ...]) -> int:
    """Merges, says what came of it; returns the exit status: CONTINUE while points are missing."""
    merged = merge(output, shards)
    click.echo(f"{output}: {merged.points} points from {len(shards)} files, {merged.missing} missing")
    if merged.kernels:
        click.echo(f"{output}: {merged.kernels}")
    if merged.missing:
        click.echo(f"`rodsweep run CONFIG -o {output}` computes the missing ones")
        return CONTINUE
    if not merged.finished:
        click.echo(f"`rodsweep run CONFIG -o {output}` adds what only all points together give")
    return 0
