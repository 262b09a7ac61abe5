"""docs/notebook.ipynb: its cells run, and what is stored below them is what comes."""

import importlib.util
import json
import re

import numpy as np
import pytest
from conftest import ROOT

PAGE = ROOT / "docs" / "notebook.ipynb"
NUMBER = re.compile(r"-?\d+\.?\d*(?:e[+-]?\d+)?")
ROUNDING = 1e-9
"""Below this a number is an estimate of rounding, of which only the size is alike elsewhere."""
LARGEST = 150_000
"""Bytes of the file, figure included."""
KEYS = {"markdown": {"id", "metadata", "source"}, "code": {"execution_count", "outputs"}}
"""What a cell has beside its type; one of code has those of text too (nbformat 4.5)."""


@pytest.fixture(scope="module")
def runner():
    spec = importlib.util.spec_from_file_location("notebook", ROOT / "docs" / "notebook.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def stored():
    return json.loads(PAGE.read_text())


def texts(output):
    """Kinds and texts of an output; of an image its kind only."""
    data = output.get("data", {"text/plain": output.get("text")})
    return {kind: "" if kind.startswith("image/") else "".join(text) for kind, text in data.items()}


@pytest.mark.long
def test_stored_outputs_are_what_comes(runner, stored):
    """But for the last digits, which are the processor's. Else: python docs/notebook.py."""
    for before, now in zip(stored["cells"], runner.executed(stored)["cells"], strict=True):
        assert before["source"] == now["source"]
        pairs = zip(before.get("outputs", []), now.get("outputs", []), strict=True)
        for old, new in ((texts(old), texts(new)) for old, new in pairs):
            assert old.keys() == new.keys()
            for kind in old:
                assert NUMBER.sub("#", old[kind]).split() == NUMBER.sub("#", new[kind]).split()
                numbers = [np.array(NUMBER.findall(each[kind]), float) for each in (old, new)]
                assert numbers[0] == pytest.approx(numbers[1], rel=1e-4, abs=ROUNDING)


def test_outputs_come_of_printing_and_of_the_last_expression(runner):
    names = {}
    printed, result = runner.outputs_of("print('a')\nx = 2\nx + 1", names, 1)
    assert (printed["text"], result["data"]) == (["a\n"], {"text/plain": ["3"]})
    assert runner.outputs_of("y = 1", names, 2) == []
    with pytest.raises(ZeroDivisionError):
        runner.outputs_of("1 / 0", names, 3)


def test_it_is_a_notebook_from_import_to_a_figure(stored):
    assert (stored["nbformat"], stored["nbformat_minor"]) == (4, 5)
    code = [cell for cell in stored["cells"] if cell["cell_type"] == "code"]
    assert [cell["execution_count"] for cell in code] == list(range(1, len(code) + 1))
    for cell in stored["cells"]:
        kind = cell["cell_type"]
        assert cell.keys() == {"cell_type"} | KEYS["markdown"] | (KEYS[kind] if kind == "code" else set())
    assert code[0]["source"][0] == "import rodsweep as rs\n"
    assert any("image/png" in output.get("data", {}) for cell in code for output in cell["outputs"])
    assert len({cell["id"] for cell in stored["cells"]}) == len(stored["cells"])
    assert PAGE.stat().st_size < LARGEST
