"""README.md and docs/: links have targets, commands and configs are valid, tables equal the code's."""

import ast
import importlib.util
import re
import shlex
import shutil
import textwrap
import tomllib
from functools import cache
from pathlib import Path

import click
import h5py
import numpy as np
import pytest
from conftest import ROOT
from printed import ROUNDING
from surveyed import RODS

from rodsweep.cli import commands
from rodsweep.config import read_config
from rodsweep.config.document.parsing import parsed_yaml
from rodsweep.config.tasks import CONFIG_CLASSES_BY_TASK
from rodsweep.errors import InputError

DOCS = ROOT / "docs"
ENTRANCE = DOCS / "index.md"
"""First page of the site, with all other pages in its table of contents."""
PAGES = [ROOT / "README.md", *(page for page in sorted(DOCS.rglob("*.md")) if page != ENTRANCE), ENTRANCE]
MOST_LINES = 150
"""Lines of the README."""
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
PLACE = re.compile(r"(rodsweep|tests|docs|configs|jobs|install|\.ci)/[\w./*-]*")
TASKS = "|".join(CONFIG_CLASSES_BY_TASK)
NOT_OURS = "--array"
"""An option of another program."""
SOMETIMES = {"failure_reasons", "snapshot", "gamma1", "coordinates"}
"""Attributes that some files have not."""

each_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)


@cache
def script(name):
    """A script of docs/ that writes pages."""
    spec = importlib.util.spec_from_file_location(name, DOCS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def reference():
    """The script that writes docs/file-format.md and the tables of the tasks' pages."""
    return script("reference")


def blocks(page: Path, language: str) -> list[str]:
    """The fenced blocks of a language."""
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)


def code_of(page: Path) -> list[str]:
    """Inline code, and the lines of blocks of commands without their comments."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    lines = [line[4:].split("  #")[0] for line in text.splitlines() if line.startswith("    ")]
    return lines + re.findall(r"`([^`\n]+)`", text)


def anchors(page: Path) -> set[str]:
    """The anchors of a page's headings, as GitHub makes them."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def accepts(words: list[str]) -> bool:
    """Whether a command of rodsweep takes these words; none at all name the command."""
    name, *rest = words
    command = commands.commands.get(name)
    if command is None or not rest:
        return command is not None
    try:
        command.make_context(name, rest)
    except click.UsageError:
        return False
    return True


def is_option(words: list[str]) -> bool:
    """Whether some command has the option, with the value if there is one."""
    if len(words) == 1:
        return any(
            words[0] in option.opts for command in commands.commands.values() for option in command.params
        )
    return any(accepts([name, *files, *words]) for name in commands.commands for files in ([], ["x"]))


def test_readme_is_short():
    assert len((ROOT / "README.md").read_text().splitlines()) <= MOST_LINES


def test_readme_names_every_task_and_the_site():
    text = (ROOT / "README.md").read_text()
    assert all(f"`{task}`" in text for task in CONFIG_CLASSES_BY_TASK)
    assert "`make docs`" in text and "(docs/index.md)" in text


def test_the_contents_of_the_site_have_every_page():
    trees = re.findall(r"^```\{toctree\}\n(.*?)^```", ENTRANCE.read_text(), re.MULTILINE | re.DOTALL)
    listed = [line for tree in trees for line in tree.splitlines() if line and line[0] != ":"]
    pages = [*PAGES[1:-1], DOCS / "notebook.ipynb"]
    assert sorted(listed) == sorted(str(page.relative_to(DOCS).with_suffix("")) for page in pages)


def test_headline_numbers_are_those_of_the_tables():
    text = (ROOT / "README.md").read_text().split("## Speed\n")[1].split("\n## ")[0]
    tables = (DOCS / "performance.md").read_text()
    numbers = re.findall(r"\d[\d.e-]*\d", text)
    assert len(numbers) > 4
    stale = [number for number in numbers if number not in tables]
    assert stale == [], "README.md, Speed: take them from docs/performance.md"


