"""README.md, docs/tasks, docs/howto, docs/arm.md: each command of a page is run; its output is the page's.

A page is run from top to bottom in a directory of its own, which has the configs of the clone. Pages with
configs that take long are run by `make survey`; `tests/test_paper.py` runs these configs on coarser grids.
"""

import re
import shlex
from contextlib import redirect_stdout
from io import StringIO

import numpy as np
import pytest
from conftest import ROOT
from printed import ROUNDING
from surveyed import survey_only

DOCS = ROOT / "docs"
PAGES = [*sorted((DOCS / "tasks").glob("*.md")), *sorted((DOCS / "howto").glob("*.md"))]
LONG_PAGES = (
    "branch", "limit_cycle", "phase_diagram", "criticality", "amplitude-map", "thresholds", "modes",
    "configs", "reports", "figures",
)  # fmt: skip
"""Names of pages whose commands take longer than all others together."""
CLUSTER = ROOT / "tests" / "cluster" / "test_slurm.py"
BAD_INPUT = 2
"""Exit status of a refused command."""
REFUSED = re.compile("rodsweep: ")
"""Start of the line with which a page says that a command is refused."""
FILE_NAME = re.compile(r"# (\S+\.(?:yaml|csv))\n")
"""First line of a block that is a file."""
NAME_BEFORE = re.compile(r"[Tt]he file `(\S+\.(?:yaml|csv))`:\n\n$")
"""End of the text before a block that is a file."""
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"-?\d+\.?\d*(?:e[+-]?\d+)?")


ERROR = re.compile(r" \(\+- [^)]*\)")
"""An error estimate beside a number, of which rounding decides."""


def alike(said, come):
    """Whether a line is as the page says, but for the last digits; `...` at its end stands for more."""
    said, come = ERROR.sub("", said), ERROR.sub("", come)
    begins = said.removesuffix("...")
    words = [" ".join(NUMBER.sub("#", text).split()) for text in (begins, come)]
    if not (words[1].startswith(words[0]) if begins != said else words[0] == words[1]):
        return False
    first, second = (np.array(NUMBER.findall(text), float) for text in (begins, come))
    return first == pytest.approx(second[: len(first)], rel=1e-3, abs=ROUNDING)


def missing(said, come):
    """The first line of the page that does not come; None where all do, in their order."""
    come, skip = list(come), False
    for line in said:
        if line == "...":
            skip = True
            continue
        while come and skip and not alike(line, come[0]):
            come.pop(0)
        if not come or not alike(line, come.pop(0)):
            return line
        skip = False
    return None if skip or not come else f"nothing, but there is {come[0]!r}"


def typed(text):
    """(command, lines that come) of a console block."""
    command, *blocks = re.split(r"^\$ ", text.replace("\\\n", ""), flags=re.MULTILINE)
    assert command == ""
    for block in blocks:
        first, *rest = block.rstrip("\n").split("\n")
        yield first, rest


def output_of(command, line, status=0):
    """The lines that a command of the page writes; `>`, `head` and `mpiexec` as a shell has them.

    AssertionError if the command ends with another status.
    """
    words = shlex.split(line)
    if words[0] == "head":
        return (command.directory / words[-1]).read_text().splitlines()[: int(words[2])]
    ranks = 0
    if words[:2] == ["mpiexec", "-n"]:
        ranks, words = int(words[2]), words[3:]
    assert words[0] == "rodsweep"
    into = words[words.index(">") + 1] if ">" in words else ""
    done = command(*words[1 : words.index(">")] if into else words[1:], ranks=ranks)
    assert done.returncode == status, done.stderr
    if into:
        command.write(into, done.stdout)
        return []
    return [row.rstrip() for row in (done.stderr if status else done.stdout).splitlines()]


def run_page(command, page):
    """Runs the blocks of a page from top to bottom; AssertionError for the first that does not hold."""
    names, printed = {}, None
    whole = page.read_text()
    for block in BLOCK.finditer(whole):
        language, text = block.groups()
        if named := NAME_BEFORE.search(whole[: block.start()]):
            command.write(named[1], text)
        elif file := FILE_NAME.match(text):
            command.write(file[1], text if language == "yaml" else text[file.end() :])
        elif language == "python":
            with redirect_stdout(StringIO()) as stream:
                exec(compile(text, page.name, "exec"), names)
            printed = stream.getvalue().splitlines()
        elif language == "text" and printed is not None:
            assert missing(text.splitlines(), printed) is None, printed
            printed = None
        for line, said in typed(text) if language == "console" else ():
            come = output_of(command, line, BAD_INPUT if said[:1] and REFUSED.match(said[0]) else 0)
            assert missing(said, come) is None, (line, come)


@pytest.mark.long
@pytest.mark.parametrize(
    "page",
    [
        pytest.param(page, marks=survey_only if page.stem in LONG_PAGES else (), id=page.stem)
        for page in (ROOT / "README.md", *PAGES)
    ],
)
def test_page_says_what_comes(command, monkeypatch, page):
    monkeypatch.chdir(command.directory)
    monkeypatch.setenv("MPLBACKEND", "agg")
    (command.directory / "configs").symlink_to(ROOT / "configs")
    run_page(command, page)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: f"{page.parent.name}/{page.stem}")
def test_every_command_of_a_page_is_run(page):
    """In a block of the console; commands for Slurm are run by the tests of the cluster."""
    text = page.read_text()
    outside = re.sub(r"^```console\n.*?^```", "", text, flags=re.MULTILINE | re.DOTALL)
    commands = [
        line.strip()
        for line in outside.splitlines()
        if re.match(r"(\s*|array=\$\()(rodsweep|mpiexec|sbatch) ", line)
    ]
    for line in commands:
        (script,) = re.findall(r"jobs/\w+\.sh", line)
        assert script in CLUSTER.read_text()


def test_a_line_that_does_not_come_is_seen():
    come = ["a 1", "b 2.0001", "c"]
    assert missing(["a 1", "...", "c"], come) is None
    assert missing(["...", "b 2", "..."], come) is None
    assert missing(["a 1", "c"], come) == "c"
    assert missing(["...", "b 3", "..."], come) == "b 3"
    assert missing(["a...", "b 2.0...", "c"], come) is None
    assert missing(["a...", "b 3...", "c"], come) == "b 3..."
    assert missing(["a 1 (+- 2e-13)"], ["a 1 (+- 3e-13)"]) is None
    assert missing(["a 2 (+- 2e-13)"], ["a 1 (+- 2e-13)"]) == "a 2 (+- 2e-13)"
    assert missing(["a 1"], come) == "nothing, but there is 'b 2.0001'"


@survey_only
def test_arm_page_says_what_comes(command):
    text = (ROOT / "docs" / "arm.md").read_text()
    said = [pair for language, block in BLOCK.findall(text) if language == "console" for pair in typed(block)]
    assert len(said) >= 5
    for line, lines in said:
        assert missing(lines, output_of(command, line)) is None
