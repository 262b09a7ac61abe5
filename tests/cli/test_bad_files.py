"""Damaged result files and journals: `show`, `plot`, `run`, `merge` never crash, hang or lose what was whole.

They do their work right, to the last bit, or refuse in one sentence and leave the file as it is. Some hundred
damages here; RODSWEEP_CASES=N asks for N times as many of those drawn at random.
"""

import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from random import Random

import h5py
import pytest
from conftest import BIN
from faults import small
from faults.damages import (
    ADDITIONS,
    BYTES,
    JOURNALS,
    MISFITS,
    ODD_NUMBERS,
    OF_CHAINS,
    foreign,
    obstacles,
)
from faults.isolated import Isolated, Outcome
from surveyed import few

from rodsweep.results.file.seal import seal

MORE = int(os.environ.get("RODSWEEP_CASES", "1"))
FILES = PAGES = 2 * MORE if MORE > 1 else 1
"""Damaged files of each config and state, and damaged journals of each: of every kind over all configs."""
QUICK_TO_DRAW = ("spectrum", "list", "thresholds")
"""Configs whose damaged files are drawn in every run of the tests: other figures take most of it."""
LONG = 30
"""Seconds of processor time: a run with limit cycles takes two."""


@dataclass(frozen=True)
class Results:
    """Files of every small config, whole and interrupted, and the command to try on damaged ones."""

    run: Isolated
    directory: Path
    content: dict[str, dict]
    """What the whole file of each config holds."""

    def copied(self, name, state, to):
        """A copy of a config and its file, in a state, in a directory of its own; the path of the file."""
        shutil.rmtree(to, ignore_errors=True)
        to.mkdir()
        shutil.copy(self.directory / "points.csv", to)
        shutil.copy(self.directory / f"{name}.yaml", to / "c.yaml")
        path = self.directory / f"{name}-{state}.h5"
        shutil.copy(path, to / "c.h5")
        if state == "half":
            shutil.copytree(path.with_name(path.name + ".journal"), to / "c.h5.journal")
        return to / "c.h5"


@pytest.fixture(scope="module")
def results(tmp_path_factory, loaded):
    run, directory = loaded, tmp_path_factory.mktemp("results")
    (directory / "points.csv").write_text(small.POINTS)
    paths = [directory / f"{name}.yaml" for name in small.CONFIGS]
    for path in paths:
        path.write_text(small.CONFIGS[path.stem])
    content = {}
    for path in paths:
        name = path.stem
        whole = run(directory, "run", path.name, "-o", f"{name}-whole.h5", seconds=LONG)
        assert whole.status == 0, whole.err
        content[name] = run.content(directory / f"{name}-whole.h5")
        assert len(content[name]) > 10
        words = ("run", path.name, "-o", f"{name}-half.h5")
        for _ in range(2):  # the second folds the point of the first: one is in the file, one beside it
            assert run(directory, *words, seconds=LONG, points=1).status == -9
    return Results(run, directory, content)


def shared(of, name, each):
    """A config's share of all cases: each is tried on `each` configs, or on all where more are asked for."""
    place = list(small.CONFIGS).index(name)
    return [case for i, case in enumerate(of) if MORE > 1 or (place - i) % len(small.CONFIGS) < each]


def kinds(name, count, first=0):
    """So many kinds of damage in turn, at another one first for every other config."""
    start = first + count * list(small.CONFIGS).index(name)
    return [BYTES[(start + number) % len(BYTES)] for number in range(count)]


@pytest.fixture(params=list(small.CONFIGS))
def name(request):
    return request.param


def after_run(results, path, name):
    """What is wrong with a run on a damaged file; empty if nothing is."""
    before = path.read_bytes()
    outcome = results.run(path.parent, "run", "c.yaml", seconds=LONG)
    if outcome.fault:
        return outcome.fault
    if outcome.status == 0:
        return "" if results.run.content(path) == results.content[name] else "run gives another content"
    if outcome.status not in (2, 3):
        return f"run ends with status {outcome.status}"
    return "" if path.read_bytes() == before else f"run refuses, yet changes the file: {outcome.err}"


def after_look(results, path, name, words):
    """What is wrong with showing or drawing a file: shown is only what is not damaged."""
    outcome = results.run(path.parent, *words, seconds=LONG)
    if outcome.fault:
        return outcome.fault
    if outcome.status == 0:
        same = results.run.content(path) == results.content[name]
        return "" if same else f"{words[0]} shows another content"
    return "" if outcome.status == 2 else f"{words[0]} ends with status {outcome.status}: {outcome.err}"