@each_page
def test_links_lead_somewhere(page):
    for link in LINK.findall(page.read_text()):
        target, _, anchor = link.partition("#")
        if target.startswith(("http:", "https:")):
            continue
        there = (page.parent / target).resolve() if target else page
        assert there.exists(), link
        assert not anchor or anchor in anchors(there), link


@each_page
def test_files_that_are_named_exist(page):
    for text in code_of(page):
        if PLACE.fullmatch(text):
            assert list(ROOT.glob(text.rstrip("/"))), text


@each_page
def test_configs_are_accepted(page, tmp_path):
    for number, text in enumerate(blocks(page, "yaml")):
        path = tmp_path / f"{number}.yaml"
        path.write_text(text)
        read_config(path)


@each_page
def test_python_is_python(page):
    for text in blocks(page, "python"):
        compile(text, page.name, "exec")


@each_page
def test_commands_are_accepted(page):
    for text in code_of(page):
        for words in re.findall(r"\brodsweep ((?:run|merge|check|show|plot|bench|arm)\b.*)", text):
            assert accepts(shlex.split(words)), text
        if text.startswith("--") and not text.startswith(NOT_OURS):
            assert is_option(shlex.split(text)), text


@each_page
def test_targets_of_make_exist(page):
    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)
    for text in code_of(page):
        for target in re.findall(r"\bmake ([a-z-]+)", text):
            assert target in targets, text


@each_page
def test_keys_exist(page):
    for text in code_of(page):
        found = re.fullmatch(rf"(parameters|{TASKS})\.(\w+)([:=> ].*)?", text)
        if found:
            section, key = found.group(1, 2)
            owners = (
                CONFIG_CLASSES_BY_TASK.values()
                if section == "parameters"
                else [CONFIG_CLASSES_BY_TASK[section]]
            )
            assert any(key in owner.model_fields[section].annotation.model_fields for owner in owners), text


def test_developers_read_the_order_of_the_packages_that_is_enforced():
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    layers = next(contract["layers"] for contract in contracts if contract["id"] == "layers")
    order = " < ".join(re.sub(r"\(rodsweep\.(\w+)\)", r"\1", layer) for layer in reversed(layers))
    assert f"    {order}\n" in (DOCS / "developers.md").read_text()


IDENTIFIER = re.compile(r"(?:rs\.)?([A-Za-z]\w*)")
PLACED_NAMES = re.compile(r"((?:`\w+`(?:, | and |, and )?)+) in `(rodsweep/[\w/]+\.py)`")
"""Names said to be in a module, such as "`LAWS` and `law_of` in `rodsweep/model/material/laws.py`"."""
NAMES_OF_OTHERS = {"Makefile", "NamedTuple", "TypeError", "kernel", "long", "survey_only"}
"""Names on the developers' page of a file, of Python, of marks of pytest, and of the tests' own mark."""


def names_defined(path: Path) -> set[str]:
    """Functions, classes, constants, fields and attributes that a module of the package defines."""
    tree = ast.parse(path.read_text())
    scopes = [tree, *(node for node in ast.walk(tree) if isinstance(node, ast.ClassDef))]
    names = {target.id for scope in scopes for line in scope.body for target in assigned(line)}
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            names.add(node.attr)
    return names


def assigned(line: ast.stmt) -> list[ast.Name]:
    """The plain names that a line assigns or annotates."""
    if not isinstance(line, ast.Assign | ast.AnnAssign):
        return []
    return [node for node in ast.walk(line) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)]


def test_developers_read_names_that_exist():
    """Names of the package in backticks; names said to be in a module are defined there."""
    page = DOCS / "developers.md"
    defined = {str(path.relative_to(ROOT)): names_defined(path) for path in ROOT.glob("rodsweep/**/*.py")}
    packages = {path.name for path in (ROOT / "rodsweep").iterdir()}
    tests = "".join(path.read_text() for path in ROOT.glob("tests/**/test_*.py"))
    known = set().union(*defined.values(), re.findall(r"^def (test_\w+)", tests, re.MULTILINE))
    known |= packages | set(commands.commands) | NAMES_OF_OTHERS
    named = [found.group(1) for text in code_of(page) if (found := IDENTIFIER.fullmatch(text))]
    assert len(named) > 30
    assert [name for name in named if name not in known] == []
    placed = PLACED_NAMES.findall(page.read_text())
    assert len(placed) > 5
    for names, module in placed:
        assert set(re.findall(r"\w+", names.replace(" and ", " "))) <= defined[module], module


