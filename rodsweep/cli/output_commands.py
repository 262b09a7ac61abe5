"""Commands that write figures, tables and pages, and `explore`, which serves a local page."""

from pathlib import Path
from typing import Any

import click

from ..config.parameters_section import DEFAULT_F_MAX
from ..config.values import printable
from ..errors import InputError
from ..model.arm.quantities import UNITS_AND_EXAMPLES
from ..model.parameters import PARAMETERS
from .arm_options import NUMBER_TYPE, arm_options, parameter_options
from .file_names import FILE_TYPE, OUTPUT_OPTION_NAMES, link_target, with_suffix_replaced
from .portrait_rod import (
    QUANTITIES_WITHOUT_OPTION,
    portrait_option_names_in_errors,
    rod_of_options,
    solve_with_progress,
)

PORT_TYPE = click.IntRange(0, 65535)
"""Type of an option that names a TCP port."""


@click.command()
@click.argument("files", type=FILE_TYPE, nargs=-1, required=True, metavar="FILE...")
@click.option(
    *OUTPUT_OPTION_NAMES, type=FILE_TYPE,
    help="Figure file (.png, .pdf, .svg; .gif or .mp4 for an animation); by default FILE's name.",
)  # fmt: skip
@click.option(
    "--roots", type=click.Choice(["rightmost", "smallest", "all"]),
    help="Roots of spectra to draw: all stored roots, or two roots of each point: the rightmost, or the "
    "smallest in magnitude, as in the paper; by default the choice whose curves swap places less often.",
)  # fmt: skip
@click.option(
    "--what",
    type=click.Choice(["cycle", "amplitude", "maps", "energy", "transient", "animation", "lines", "map"]),
    help="Figure of limit_cycle, or (lines, map) of thresholds; by default the figure that suits the file.",
)
@click.option(
    "--point", "points", type=int, multiple=True, metavar="N",
    help="Points of limit_cycle to draw, from 1; up to 3 times.",
)  # fmt: skip
@click.option(
    "--at", multiple=True, metavar="NAME=VALUE",
    help="Draw only points at which a parameter has this value, such as k1=150, or a quantity of an arm, "
    "such as 'length=12 cm'.",
)  # fmt: skip
@click.option("--title", is_flag=True, help="Put the title of the config above the figure.")
@click.option(
    "--width", metavar="WIDTH",
    help="Width of the figure, with type of 8 pt: single (3.375 in), double (7 in), or a length such as "
    "'89 mm'.",
)  # fmt: skip
@click.option("--style", metavar="STYLE", help="Name or file of a matplotlib style.")
def plot(
    files: tuple[Path, ...], output: Path | None, at: tuple[str, ...],
    roots: str | None, what: str | None, points: tuple[int, ...], **look: Any,
) -> None:  # fmt: skip
    """Draw the result FILE, or several: spectra in panels, thresholds or limit cycles in one figure."""
    from ..post.figures import draw
    from ..post.figures.grid_slices import slice_at_values
    from ..post.figures.request import FigureLook
    from ..results.file.view import read_view
    from ..tasks.cycle_shapes import with_shapes

    output = output or with_suffix_replaced(files[0], ".gif" if what == "animation" else ".png")
    values = _parsed_at_values(at)
    views = [slice_at_values(read_view(link_target(file)), values) for file in files]
    message = draw(
        views, output, look=FigureLook(**look), shapes=with_shapes, roots=roots, what=what, points=points
    )
    click.echo(message)


def _parsed_at_values(at: tuple[str, ...]) -> dict[str, str]:
    """Values of the options `--at NAME=VALUE`, by name; InputError for a text without "=", or a name that is
    given twice."""
    values: dict[str, str] = {}
    for text in at:
        name, separator, value = text.partition("=")
        if not separator:
            raise InputError(f"--at {printable(text)} must be NAME=VALUE, such as k1=150 or 'length=12 cm'")
        name = name.strip()
        if name in values:
            both_values_text = f"{printable(values[name])} and {printable(value.strip())}"
            advice = "give one value for each parameter"
            raise InputError(f"--at {printable(name)} is given twice ({both_values_text}); {advice}")
        values[name] = value.strip()
    return values


