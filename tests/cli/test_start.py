"""The command started afresh, as users start it, beside the loaded one from which other tests fork it."""

import os
import re
import signal
import subprocess
import sys

import pytest
from contents import content, same
from faults import small
from surveyed import RODS, only

TASKS = [name for name in small.CONFIGS if name != "list"]
SOLVED = (("run", "c.yaml"), ("show", "c.h5"))
LINES = (("check", "c.yaml"), *SOLVED, ("plot", "c.h5"))
DRAWN = TASKS if RODS else ["thresholds"]
"""Tasks whose config is checked and whose figure is drawn afresh too: starts take most of it, and matplotlib.
`make survey` takes all."""
PROGRESS = re.compile(r"\d+ of \d+ points(, (\d[\d.e+]*/s|[\d.]+ \w+ per point))?(, about [\d.]+ \w+ left)?")
"""The only thing that belongs on standard error, where a run takes its time."""


def without_numbers(text):
    """A text without what differs from run to run: times with their units, dates, and the room of both."""
    numbered = " ".join(re.sub(r"[\d.:+-]+(e[+-]?\d+)?", "#", text).split())
    return re.sub(r"# (ms|min|h)\b", "# s", numbered)


@pytest.mark.long
@pytest.mark.parametrize("task", only(["thresholds"], TASKS))
def test_every_command_does_the_same_started_afresh_and_loaded(command, task):
    """What is imported late is imported by whoever needs it, for every task."""
    lines = LINES if task in DRAWN else SOLVED
    ends = []
    for name in ("afresh", "loaded"):
        there = command.in_directory(command.directory / name)
        there.directory.mkdir()
        there.write("c.yaml", small.CONFIGS[task])
        start = there.afresh if name == "afresh" else there
        done = [start(*words) for words in lines]
        assert [end.returncode for end in done] == [0] * len(lines)
        told = [line for end in done for line in end.stderr.splitlines()]
        assert [line for line in told if not PROGRESS.fullmatch(line)] == []
        ends.append([without_numbers(end.stdout) for end in done])
    assert ends[0] == ends[1]
    files = [command.directory / name / "c.h5" for name in ("afresh", "loaded")]
    assert same(*map(content, files))
    if task not in DRAWN:
        return
    pictures = [path.with_name("c.png").read_bytes() for path in files]
    assert pictures[0] == pictures[1]


CTRL_C_DURING_AN_IMPORT = """
import os, signal, sys

class Interrupting:
    def find_spec(self, name, path, target=None):
        if name == sys.argv[1]:
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Interrupting())
import rodsweep.cli
print(signal.getsignal(signal.SIGINT) is signal.default_int_handler)
"""


@pytest.mark.parametrize("module", ["click", "rodsweep.cli.command_line", "no module"])
def test_ctrl_c_while_the_program_is_loaded_ends_it_without_a_traceback(module):
    done = subprocess.run(
        [sys.executable, "-c", CTRL_C_DURING_AN_IMPORT, module], capture_output=True, text=True, check=False
    )
    assert done.stderr == ""
    assert (done.returncode, done.stdout) == (
        (0, "True\n") if module == "no module" else (-signal.SIGINT, "")
    )


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_run_whose_output_nobody_reads_is_complete_and_says_so_by_its_status(tmp_path, unbuffered):
    (tmp_path / "c.yaml").write_text(small.CONFIGS["spectrum"])
    reader, writer = os.pipe()
    os.close(reader)
    for words in (("run", "c.yaml"), ("show", "c.h5")):
        done = subprocess.run(
            [sys.executable, "-m", "rodsweep", *words],
            cwd=tmp_path,
            stdout=writer,
            stderr=writer,
            env=os.environ | {"PYTHONUNBUFFERED": unbuffered},
            check=False,
        )
        assert done.returncode == 0
    os.close(writer)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["c.h5", "c.yaml"]
