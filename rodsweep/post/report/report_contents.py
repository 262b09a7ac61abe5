"""Contents of an HTML page about one result as plain text, tables and pictures, before conversion to HTML."""

from collections.abc import Sequence
from dataclasses import dataclass

from ...config.document.reading import tree_yaml
from ...config.values import printable
from ...results.file.view import ResultView
from ..summary import summary_of
from ..summary.summary_lines import Summary, TextTable, region_text
from .page_tables import PageTable, page_tables
from .pictures import Pictures

VERSION_WORDS = {
    "rodsweep_version": "rodsweep",
    "git_commit": "commit",
    "format": "format of the file",
    "python_version": "Python",
    "numpy_version": "NumPy",
    "numba_version": "numba",
    "petsc_version": "PETSc",
    "petsc4py_version": "petsc4py",
    "slepc_version": "SLEPc",
    "slepc4py_version": "slepc4py",
    "mpi4py_version": "mpi4py",
    "h5py_version": "h5py",
    "hdf5_version": "HDF5",
    "petsc_options": "options of PETSc",
    "started": "started",
    "finished": "finished",
    "fingerprint": "fingerprint of the config",
}
"""Printed names of the attributes of the result file that the page lists. No attribute contains the name of a
machine or a user."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportContents:
    """Contents of the page about one result."""

    name: str
    """Name of the result file."""
    title: str
    """Title in the config; the name of the result file if there is no title."""
    task: str
    summary: Summary
    statuses: TextTable
    pictures: Pictures
    """Figures of the result."""
    tables: Sequence[PageTable]
    config: str
    """Config as the user typed it."""
    complete_config: str
    """Config with the defaults of all keys filled in."""
    versions: Sequence[tuple[str, str]]
    """(printed name, value) of the attributes in VERSION_WORDS."""


def report_contents(view: ResultView, pictures: Pictures) -> ReportContents:
    """Contents of the page about the result `view`."""
    attributes = view.attributes
    summary = summary_of(view)
    name = printable(view.path.name)
    return ReportContents(
        name=name,
        title=str(attributes.get("title", "")) or name,
        task=view.task,
        summary=summary,
        statuses=_with_parameter_ranges(view, summary.statuses),
        pictures=pictures,
        tables=list(page_tables(view)),
        config=str(attributes.get("config", "")).strip("\n"),
        complete_config=tree_yaml(view.config).strip("\n"),
        versions=[
            (word, str(attributes[key]))
            for key, word in VERSION_WORDS.items()
            if str(attributes.get(key, ""))
        ],
    )


def _with_parameter_ranges(view: ResultView, statuses: TextTable) -> TextTable:
    """Table of statuses. If there are several statuses, a column with the parameter ranges of each status is
    added."""
    if len(statuses.rows) == 1:
        return statuses
    list_view = view.as_list
    rows = []
    for word, count, meaning in statuses.rows:
        ranges_text = (
            region_text(list_view, list_view.has_status(word)) if word in view.flags.values() else ""
        )
        rows.append((word, count, ranges_text, meaning))
    status_heading, count_heading, meaning_heading = statuses.headings
    return TextTable((status_heading, count_heading, "where", meaning_heading), tuple(rows))
