"""Result files that another program, a disk or a user changed: refused in a sentence, or the same numbers.

Eight random edits of a file of each task here; RODSWEEP_CASES=N asks for N times as many.
"""

import os
import shutil
import subprocess
import sys
from random import Random

import h5py
import numpy as np
import pytest
from contents import content, same
from faults.edits import copied, edited

from rodsweep.api.dataset import open_result
from rodsweep.errors import InputError
from rodsweep.results.file.combination.merge import merge
from rodsweep.results.file.result_file_writer import ResultFileWriter
from rodsweep.results.file.view import read_view
from rodsweep.tasks.running.job import job_of_file, plan_without_solver

CONFIGS = {
    "spectrum": """
task: spectrum
parameters: {F: [10, 30], k1: [200, 1.0e4], k2: [50, 1.0e4], gamma3: 1.0e-4}
spectrum: {modes: 2}
""",
    "thresholds": """
task: thresholds
parameters: {k1: [100, 1.0e4], k2: 1.0e4, gamma3: 1.0e-4}
""",
    "branch": """
task: branch
parameters: {k1: 150, k2: 1.0e4, gamma3: 1.0e-4}
accuracy: 1.0e-4
""",
    "limit_cycle": """
task: limit_cycle
parameters: {F: [40, 41], k1: 1.0e4, k2: 1.0e2, gamma3: 1.0e-2}
limit_cycle: {start: neighbour, samples: 8}
accuracy: 1.0e-3
""",
}
EDITS = 8 * int(os.environ.get("RODSWEEP_CASES", "1"))
LONGEST_REFUSAL = 600
"""Characters of a refusal in a directory with a long name."""


@pytest.fixture(scope="module")
def results(tmp_path_factory, loaded):
    """A whole file of each task with its config, in one directory."""
    directory = tmp_path_factory.mktemp("whole")
    for name, text in CONFIGS.items():
        (directory / f"{name}.yaml").write_text(text)
        ended = loaded(directory, "run", f"{name}.yaml", "-q", seconds=None, memory=None)
        assert ended.status == 0, ended.err
    return directory


def plan_for(results, name):
    """The plan of a config; the words of the statuses do not matter to what is continued."""
    job = job_of_file(results / f"{name}.yaml", ())
    return plan_without_solver(job.config, job.points)


def numbers_shown(path):
    """What the view that `show`, `plot` and `export` work on has; user's own variables are not in it."""
    return {name: array for name, array in dict(read_view(path).variables).items() if name != "seconds"}


def numbers_opened(path):
    """What `rs.open` has beside the user's own variables."""
    variables = {str(name): variable.values for name, variable in open_result(path).variables.items()}
    return {n: v for n, v in variables.items() if n != "seconds" and not n.startswith("user_")}


def numbers_continued(path, plan):
    store = ResultFileWriter(path, plan)
    try:
        assert store.missing_ranges() == []
    finally:
        store.close()
    return numbers_shown(path)


def numbers_merged(path):
    merge(path.with_name("m.h5"), [path], plan_without_solver)
    return numbers_shown(path.with_name("m.h5"))


def told(look, whole):
    """(whether a door refuses an edited file, what is wrong with what it says; empty if nothing is)."""
    try:
        found = look()
    except InputError as refusal:
        sentence = str(refusal)
        good = sentence.isprintable() and len(sentence) < LONGEST_REFUSAL
        return True, "" if good else f"refuses in no sentence: {sentence!r}"
    except Exception as error:  # whatever else: a traceback for the user
        return False, f"raises {type(error).__name__}: {error}"
    return False, "" if same(found, whole) else "shows other numbers"


@pytest.mark.parametrize("name", CONFIGS)
def test_edited_file_is_refused_in_a_sentence_or_says_the_same(results, tmp_path, name):
    whole, plan = content(results / f"{name}.h5"), plan_for(results, name)
    complaints, refused = [], 0
    for seed in range(EDITS):
        path = copied(results / f"{name}.h5", tmp_path / "a")
        what = edited(path, Random(f"{name} {seed}"))
        before = path.read_bytes()
        doors = {
            "show": lambda path=path: numbers_shown(path),
            "open": lambda path=path: numbers_opened(path),
            "merge": lambda path=path: numbers_merged(path),
            "run": lambda path=path: numbers_continued(path, plan),
        }
        found = {door: told(look, whole) for door, look in doors.items()}
        complaints += [f"seed {seed}, {what}: {door} {why}" for door, (_, why) in found.items() if why]
        is_refused, _ = found["show"]
        refused += is_refused
        others = [door for door, (refuses, _) in found.items() if refuses != is_refused]
        if others:
            complaints.append(f"seed {seed}, {what}: show and {others} do not agree whether it is whole")
        if is_refused and path.read_bytes() != before:
            complaints.append(f"seed {seed}, {what}: the refused file is changed")
    assert not complaints, f"{len(complaints)} complaints\n" + "\n".join(complaints[:20])
    assert refused > EDITS / 2


def test_a_dimension_that_refers_to_nothing_is_refused(results, tmp_path):
    path = tmp_path / "c.h5"
    shutil.copy(results / "spectrum.h5", path)
    with h5py.File(path, "r+") as file:
        data, kind = file["status"], h5py.vlen_dtype(h5py.ref_dtype)
        nowhere = np.empty(data.ndim, object)
        for axis in range(data.ndim):
            nowhere[axis] = np.array([h5py.Reference()], h5py.ref_dtype)
        del data.attrs["DIMENSION_LIST"]
        data.attrs.create("DIMENSION_LIST", nowhere, dtype=kind)
    with pytest.raises(InputError, match="the dimensions of status were changed after rodsweep wrote them"):
        read_view(path)


def test_a_file_that_another_process_writes_is_named_as_such(results, tmp_path):
    """The sentence said that the content differs from the checksum, though the file is whole."""
    path = tmp_path / "open.h5"
    shutil.copy(results / "spectrum.h5", path)
    code = "import h5py, sys; f = h5py.File(sys.argv[1], 'r+'); print('open', flush=True); sys.stdin.read()"
    with subprocess.Popen(
        [sys.executable, "-c", code, path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as writer:
        assert writer.stdout.readline() == "open\n"
        with pytest.raises(InputError, match="another process has it open for writing; close it there"):
            open_result(path)
        writer.stdin.close()
    assert open_result(path).sizes
