"""Commands that write a page or a picture to share: `report` and `portrait`."""

from pathlib import Path

import click

from .file_names import beside, followed
from .parameter_options import parameter_options

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
@click.option("--F-max", "F_max", type=float, default=200.0, show_default=True, help="Largest force.")
@click.option("--accuracy", type=float, help="Relative accuracy; by default that of each task.")
@click.option(
    "-o", "--output", type=FILE, default=Path("portrait.png"), show_default=True,
    help="A .png, .pdf or .svg file, or a .html page with tables.",
)  # fmt: skip
def portrait(F_max: float, accuracy: float | None, output: Path, **parameters: float | None) -> None:
    """Solve and draw all results for a rod: thresholds, branches, modes, three cycles."""
    from ..post.rod_portrait.paragraph import paragraph
    from ..post.rod_portrait.writing import require_portrait, write_portrait
    from ..tasks.rod_portrait import PortraitRequest, rod_results

    output = followed(output)
    require_portrait(output)
    given = {name: value for name, value in parameters.items() if value is not None}
    results = rod_results(PortraitRequest(parameters=given, F_max=F_max, accuracy=accuracy))
    click.echo(paragraph(results))
    click.echo(write_portrait(results, output))
