"""Commands that write a page or a picture to be sent: `report`."""

from pathlib import Path

import click

from .file_names import beside, followed

FILE = click.Path(path_type=Path)


@click.command()
@click.argument("files", type=FILE, nargs=-1, required=True, metavar="FILE...")
@click.option("-o", "--output", type=FILE, help="A .html file; by default FILE's name with .html.")
def report(files: tuple[Path, ...], output: Path | None) -> None:
    """Write one HTML page about the result FILEs, to be sent: answer, figures, tables, config, provenance."""
    from ..post.report import require_page, write_report
    from ..results.file.view import read_view
    from ..tasks.cycle_shapes import with_shapes

    output = followed(output or beside(files[0], ".html"))
    require_page(output, files)
    click.echo(write_report([read_view(followed(file)) for file in files], output, with_shapes))
