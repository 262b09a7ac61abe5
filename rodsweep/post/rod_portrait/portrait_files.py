"""Portrait of a rod as a file: an image with the paragraph, or an HTML page with tables."""

from pathlib import Path

from ...wording import enumeration
from ..cost_and_provenance import provenance_lines
from ..output_files import atomic_write, require_output_path, save_figure
from ..report import rendered_template
from ..report.report_contents import CaptionedPicture, Pictures, page_tables
from ..report.vector_picture import vector_picture
from .paragraph import paragraph
from .portrait_drawing import draw_rod_portrait
from .results import RodResults

IMAGE_SUFFIXES = (".png", ".pdf", ".svg")
"""Suffixes of image files for a portrait."""
PAGE_SUFFIX = ".html"
"""Suffix of an HTML page."""
CYCLE_COUNT_WORDS = ("no cycle", "one cycle", "two cycles", "three cycles")
"""Words for the number of cycles in a portrait."""
TABLES_OMITTED_ON_PAGE = ("mode_shapes", "shapes", "harmonics", "multipliers", "samples")
"""Tables left out of an HTML page, because the picture shows their content better."""


def require_portrait_path(output: Path) -> None:
    """Raises InputError if `output` is not a valid name for an image or an HTML page, see
    `require_output_path`."""
    noun = "page" if output.suffix == PAGE_SUFFIX else "picture"
    require_output_path(output, (*IMAGE_SUFFIXES, PAGE_SUFFIX), noun)


def write_portrait(results: RodResults, output: Path) -> str:
    """Writes the portrait to the file `output`, and returns a sentence about the file. Raises InputError for
    an invalid file name."""
    require_portrait_path(output)
    if output.suffix == PAGE_SUFFIX:
        with atomic_write(output) as stream:
            stream.write(portrait_html(results))
    else:
        save_figure(draw_rod_portrait(results), output)
    return f"wrote {output}: {shown_results_text(results)}"


def shown_results_text(results: RodResults) -> str:
    """Enumeration of the results that the picture shows, for the sentence "wrote ..."."""
    branches = results.branches
    part_is_shown = {
        "thresholds": True,
        "branches of cycles": branches is not None and bool(branches.curves),
        "modes at the thresholds": bool(results.modes_at_first_thresholds),
        CYCLE_COUNT_WORDS[len(results.cycles)]: bool(results.cycles),
    }
    return enumeration([part_name for part_name, is_shown in part_is_shown.items() if is_shown])


def portrait_html(results: RodResults) -> str:
    """Portrait as the text of an HTML page that needs no network."""
    caption = shown_results_text(results)
    picture = vector_picture(draw_rod_portrait(results, with_words=False), 1, caption)
    views = [*results.views.items()]
    load_text = results.units.load_text
    views += [(f"modes at {load_text(F)}", view) for F, view in results.modes_at_first_thresholds.values()]
    views += [(f"limit cycle at {load_text(F)}", view) for F, view in results.cycles]
    return rendered_template(
        "portrait.html",
        kind=results.rod.kind,
        title=f"{results.rod.kind.capitalize()} with {results.rod.description}",
        paragraph=paragraph(results),
        pictures=Pictures((CaptionedPicture(caption, picture),)),
        tables=[
            (name, [table for table in page_tables(view) if table.name not in TABLES_OMITTED_ON_PAGE])
            for name, view in views
        ],
        origin=provenance_lines(results.views["thresholds"].attributes),
    )
