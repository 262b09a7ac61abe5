"""Commands that write a page or a picture to share, `report` and `portrait`, and `explore`, a local page."""

from pathlib import Path
from typing import Any

import click

from ..model.arm.quantities import UNITS
from ..model.parameters import PARAMETERS
from .arm_options import arm_options, parameter_options
from .file_names import beside, followed
from .portrait_rod import LEFT_OUT, rod_from, showing

PORTS = click.IntRange(0, 65535)
FILE = click.Path(path_type=Path)


@click.command()
@click.argument("files", type=FILE, nargs=-1, required=True, metavar="FILE...")
@click.option("-o", "--output", type=FILE, help="A .html file; by default FILE's name with .html.")
def report(files: tuple[Path, ...], output: Path | None) -> None:
    """Write one HTML page about the result FILEs, to share: answer, figures, tables, config, provenance."""
    from ..post.report import require_page, write_report
    from ..results.file.view import read_view
    from ..tasks.cycle_shapes import with_shapes

    output = followed(output or beside(files[0], ".html"))
    require_page(output, files)
    click.echo(write_report([read_view(followed(file)) for file in files], output, with_shapes))


@click.command()
@parameter_options
@arm_options(LEFT_OUT, is_needed=False)
@click.option("--poisson", type=float, help="Poisson's ratio of the arm; by default 0.5.")
@click.option("--profile", metavar="FILE", help="A CSV file with factors along the rod, as material.profile.")
@click.option("--F-max", "F_max", type=float, default=200.0, show_default=True, help="Largest force.")
@click.option("--accuracy", type=float, help="Relative accuracy; by default that of each task.")
@click.option(
    "-o", "--output", type=FILE, default=Path("portrait.png"), show_default=True,
    help="A .png, .pdf or .svg file, or a .html page with tables.",
)  # fmt: skip
def portrait(F_max: float, accuracy: float | None, output: Path, **options: Any) -> None:
    """Solve everything about one rod, and draw it: thresholds, branches, modes, three cycles.

    The rod has --k1, --k2 and --gamma3, or is an arm in SI units, such as --length "10 cm" --radius "5 mm"
    --young "100 kPa" --viscosity "12 Pa s".
    """
    from ..post.rod_portrait.paragraph import paragraph
    from ..post.rod_portrait.writing import require_portrait, write_portrait
    from ..sweep.progress import ProgressReporter
    from ..tasks.rod_portrait import PortraitRequest, rod_results
    from ..tasks.running.in_memory import solved_view

    output = followed(output)
    require_portrait(output)
    parameters = {name: value for name, value in options.items() if name in PARAMETERS}
    material = {name: options[name] for name in ("law", "section", "profile")}
    quantities = {name: value for name, value in options.items() if name in (*UNITS, "poisson")}
    quantities["segments"] = options["segment"] or None
    rod = rod_from(parameters, quantities, material)
    with showing(ProgressReporter(None, "portrait", "solved"), solved_view) as solve:
        results = rod_results(PortraitRequest(rod=rod, F_max=F_max, accuracy=accuracy), solve)
    click.echo(paragraph(results))
    click.echo(write_portrait(results, output))


@click.command()
@click.argument("source", type=click.Path(path_type=Path), required=False, metavar="[FILE | CONFIG]")
@click.option(
    "--port", type=PORTS, default=0, show_default=True, help="Port of the page; 0 chooses a free port."
)
@click.option("--open", "is_opened", is_flag=True, help="Open the page in the browser.")
def explore(source: Path | None, port: int, is_opened: bool) -> None:
    """Explore a rod or an arm live on a local page, from the result FILE, a CONFIG, or an example."""
    from ..explore.starting import explore as start

    start(None if source is None else followed(source), port, is_opened)
