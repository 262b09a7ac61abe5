"""The command `explore`, which serves a local page."""

from pathlib import Path

import click

from .file_names import followed

PORTS = click.IntRange(0, 65535)


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
