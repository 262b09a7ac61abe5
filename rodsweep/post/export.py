"""Export of a table of results as CSV: words for flags, empty cells for missing values."""

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from ..errors import InputError
from ..results.file.view import ResultView
from ..wording import counted, enumeration
from .output_files import atomic_write
from .tables.tables import Table, Tables

SEPARATORS = {".csv": ",", ".tsv": "\t"}
"""Character between two columns, by the suffix of the output file."""
EXPORT_BATCH_ROWS = 4096
"""Number of rows that are converted to text at a time, to limit the memory."""


@dataclass(frozen=True, slots=True)
class ExportRequest:
    """Options for the export of a table.

    table: name; by default the table that has `columns`, or the default table of the task. columns: names; by
    default all columns. units: whether headings contain units. replace: whether to overwrite an existing
    file.
    """

    table: str | None = None
    columns: tuple[str, ...] = ()
    units: bool = False
    replace: bool = False


def export(view: ResultView, output: Path, request: ExportRequest) -> str:
    """Writes one table of a result to the file `output`, and returns a sentence about the table. Raises
    InputError for an unknown table or column, for an invalid file name, and if the file exists and may not be
    replaced."""
    if output.is_dir() or output.suffix not in SEPARATORS:
        endings_text = "; ".join((".csv separates columns by commas", ".tsv by tabs"))
        raise InputError(f"--output {output}: the name must end in .csv or .tsv ({endings_text})")
    if output.exists() and not request.replace:
        raise InputError(f"{output} exists already; --replace overwrites it, -o names another file")
    table = Tables(view).table(request.table, request.columns)
    with atomic_write(output) as stream:
        _write_csv(table, SEPARATORS[output.suffix], request.units, stream)
    return _written_table_sentence(table, view)


def _write_csv(table: Table, separator: str, includes_units: bool, stream: TextIO) -> None:
    """Writes a table to `stream` as CSV. includes_units: whether headings contain units."""
    csv_writer = csv.writer(stream, delimiter=separator, lineterminator="\n")
    csv_writer.writerow(
        column.heading_with_unit if includes_units else column.name for column in table.columns
    )
    for start in range(0, table.row_count, EXPORT_BATCH_ROWS):
        texts = [
            column.with_rows(slice(start, start + EXPORT_BATCH_ROWS)).csv_texts() for column in table.columns
        ]
        csv_writer.writerows(zip(*texts, strict=True))


def _written_table_sentence(table: Table, view: ResultView) -> str:
    """Sentence on the written table: numbers of rows and columns, number of points without a row, and names
    of the other tables."""
    text = f"{counted(table.row_count, 'row')} of {table.name} in {counted(len(table.columns), 'column')}"
    if table.point_count_without_rows:
        points_text = counted(view.variables["status"].size, "point")
        text += f"; {table.point_count_without_rows} of {points_text} without a row"
    if table.other_tables:
        text += f"; --table takes {enumeration(table.other_tables, 'or')} instead"
    return text
