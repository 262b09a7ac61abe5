"""docs/tutorials: every cell runs, and every number of the text is printed by a cell of its page."""

import importlib.util
import re

import numpy as np
import pytest
from conftest import ROOT
from surveyed import only

CELL = re.compile(r"^```\{code-cell\} python\n(.*?)^```", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"(?<![\w.])\d+\.\d+(?![\w.]*\d)")
"""A number with a decimal point: whole numbers are chosen by the author, or lists."""
TUTORIALS = ROOT / "docs" / "tutorials"
PAGES = sorted(page.stem for page in TUTORIALS.glob("*.md"))
GIVEN = {"arm": {"0.1", "1.5"}, "filament": {"0.5", "37.69", "2.2"}}
"""Numbers of the text that others published, or that are input, by page."""


def outputs_of(page):
    """All that the cells of a page print, as one text."""
    spec = importlib.util.spec_from_file_location("notebook", ROOT / "docs" / "notebook.py")
    notebook = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(notebook)
    names = {"__name__": "__main__"}
    found = []
    for number, source in enumerate(CELL.findall(page.read_text()), 1):
        for output in notebook.outputs_of(source, names, number):
            found += output.get("text", output.get("data", {}).get("text/plain", []))
    return "".join(found)


def is_printed(text, printed):
    """Whether a number of the text is a printed number, rounded to the digits of the text."""
    unit = 10.0 ** -len(text.partition(".")[2])
    return bool((np.abs(printed - float(text)) <= 0.501 * unit).any())


@pytest.mark.long
@pytest.mark.parametrize("page", only(["filament"], PAGES))
def test_every_number_of_a_tutorial_is_printed_by_its_cells(page, tmp_path, monkeypatch):
    page = TUTORIALS / f"{page}.md"
    monkeypatch.chdir(tmp_path)
    printed = np.array(re.findall(r"-?\d+\.\d+(?:e[+-]?\d+)?", outputs_of(page)), float)
    prose = re.sub(r"^```.*?^```|\([^()]*\d{4}\)", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    said = set(NUMBER.findall(prose)) - GIVEN.get(page.stem, set())
    assert len(said) >= 3
    assert [text for text in sorted(said) if not is_printed(text, printed)] == []
