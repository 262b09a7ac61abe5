"""What `rodsweep check` prints: the points, what is modelled and what is left out, and the cost."""

import numpy as np
from rich.console import Console
from rich.table import Table

from ..discretization.resolution import mesh_accuracy
from ..model.rod import PARAMETERS
from ..sweep.estimate import SAMPLE, estimate
from .job import Job


def describe_job(job: Job) -> None:
    """Prints the description of a valid config."""
    console = Console(highlight=False)
    config, points = job.config, job.points
    console.print(f"{job.path}: valid. {config.title}", markup=False)
    shape = " x ".join(str(n) for n in points.shape) if points.is_grid else "a list"
    console.print(f"{points.count} points ({shape}), {config.spectrum.modes} leading modes each")
    table = Table(box=None, pad_edge=False)
    for heading in ("part", "modelled", "why"):
        table.add_column(heading)
    for row in modelled(job):
        table.add_row(*row)
    console.print(table)
    cost = estimate(
        points,
        config.spectrum.modes,
        mesh_accuracy(config.accuracy, config.spectrum.vectors),
        config.spectrum.certify,
    )
    low, high = cost.unknowns
    console.print(f"unknowns a point: {low} to {high} expected, for accuracy {config.accuracy:g}")
    console.print(
        f"expected: {cost.seconds:.3g} s on one rank (divide by the ranks; first use compiles for some "
        f"seconds more), {cost.memory / 1e6:.0f} MB of memory a rank, "
        f"{points.count * job.layout.bytes_per_point / 1e6:.3g} MB of results"
    )
    if cost.too_large:
        console.print(
            f"warning: about {cost.too_large} of {min(SAMPLE, points.count)} sampled points need more "
            "unknowns than the limit and will end with status failed"
        )


def modelled(job: Job) -> list[tuple[str, str, str]]:
    """(part, yes or no, why) for everything that a scene may need."""
    columns = dict(zip(PARAMETERS, job.points.columns, strict=True))
    options = job.config.spectrum

    def compliance(name: str, word: str) -> tuple[str, str]:
        rigid = np.isinf(columns[name])
        if rigid.all():
            return "no", f"{name} = inf: the rod is {word}"
        return "yes", f"{name} is finite" + (f" at all but {int(rigid.sum())} values" if rigid.any() else "")

    dragged = (columns["gamma3"] > 0).any()
    return [
        ("stretch", *compliance("k1", "inextensible")),
        ("shear", *compliance("k2", "unshearable")),
        ("rotational drag", "yes" if dragged else "no", "gamma3 > 0" if dragged else "gamma3 = 0"),
        ("transverse modes", "yes", "task: spectrum"),
        (
            "longitudinal modes",
            "yes" if options.longitudinal else "no",
            "closed form, no mesh"
            if options.longitudinal
            else "they decouple; spectrum.longitudinal adds them",
        ),
        (
            "eigenvectors",
            "yes" if options.vectors else "no",
            f"on {options.nodes} nodes" if options.vectors else "spectrum.vectors adds them",
        ),
        (
            "certificate",
            "yes" if options.certify else "no",
            "winding number of D" if options.certify else "spectrum.certify: false; modes may be missed",
        ),
        ("gravity, inertia, nonlinear motion", "no", "not part of the linear overdamped problem"),
    ]
