"""What `rodsweep check` prints: the points, what is modelled and what is left out, and the cost."""

import numpy as np
from rich.console import Console
from rich.table import Table

from ..post.summary.ranges import span
from ..sweep.estimate import SAMPLE
from .job import Job


def describe_job(job: Job) -> None:
    """Prints the description of a valid config."""
    console = Console(highlight=False)
    console.print(f"{job.path}: valid. {job.config.title}".rstrip(), markup=False)
    console.print(job.task.headline())
    if job.quantities:
        console.print(_arm_line(job), markup=False)
    table = Table("part", "modelled", "why", box=None, pad_edge=False)
    for part, is_modelled, why in job.task.parts():
        table.add_row(part, "yes" if is_modelled else "no", why)
    console.print(table)
    cost = job.task.cost()
    if cost.unknowns is not None:
        low, high = cost.unknowns
        console.print(f"unknowns a point: {low} to {high} expected, for accuracy {job.config.accuracy:g}")
    console.print(
        f"expected: {cost.seconds:.3g} s on one rank (divide by the ranks; first use compiles for some "
        f"seconds more), {cost.memory / 1e6:.0f} MB of memory a rank, "
        f"{job.points.count * job.layout.bytes_per_point / 1e6:.3g} MB of results"
    )
    if cost.too_large:
        console.print(
            f"warning: about {cost.too_large} of {min(SAMPLE, job.points.count)} sampled points need more "
            "unknowns than the limit and will end with status failed"
        )


def _arm_line(job: Job) -> str:
    """The parameters that are made of an arm, and its unit of time."""
    columns = job.points.by_name | {v.name: values for v, values in job.quantities if v.name == "tau2"}
    told = (f"{name} = {span(np.asarray(values))}" for name, values in columns.items())
    return f"the arm as a rod: {', '.join(told)} s"