@click.command()
@click.argument("file", type=FILE_TYPE)
@click.option(
    *OUTPUT_OPTION_NAMES, type=FILE_TYPE, help="A .csv or .tsv file; by default FILE's name with .csv."
)
@click.option("--table", metavar="NAME", help="Table to write: points, or a list such as crossings.")
@click.option("--columns", metavar="A,B,C", help="Columns to write, in this order; by default all.")
@click.option("--units", is_flag=True, help="Put units into the headings: F_onset [k3/L^2].")
@click.option("--replace", is_flag=True, help="Overwrite an existing file.")
def export(
    file: Path, output: Path | None, table: str | None, columns: str | None, units: bool, replace: bool
) -> None:
    """Write a table of the result FILE as CSV: one row per point, or per item of a list."""
    from ..post.export import ExportRequest
    from ..post.export import export as export_view
    from ..results.file.view import read_view

    output = link_target(output or with_suffix_replaced(file, ".csv"))
    names = tuple(name.strip() for name in columns.split(",")) if columns is not None else ()
    request = ExportRequest(table=table, columns=names, units=units, replace=replace)
    click.echo(f"wrote {output}: {export_view(read_view(link_target(file)), output, request)}")


@click.command()
@click.argument("files", type=FILE_TYPE, nargs=-1, required=True, metavar="FILE...")
@click.option(*OUTPUT_OPTION_NAMES, type=FILE_TYPE, help="A .html file; by default FILE's name with .html.")
def report(files: tuple[Path, ...], output: Path | None) -> None:
    """Write one HTML page about the result FILEs, to share: answer, figures, tables, config, provenance."""
    from ..post.report import require_html_path, write_report
    from ..results.file.view import read_view
    from ..tasks.cycle_shapes import with_shapes

    output = link_target(output or with_suffix_replaced(files[0], ".html"))
    require_html_path(output, files)
    click.echo(write_report([read_view(link_target(file)) for file in files], output, with_shapes))


@click.command()
@parameter_options
@arm_options(QUANTITIES_WITHOUT_OPTION, is_required=False)
@click.option("--poisson", type=NUMBER_TYPE, help="Poisson's ratio of the arm; by default 0.5.")
@click.option("--profile", metavar="FILE", help="A CSV file with factors along the rod, as material.profile.")
@click.option(
    "--F-max", "F_max", type=NUMBER_TYPE, default=DEFAULT_F_MAX, show_default=True, help="Largest force."
)
@click.option(
    "--accuracy", type=NUMBER_TYPE,
    help="Relative accuracy; by default 1e-5 on branches, and the accuracy of each other task.",
)  # fmt: skip
@click.option(
    *OUTPUT_OPTION_NAMES, type=FILE_TYPE, default=Path("portrait.png"), show_default=True,
    help="A .png, .pdf or .svg file, or a .html page with tables.",
)  # fmt: skip
def portrait(F_max: float, accuracy: float | None, output: Path, **options: Any) -> None:
    """Solve everything about one rod, and draw it: thresholds, branches, modes, three cycles.

    The rod has --k1, --k2 and --gamma3, or is an arm in SI units, such as --length "10 cm" --radius "5 mm"
    --young "100 kPa" --viscosity "12 Pa s".
    """
    from ..post.rod_portrait.paragraph import paragraph
    from ..post.rod_portrait.portrait_files import require_portrait_path, write_portrait
    from ..sweep.progress import ProgressReporter
    from ..tasks.rod_portrait import PortraitRequest, solve_rod_results
    from ..tasks.running.in_memory import solve_job_in_memory

    output = link_target(output)
    require_portrait_path(output)
    parameters = {name: value for name, value in options.items() if name in PARAMETERS}
    material = {name: options[name] for name in ("law", "section", "profile")}
    quantities = {name: value for name, value in options.items() if name in (*UNITS_AND_EXAMPLES, "poisson")}
    quantities["segments"] = options["segment"] or None
    with (
        portrait_option_names_in_errors(),
        solve_with_progress(ProgressReporter(None, "portrait", "solved"), solve_job_in_memory) as solve,
    ):
        rod = rod_of_options(parameters, quantities, material)
        results = solve_rod_results(PortraitRequest(rod=rod, F_max=F_max, accuracy=accuracy), solve)
    click.echo(paragraph(results))
    click.echo(write_portrait(results, output))


@click.command()
@click.argument("source", type=FILE_TYPE, required=False, metavar="[FILE | CONFIG]")
@click.option(
    "--port", type=PORT_TYPE, default=0, show_default=True, help="Port of the page; 0 chooses a free port."
)
@click.option("--open", "is_opened", is_flag=True, help="Open the page in the browser.")
def explore(source: Path | None, port: int, is_opened: bool) -> None:
    """Explore a rod or an arm live on a local page, from the result FILE, a CONFIG, or an example."""
    from ..explore import serve_page as start

    start(None if source is None else link_target(source), port, is_opened)