def report(complaints):
    """The first complaints, each with its damage."""
    return f"{len(complaints)} damages:\n" + "\n".join(complaints[:20])


SHOW, RUN, MERGE = ("show", "c.h5"), ("run", "c.yaml"), ("merge", "m.h5", "c.h5")


def plot_of(name):
    """The words that draw a file, of modes those of one rod: three take as long as all else."""
    return ("plot", "c.h5", "-o", "c.png", *(("--at", "F=10") if name == "modes" else ()))


def drawn(name, statuses):
    """The lines that draw a file, none where figures take long and no more cases are asked for."""
    return [(plot_of(name), statuses)] if MORE > 1 or name in QUICK_TO_DRAW else []


def test_damaged_file_is_refused_and_left_as_it_is_or_repaired(results, tmp_path, name):
    complaints = []
    rng = Random(f"files {name}")
    pairs = zip(kinds(name, FILES), kinds(name, FILES, first=2), strict=True)
    for number, (damage, other) in enumerate(pairs):
        data = damage((results.directory / f"{name}-whole.h5").read_bytes(), rng)
        half = other((results.directory / f"{name}-half.h5").read_bytes(), rng)
        path = results.copied(name, "whole", tmp_path / "a")
        path.write_bytes(data)
        looks = (SHOW, *(words for words, _ in drawn(name, {0}))) if name != "list" else ()
        found = [after_look(results, path, name, words) for words in looks]
        found.append(after_run(results, path, name))
        path = results.copied(name, "half", tmp_path / "b")
        path.write_bytes(half)
        found += [results.run(path.parent, "show", "c.h5").fault, after_run(results, path, name)]
        complaints += [f"{damage.__name__}, {other.__name__} {number}: {why}" for why in found if why]
    assert not complaints, report(complaints)


@pytest.mark.long
def test_damaged_journal_is_used_as_far_as_it_is_whole(results, tmp_path, name):
    complaints = []
    rng = Random(f"pages {name}")
    for number, damage in enumerate(kinds(name, PAGES, first=2)):
        path = results.copied(name, "half", tmp_path / "a")
        pages = sorted(page for page in Path(f"{path}.journal").iterdir() if page.stat().st_size)
        page = rng.choice(pages)
        page.write_bytes(damage(page.read_bytes(), rng))
        shown = results.run(path.parent, "show", "c.h5")
        ended = results.run(path.parent, "run", "c.yaml", seconds=LONG)
        what = f"{damage.__name__} {number} of {page.name[:5]}"
        if shown.fault or ended.fault or (shown.status, ended.status) != (0, 0):
            complaints.append(f"{what}: {shown.fault} {ended.fault} {shown.err} {ended.err[-200:]}")
        elif results.run.content(path) != results.content[name]:
            complaints.append(f"{what}: another content")
        elif Path(f"{path}.journal").exists():
            complaints.append(f"{what}: the journal is left")
    assert not complaints, report(complaints)


@pytest.mark.long
@pytest.mark.parametrize("name", few(["limit_cycle", "list"], 1), indirect=True)
def test_odd_things_among_the_journals_do_no_harm(results, tmp_path, name):
    complaints = []
    for oddity in OF_CHAINS if name == "limit_cycle" else list(JOURNALS)[:: 1 if MORE > 1 else 2]:
        path = results.copied(name, "half", tmp_path / "a")
        journal = Path(f"{path}.journal")
        JOURNALS[oddity](journal)
        shown = results.run(path.parent, "show", "c.h5")
        ended = results.run(path.parent, "run", "c.yaml", seconds=LONG)
        why = shown.fault or ended.fault
        if not why and ended.status:  # refused: the file is whole, and all is well once the oddity is gone
            journal.unlink() if journal.is_symlink() or journal.is_file() else shutil.rmtree(journal)
            ended = results.run(path.parent, "run", "c.yaml", seconds=LONG)
        if not why and results.run.content(path) != results.content[name]:
            why = f"another content: {ended.err}"
        if why or shown.status not in (0, 3) or (tmp_path / "a" / "points.csv").read_text() != small.POINTS:
            complaints.append(f"{oddity}: {why} {shown.err}")
    assert not complaints, report(complaints)


LINES = (
    ("show", "FILE"), ("plot", "FILE"), ("merge", "m.h5", "FILE"), ("merge", "FILE", "c.h5"),
    ("run", "c.yaml", "-o", "FILE"), ("run", "c.yaml", "--fresh", "-o", "FILE"),
)  # fmt: skip