def test_gallery_and_commands_are_those_of_the_code():
    for page, text in script("generated").PAGES.items():
        assert page.read_text() == text(), "write it anew: python docs/generated.py"


def test_the_gallery_shows_every_picture_of_a_config():
    shown = set(re.findall(r"\]\((\w+\.(?:png|gif))\)", (DOCS / "gallery.md").read_text()))
    pictures = {path.name for ending in ("png", "gif") for path in DOCS.glob(f"*.{ending}")}
    assert shown == {name for name in pictures if not name.startswith("bench_")}


def test_reference_is_that_of_the_code():
    for page, text in reference().pages().items():
        assert page.read_text() == text, "write it anew: python docs/reference.py"


@pytest.mark.parametrize("task", CONFIG_CLASSES_BY_TASK)
def test_other_parameters_are_refused(task, tmp_path):
    """What the table of parameters does not list for a task its config does not take."""
    config = reference().whole(task).config
    path = tmp_path / "config.yaml"
    path.write_text(f"task: {task}\n{textwrap.dedent(reference().WHOLE[task])}\n")
    for name in ("F", "k1", "k2", "gamma3", "gamma1"):
        if getattr(config.parameters, name) is None:
            with pytest.raises(InputError, match=name):
                read_config(path, (f"parameters.{name}=1",))


@pytest.mark.long
def test_every_attribute_of_a_file_is_explained(command):
    command.write("a.yaml", "task: spectrum\nparameters: {F: 1, k1: 9, k2: 9, gamma3: 1}")
    assert command.afresh("run", "a.yaml").returncode == 0
    explained = {name for names in reference().ATTRIBUTES for name in names.split(", ")}
    with h5py.File(command.directory / "a.h5") as file:
        assert set(file.attrs) | SOMETIMES == explained


PRINTED = re.compile(r"^```python\n(.*?)^```\n(?:\n```text\n(.*?)^```)?", re.MULTILINE | re.DOTALL)
"""A block of Python and, where one follows, the block of what it prints."""
NUMBER = re.compile(r"-?\d+\.?\d*(?:e[+-]?\d+)?")


@pytest.mark.long
def test_python_page_prints_what_it_says(tmp_path, monkeypatch, capsys):
    """But for the last digits, which are the processor's."""
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for code, text in PRINTED.findall((DOCS / "python.md").read_text()):
        if "ranks=" in code and not (RODS and shutil.which("mpiexec")):
            continue  # two processes that load all there is; `test_api.py` asks two ranks for the same
        exec(compile(code, "python.md", "exec"), names)
        printed = capsys.readouterr().out
        assert NUMBER.sub("#", printed).split() == NUMBER.sub("#", text).split()
        numbers = [np.array(NUMBER.findall(each), float) for each in (printed, text)]
        assert numbers[0] == pytest.approx(numbers[1], rel=1e-5, abs=ROUNDING)


def test_bibtex_says_what_the_citation_file_says():
    cited = parsed_yaml((ROOT / "CITATION.cff").read_text(), "CITATION.cff")
    (paper,) = cited["references"]
    (block,) = blocks(DOCS / "citing.md", "bibtex")
    fields = [dict(re.findall(r"(\w+) += \{+(.*?)\}+,?\n", entry)) for entry in block.split("\n\n")]
    assert [fields[0][name] for name in ("title", "journal", "doi")] == [
        paper[name] for name in ("title", "journal", "doi")
    ]
    names = (f"{author['family-names']}, {author['given-names']}" for author in paper["authors"])
    assert fields[0]["author"] == " and ".join(names)
    assert fields[0]["year"] == str(paper["year"])
    assert f"arXiv:{fields[0]['eprint']}" == paper["identifiers"][0]["value"]
    assert (fields[1]["title"], fields[1]["version"]) == (cited["title"], str(cited["version"]))
