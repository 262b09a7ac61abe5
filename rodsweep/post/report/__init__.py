"""One self-contained HTML page about results: `rodsweep report`.

The page contains the lines of `rodsweep show`, the figures of `rodsweep plot` with values under the pointer,
the tables of `rodsweep export`, the config and the provenance. The page forbids the browser to load external
content.
"""

import re
from collections.abc import Sequence
from itertools import count
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from ... import __version__
from ...results.file.provenance import utc_time
from ...results.file.view import ResultView
from ...wording import counted
from ..figures.request import CycleShapeSolver
from ..output_files import atomic_write, require_output_path
from .report_contents import MAX_TABLE_ROWS, Pictures, ReportContents, pictures_of, report_contents

QUOTED_TEXT_PATTERN = re.compile("`([^`]*)`")
"""Pattern for a text between backquotes in a sentence: a command, or a key of a config."""


def require_html_path(output: Path, inputs: Sequence[Path]) -> None:
    """Raises InputError if `output` is not a valid name for an HTML page, see `require_output_path`. inputs:
    result files, which must not be overwritten."""
    require_output_path(output, (".html",), "page", inputs)


def write_report(views: Sequence[ResultView], output: Path, shapes: CycleShapeSolver | None = None) -> str:
    """Writes an HTML page about results to the file `output`, and returns a sentence about the page.

    shapes: function that computes the shapes of cycles for figures, if the file has no shapes. Raises
    InputError for an invalid name of the page.
    """
    require_html_path(output, [view.path for view in views])
    numbers = count(1)
    results = [report_contents(view, pictures_of([view], shapes, numbers)) for view in views]
    common_pictures = pictures_of(views, shapes, numbers) if views[1:] else Pictures(())
    text = report_html(results, common_pictures)
    with atomic_write(output) as stream:
        stream.write(text)
    pictures = sum(len(result.pictures.captioned_pictures) for result in results) + len(
        common_pictures.captioned_pictures
    )
    return f"wrote {output}: {counted(len(views), 'result')}, {counted(pictures, 'figure')}"


def report_html(results: Sequence[ReportContents], shared_pictures: Pictures) -> str:
    """HTML text of the page. shared_pictures: figures that show several results in the same panels."""
    title = "; ".join(result.title for result in results)
    return rendered_template("page.html", title=title, results=results, together=shared_pictures)


def rendered_template(template: str, **contents: Any) -> str:
    """HTML text made from a template of this package. contents: variables of the template."""
    spaces: dict[str, Any] = {"trim_blocks": True, "lstrip_blocks": True, "keep_trailing_newline": True}
    loader = PackageLoader(__name__)
    environment = Environment(loader=loader, autoescape=True, undefined=StrictUndefined, **spaces)
    environment.filters["svg"] = Markup  # made here from numbers and escaped texts
    environment.filters["with_code"] = lambda text: Markup(
        QUOTED_TEXT_PATTERN.sub(r"<code>\1</code>", str(escape(text)))
    )
    contents |= {"max_rows": MAX_TABLE_ROWS, "version": __version__, "written": utc_time()}
    return environment.get_template(template).render(contents)
