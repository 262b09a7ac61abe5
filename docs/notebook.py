"""Runs the cells of docs/notebook.ipynb, and writes what comes below them.

    python docs/notebook.py

Cells run one after another in one namespace, as in a fresh kernel; what a cell prints and its last expression
become its outputs. Needs no Jupyter. `tests/api/test_notebook.py` compares the stored outputs with these.
"""

import ast
import json
from base64 import b64encode
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

NOTEBOOK = Path(__file__).with_name("notebook.ipynb")


def executed(notebook: dict[str, Any]) -> dict[str, Any]:
    """The notebook with the current outputs of its cells."""
    names: dict[str, Any] = {"__name__": "__main__"}
    cells, number = [], 0
    for cell in notebook["cells"]:
        came: dict[str, Any] = {}
        if cell["cell_type"] == "code":
            number += 1
            outputs = outputs_of("".join(cell["source"]), names, number)
            came = {"execution_count": number, "outputs": outputs}
        cells.append(cell | came)
    return notebook | {"cells": cells}


def outputs_of(source: str, names: dict[str, Any], number: int) -> list[dict[str, Any]]:
    """Outputs of a cell in the notebook's format: printed text, then the last expression's value."""
    *statements, last = ast.parse(source).body
    if not isinstance(last, ast.Expr):
        statements, last = [*statements, last], None
    printed = StringIO()
    with redirect_stdout(printed):
        exec(compile(ast.Module(statements, []), f"cell {number}", "exec"), names)
        value = eval(compile(ast.Expression(last.value), f"cell {number}", "eval"), names) if last else None
    outputs: list[dict[str, Any]] = []
    if printed.getvalue():
        outputs.append({"name": "stdout", "output_type": "stream", "text": lines(printed.getvalue())})
    if value is not None:
        result = {"data": shown(value), "execution_count": number, "metadata": {}}
        outputs.append(result | {"output_type": "execute_result"})
    return outputs


def shown(value: Any) -> dict[str, Any]:
    """A value in the formats that notebooks display."""
    bundle: dict[str, Any] = {"text/plain": repr(value)}
    if hasattr(value, "_repr_html_"):
        bundle["text/html"] = value._repr_html_()
    if hasattr(value, "_repr_mimebundle_"):
        bundle |= value._repr_mimebundle_()
    return {
        kind: b64encode(data).decode() if isinstance(data, bytes) else lines(data)
        for kind, data in sorted(bundle.items())
    }


def lines(text: str) -> list[str]:
    """A text as a notebook stores it."""
    return text.splitlines(keepends=True)


def text_of(notebook: dict[str, Any]) -> str:
    """The text of a notebook's file."""
    return json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    NOTEBOOK.write_text(text_of(executed(json.loads(NOTEBOOK.read_text()))))