@pytest.mark.long
def test_what_is_no_result_is_refused_and_left_alone(results, tmp_path):
    directory = tmp_path / "a"
    results.copied("spectrum", "whole", directory)
    complaints = []
    for path in [*foreign(directory, Random(1)), *obstacles(directory)]:
        before = path.read_bytes() if path.suffix == ".h5" else b""
        for line in LINES:
            words = [word.replace("FILE", path.name) for word in line]
            outcome = results.run(directory, *words)
            ours = "--fresh" in words and outcome.status == 0 and before.startswith(b"\x89HDF")
            if outcome.fault or (outcome.status not in (2, 3) and not ours):
                complaints.append(f"{' '.join(words)}: {outcome.fault or outcome.status}")
            elif not ours and path.suffix == ".h5" and path.read_bytes() != before:
                complaints.append(f"{' '.join(words)} changes it")
        assert not (directory / "m.h5").exists()
    assert not complaints, report(complaints)


def changed(results, name, state, change, to):
    """A copied file after another program has changed it."""
    path = results.copied(name, state, to)
    with h5py.File(path, "r+") as file:
        change(file)
    return path


def tried(results, path, what, lines):
    """What is wrong with commands of which each is to end with one of some statuses."""
    complaints = []
    for words, statuses in lines:
        outcome = results.run(path.parent, *words, seconds=LONG)
        if outcome.fault or outcome.status not in statuses:
            complaints.append(f"{what}, {words[0]}: {outcome.fault or outcome.status} {outcome.err}")
    return complaints


@pytest.mark.long
def test_result_that_another_program_made_unfit_is_refused(results, tmp_path, name):
    complaints = []
    for number, (edit, change) in enumerate(shared(MISFITS.items(), name, 1)):
        path = changed(results, name, "whole", change, tmp_path / "a")
        before = path.read_bytes()
        read = (SHOW, MERGE, plot_of(name)) if MORE > 1 else [(SHOW, MERGE, plot_of(name))[number % 3]]
        lines = [(words, {2}) for words in (RUN, *read)]
        complaints += tried(results, path, edit, lines)
        if path.read_bytes() != before:
            complaints.append(f"{edit}: the file is changed")
    assert not complaints, report(complaints)


@pytest.mark.long
def test_result_with_odd_numbers_is_shown_and_continued(results, tmp_path, name):
    complaints = []
    for edit, change in shared(ODD_NUMBERS.items(), name, 1):
        path = changed(results, name, "whole", change, tmp_path / "a")
        seal(path)
        # No figure can show some of these numbers, and a run tells of statuses that it does not know.
        lines = [(SHOW, {0}), (plot_of(name), {0, 2}), (RUN, {0, 1}), (SHOW, {0})]
        complaints += tried(results, path, edit, lines)
    assert not complaints, report(complaints)


@pytest.mark.long
def test_interrupted_result_to_which_the_user_added_is_continued(results, tmp_path, name):
    complaints = []
    for addition, add in shared(ADDITIONS.items(), name, 1):
        path = changed(results, name, "half", add, tmp_path / "a")
        lines = [(SHOW, {0}), (RUN, {0}), (SHOW, {0}), *drawn(name, {0}), (MERGE, {0})]
        complaints += tried(results, path, addition, lines)
        if results.run.content(path) != results.content[name]:
            complaints.append(f"{addition}: another content")
    assert not complaints, report(complaints)


@pytest.mark.long
@pytest.mark.parametrize("number", range(6 if MORE > 1 else 2))
def test_the_command_itself_refuses_a_damaged_file(results, tmp_path, number):
    rng = Random(number)
    path = results.copied("spectrum", "half" if number % 2 else "whole", tmp_path / "a")
    path.write_bytes(BYTES[number % len(BYTES)](path.read_bytes(), rng))
    before = path.read_bytes()
    words = [("show", "c.h5"), ("plot", "c.h5"), ("run", "c.yaml")][number % 3]
    ended = subprocess.run(
        [BIN / "rodsweep", *words], cwd=path.parent, capture_output=True, text=True, timeout=300, check=False
    )
    outcome = Outcome(ended.returncode, False, ended.stdout, ended.stderr)
    assert outcome.fault == ""
    assert outcome.status == 2 or results.run.content(path) == results.content["spectrum"]
    assert path.read_bytes() == before or outcome.status == 0
