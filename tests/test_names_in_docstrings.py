"""Names in backticks, in docstrings and comments, exist: renaming must not leave the old name behind."""

import ast
import io
import re
import tokenize
from pathlib import Path

import rodsweep

FOLDER = Path(rodsweep.__file__).parent
NAMES_OF_OTHER_PROGRAMS = set(
    [
        "Div",
        "WORDS",
        "cfunc",
        "eigvals",
        "eigvalsh",
        "leggauss",
        "geomspace",
        "head",
        "kill",
        "pth",
        "reshape",
        "sel",
        "tests",
        "try",
        "x1b",
    ]
)
"""Names from libraries, shells and grammars that stand in docstrings and nowhere in the package's code."""
DOTTED_NAME = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*")


def identifiers(tree):
    """All identifiers in `tree`."""
    found = set()
    for node in ast.walk(tree):
        for field in ("id", "arg", "attr", "name", "asname", "module"):
            found.update((getattr(node, field, None) or "").split("."))
    return found


def defined_names(tree):
    """Names that other modules may mean: functions, classes, constants, fields and attributes."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(node.name)
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            found.add(node.attr)
        if isinstance(node, ast.Module | ast.ClassDef):
            assigned = [x for x in node.body if isinstance(x, ast.Assign | ast.AnnAssign)]
            for target in (t for x in assigned for t in getattr(x, "targets", None) or [x.target]):
                found.update(name.id for name in ast.walk(target) if isinstance(name, ast.Name))
    return found


def words_of_short_texts(tree):
    """Words of the short strings in `tree`: config keys, variables of files, statuses."""
    texts = (node.value for node in ast.walk(tree) if isinstance(node, ast.Constant))
    return {
        word
        for text in texts
        if isinstance(text, str) and len(text) < 50
        for word in re.findall(r"\w+", text)
    }


def names_in_backticks(path, tree):
    """(line, name) of all names in backticks in docstrings and comments of the module at `path`."""
    texts = [
        (node.lineno, node.value.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    ]
    tokens = tokenize.generate_tokens(io.StringIO(path.read_text()).readline)
    texts += [(token.start[0], token.string) for token in tokens if token.type == tokenize.COMMENT]
    for line, text in texts:
        for quoted in re.finditer(r"(?<!`)`([^`]+)`(?!`)", text):
            for name in DOTTED_NAME.findall(quoted[1]):
                yield line + text[: quoted.start()].count("\n"), name


def members_by_owner(trees):
    """Names in each class, by name of the class and by the names of its instances at module level."""
    classes = [node for tree in trees for node in tree.body if isinstance(node, ast.ClassDef)]
    members = {node.name: identifiers(node) for node in classes if not node.bases}
    for node in (node for tree in trees for node in tree.body if isinstance(node, ast.Assign)):
        if isinstance(node.value, ast.Call) and isinstance(node.value.func, ast.Name):
            owner = node.value.func.id
            class_node = next((c for c in classes if c.name == owner), None)
            if class_node is not None:
                members |= {
                    target.id: identifiers(class_node)
                    for target in node.targets
                    if isinstance(target, ast.Name)
                }
    return members


def test_names_in_backticks_exist():
    trees = {path: ast.parse(path.read_text()) for path in sorted(FOLDER.rglob("*.py"))}
    members = members_by_owner(trees.values())
    package_names = NAMES_OF_OTHER_PROGRAMS | {part for path in trees for part in path.with_suffix("").parts}
    for tree in trees.values():
        package_names |= defined_names(tree) | words_of_short_texts(tree)
    for path in (FOLDER.parent / "tests").rglob("test_*.py"):
        package_names |= defined_names(ast.parse(path.read_text()))
    missing = []
    names = ((path, *found) for path, tree in trees.items() for found in names_in_backticks(path, tree))
    own_names = {path: identifiers(tree) for path, tree in trees.items()}
    for path, line, name in names:
        first, *rest = name.split(".")
        if rest and first in members:
            exists = rest[0] in members[first]
        else:
            last = name.rsplit(".", 1)[-1]
            exists = last in package_names or last in own_names[path]
        if not exists:
            missing.append(f"{path.relative_to(FOLDER.parent)}:{line}: {name}")
    assert not missing
