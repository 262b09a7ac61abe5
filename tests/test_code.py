"""Rules for the source code beyond the linters'. The sources are read, not run."""

import ast
import re
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import rodsweep

ROOT = Path(rodsweep.__file__).parents[1]
FILES = [path for folder in ("rodsweep", "benchmarks") for path in sorted((ROOT / folder).rglob("*.py"))]
SOURCES = {path.relative_to(ROOT): path.read_text() for path in FILES}
LONGEST_FUNCTION = 40
"""Lines of code, without its docstring, comments and empty lines."""
LONGEST_MODULE = 250
"""Lines, with docstrings, comments and empty lines."""
ARRAYS = re.compile(r"\b(NDArray|ndarray|Array|Complex|Vector)\b")
SHAPE = re.compile(r"\bshapes?\b|\((?:[\w.+* -]+,\s*)+[\w.+* -]*\)")
"""How a docstring names a shape: by the word, or as (n,), (3, ..., nodes + 1)."""
TELLS_NOTHING = re.compile(
    "approach|attempt|counts|dense|leading|method|native|peak|polish|presence|resolved|rest|shapes|vectors|"
    "utils|helpers|common|manager"
)
"""Names of modules that a newcomer cannot place."""
CONSTANT = re.compile("[A-Z][A-Z0-9_]+")
ONE_MEANING = {
    "MOST_STEPS",
    "DIFFERENCE",
    "MOST_UNKNOWNS",
    "CLOSE",
    "SAME",
    "MACHINE_EPSILON",
    "PREFIX",
}


@cache
def trees() -> dict[Path, ast.Module]:
    """The sources parsed, which takes seconds: each worker of pytest-xdist collects this module."""
    return {path: ast.parse(text) for path, text in SOURCES.items()}


def functions(node: ast.AST, outer: str = "") -> Iterator[tuple[ast.FunctionDef, str]]:
    """All functions and methods, none local to another, each with the docstring of its class."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef):
            yield child, outer
        elif isinstance(child, ast.ClassDef):
            yield from functions(child, outer + (ast.get_docstring(child) or ""))


def lines_of_code(function: ast.FunctionDef, text: str) -> int:
    """Lines of a function from its `def` on, without its docstring, comments and empty lines."""
    lines = text.splitlines()
    first = function.body[0]
    documented = ast.get_docstring(function) is not None
    prose = range(first.lineno, (first.end_lineno or 0) + 1) if documented else range(0)
    return sum(
        number not in prose and bool(lines[number - 1].strip()) and lines[number - 1].strip()[0] != "#"
        for number in range(function.lineno, (function.end_lineno or 0) + 1)
    )


def place(path: Path, node: ast.FunctionDef) -> str:
    return f"{path}:{node.lineno} {node.name}"


def test_public_functions_name_the_shapes_of_their_arrays():
    """In their docstring or their class's."""
    silent = []
    for path, tree in trees().items():
        for function, outer in functions(tree):
            given = (argument.annotation for argument in (*function.args.args, *function.args.kwonlyargs))
            types = " ".join(ast.unparse(kind) for kind in (*given, function.returns) if kind)
            prose = (ast.get_docstring(function) or "") + outer
            if not function.name.startswith("_") and ARRAYS.search(types) and not SHAPE.search(prose):
                silent.append(place(path, function))
    assert silent == []


def test_no_function_is_long():
    long = [
        place(path, function)
        for path, tree in trees().items()
        for function, _ in functions(tree)
        if lines_of_code(function, SOURCES[path]) > LONGEST_FUNCTION
    ]
    assert long == []


def test_no_module_is_long():
    lengths = {path: len(text.splitlines()) for path, text in SOURCES.items() if path.parts[0] == "rodsweep"}
    too_long = {path: n for path, n in lengths.items() if n > LONGEST_MODULE}
    assert too_long == {}


def test_every_exception_from_a_lint_rule_has_its_reason():
    bare = [
        f"{path}:{number}"
        for path, text in SOURCES.items()
        for number, line in enumerate(text.splitlines(), 1)
        if "# noqa" in line and not re.search(r"# noqa: [A-Z0-9, ]+ - \S", line)
    ]
    assert bare == []


def test_modules_are_named_for_what_they_hold():
    assert [str(path) for path in SOURCES if TELLS_NOTHING.fullmatch(path.stem)] == []


def test_a_name_has_one_meaning():
    """No two classes share a name, nor constants of the solvers, nor constants whose names say little."""
    owners = defaultdict(list)
    for path, tree in trees().items():
        for node in tree.body:
            if isinstance(node, ast.ClassDef):
                owners[node.name].append(str(path))
            targets = node.targets if isinstance(node, ast.Assign) else []
            names = [name.id for target in targets for name in ast.walk(target) if isinstance(name, ast.Name)]
            in_solve = path.parts[:2] == ("rodsweep", "solve")
            for name in names:
                if name in ONE_MEANING or (in_solve and CONSTANT.fullmatch(name)):
                    owners[name].append(str(path))
    assert {name: paths for name, paths in owners.items() if len(paths) > 1} == {}


def test_no_module_asks_which_task_it_is():
    """What is special about a task is said by the task's own modules, found through registries."""
    asks = re.compile(r"\btask\b\W* (==|!=|in) [\"'(\[{]")
    assert [str(path) for path, text in SOURCES.items() if asks.search(text)] == []
