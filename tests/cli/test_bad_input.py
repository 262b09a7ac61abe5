"""Bad input by the hundred: one clear sentence and status 2, or it is valid; no traceback, no hang, no solve.

Some hundred cases of every kind here; RODSWEEP_CASES=N asks for N times as many of those drawn at random.
"""

import os
import re
import socket
import subprocess
from contextlib import closing
from functools import cache
from random import Random

import pytest
from conftest import BIN, ROOT
from faults import configs
from faults.isolated import Outcome, isolated
from faults.points import GOOD, bad_lists

CONFIGS = sorted((ROOT / "configs").glob("*.yaml"))
MORE = int(os.environ.get("RODSWEEP_CASES", "1"))
DRAWN = {
    "wrong values": (configs.wrong_values, 6 if MORE > 1 else 2),
    "wrong overrides": (configs.wrong_overrides, 3),
    "odd keys": (configs.odd_keys, 3),
    "random trees": (configs.random_tree, 3),
    "random texts": (configs.random_text, 3),
}
"""Kinds of which so many cases are drawn for each config."""
SPREAD = {
    "odd overrides": configs.odd_overrides,
    "explosions": configs.explosions,
    "odd bytes": configs.odd_bytes,
}
"""Kinds of which every case is tried, on one config or the other."""
NAMED = re.compile(r"rodsweep: ('?c\.yaml|--set |'--set )")
"""How a refusal begins: with the file or the override."""


@pytest.fixture(scope="module")
def run():
    with isolated(CONFIGS) as run:
        yield run


@cache
def cases_of(kind):
    """The cases of a kind, the same ones every time."""
    cases = []
    for i, path in enumerate(CONFIGS):
        rng, tree = Random(f"{kind} {path.stem}"), configs.tree_of(path)
        if kind in SPREAD:
            make = SPREAD[kind]
            every = list(make(tree, rng) if make is configs.odd_bytes else make(tree))
            cases += every[i :: len(CONFIGS)]
            continue
        make, count = DRAWN[kind]
        count *= MORE
        if make is configs.random_tree:
            cases += [make(tree, rng) for _ in range(count)]
        elif make is configs.random_text:
            cases += [make(path.read_bytes(), rng) for _ in range(count)]
        else:
            every = list(make(tree, rng) if make is configs.odd_keys else make(tree))
            cases += rng.sample(every, min(count, len(every)))
    return cases


def words_of(case):
    return [word for override in case.overrides for word in ("--set", override)]


def complaint(outcome, refused, says=""):
    """What is wrong with how a run ended on input that may, or must, be refused; empty if nothing is."""
    if outcome.fault:
        return outcome.fault
    if outcome.status == 0:
        return "it is accepted" if refused else outcome.err and f"it warns: {outcome.err}"
    if outcome.status != 2:
        return f"it ends with status {outcome.status}: {outcome.err}"
    if not NAMED.match(outcome.err) or says not in outcome.err:
        return f"it does not say where, or {says!r}: {outcome.err}"
    return "it prints something beside the refusal" if outcome.out else ""


def report(complaints, total):
    """The first complaints, each with its case."""
    text = "\n".join(f"{name}: {why}" for name, why in complaints[:20])
    return f"{len(complaints)} of {total} cases:\n{text}"


@pytest.mark.long
@pytest.mark.parametrize("kind", [*DRAWN, *SPREAD])
def test_mutated_config_is_refused_in_one_sentence_or_valid(run, tmp_path, kind):
    complaints, cases = [], cases_of(kind)
    assert len(cases) >= 50
    places = [tmp_path / str(number) / "here" for number in range(len(cases))]
    for place, case in zip(places, cases, strict=True):
        place.mkdir(parents=True)
        (place / "c.yaml").write_bytes(case.config)
    runs = [(place, ("check", "c.yaml", *words_of(case))) for place, case in zip(places, cases, strict=True)]
    for place, case, outcome in zip(places, cases, run.several(runs), strict=True):
        why = complaint(outcome, case.refused, case.says)
        left = {path.name for path in place.iterdir()} - {"c.yaml"}
        if why or left:
            complaints.append((case.name, why or f"it leaves {left}"))
    assert not complaints, report(complaints, len(cases))


def test_kinds_have_hundreds_of_cases_and_most_must_be_refused():
    cases = [case for kind in (*DRAWN, *SPREAD) for case in cases_of(kind)]
    assert len(cases) > 500
    assert sum(case.refused for case in cases) > 300


@pytest.mark.long
@pytest.mark.parametrize("path", CONFIGS, ids=lambda path: path.stem)
def test_untouched_configs_are_valid_also_as_the_mutations_write_them(run, tmp_path, path):
    places = [tmp_path / name / "here" for name in ("own", "written")]
    for place, content in zip(
        places, (path.read_bytes(), configs.text_of(configs.tree_of(path))), strict=True
    ):
        place.mkdir(parents=True)
        (place / "c.yaml").write_bytes(content)
    for outcome in run.several([(place, ("check", "c.yaml")) for place in places]):
        assert outcome == Outcome(0, False, outcome.out, "")
        assert outcome.out.startswith("c.yaml: valid")


@pytest.mark.long
def test_guards_see_a_solve(run, tmp_path, no_solver):
    (tmp_path / "c.yaml").write_bytes(CONFIGS[0].read_bytes())
    assert "is imported although nothing is to be solved" in run(tmp_path, "run", "c.yaml").fault
    places = [tmp_path / str(number) / "here" for number in range(3)]
    for place in places:
        place.mkdir(parents=True)
        (place / "c.yaml").write_bytes(CONFIGS[0].read_bytes())
    among = run.several(
        [(place, (word, "c.yaml")) for place, word in zip(places, ("check", "run", "check"), strict=True)]
    )
    assert [end.fault == "" for end in among] == [True, False, True]
    assert the_command(tmp_path, no_solver, "run", "c.yaml").status == MET_SOLVER


RODS = "k2: 1.0e4, gamma3: 1.0e-4"
CHECKED_LATE = {
    "parameters.F reaches 20000": f"parameters: {{F: [10, 2.0e4], k1: 1.0e4, {RODS}}}",
    "parameters.F reaches 3000": f"parameters: {{F: [10, 3.0e3], k1: 1.0e4, taper: 0.5, {RODS}}}",
    "parameters.k1 = -1": f"parameters: {{F: 0, k1: [-1, 5], {RODS}}}",
    "parameters.taper = 0": f"parameters: {{F: 10, k1: 1.0e4, taper: 0, {RODS}}}",
    "spectrum.longitudinal": "parameters: {F: 0, k1: .inf, gamma1: 1, k2: 1.0e4, gamma3: 1}\n"
    "spectrum: {longitudinal: true}",
    "parameters make a grid": "parameters: {F: {start: 0, stop: 1, num: 10000000}, k1: "
    "{start: 1, stop: 10, num: 10000000}, k2: {start: 1, stop: 9, num: 10000000}, gamma3: 1}",
    "parameters.points": "parameters: {points: none.csv}",
}
"""Values that are checked after the file was read, by how the refusal goes on."""


@pytest.mark.parametrize("says", CHECKED_LATE)
@pytest.mark.parametrize("command", ["check", "run"])
def test_what_is_checked_after_reading_is_refused_with_the_name_of_the_file(run, tmp_path, says, command):
    (tmp_path / "c.yaml").write_text(f"task: spectrum\n{CHECKED_LATE[says]}\n")
    assert complaint(run(tmp_path, command, "c.yaml"), True, f"c.yaml: {says}") == ""


LIST = "task: spectrum\nparameters: {points: points.csv}\n"


def test_bad_point_list_is_refused_in_one_sentence(run, tmp_path):
    (tmp_path / "c.yaml").write_text(LIST)
    complaints, lists = [], bad_lists(Random(1))
    for name, (content, refused) in lists.items():
        (tmp_path / "points.csv").write_bytes(content)
        why = complaint(run(tmp_path, "check", "c.yaml"), refused)
        complaints += [(name, why)] if why else []
    assert not complaints, report(complaints, len(lists))
    (tmp_path / "points.csv").write_text(GOOD)
    assert run(tmp_path, "check", "c.yaml").status == 0


def odd_files(directory):
    """Names of what is no file of text, made in a directory."""
    os.mkfifo(directory / "pipe")
    (directory / "folder").mkdir()
    (directory / "zero").symlink_to("/dev/zero")
    (directory / "loop").symlink_to("loop")
    (directory / "dangling").symlink_to("nowhere")
    with (directory / "huge").open("wb") as file:
        file.write(b"F,k1,k2,gamma3\n")
        file.truncate(10**12)  # takes no room, as it is never written
    with (directory / "large").open("wb") as file:
        file.write(b"x" * 10**8)
    with closing(socket.socket(socket.AF_UNIX)) as end:
        end.bind(os.path.relpath(directory / "socket"))
    return [
        "pipe", "folder", "zero", "loop", "dangling", "huge", "large", "socket", "/dev/null", ".", "/",
        "none", "a" * 300, "a/" * 400, "folder/none", "c.yaml/x",
    ]  # fmt: skip


def test_what_is_no_file_is_refused_without_waiting(run, tmp_path):
    (tmp_path / "c.yaml").write_text(LIST)
    complaints, names = [], odd_files(tmp_path)
    for name in [*names, "", "\udcff", "a\nb", "--", "x" * 5000]:
        outcome = run(tmp_path, "check", "--", name)
        if outcome.fault or outcome.status != 2:
            complaints.append((name[:30], outcome.fault or f"status {outcome.status}"))
    for name in names:
        outcome = run(tmp_path, "check", "c.yaml", "--set", f"parameters.points={name}")
        if outcome.fault or outcome.status != 2:
            complaints.append((f"points: {name[:30]}", outcome.fault or f"status {outcome.status}"))
    assert not complaints, report(complaints, 2 * len(names))


@pytest.mark.parametrize(
    "name", ["\udcff.yaml", "a\nb.yaml", "[bold].yaml", "\u202e.yaml", "-.yaml", "a b.yaml"]
)
def test_file_may_have_any_name(run, tmp_path, name):
    (tmp_path / name).write_bytes(CONFIGS[0].read_bytes())
    assert run(tmp_path, "check", "--", name).fault == ""
    assert run(tmp_path, "check", "--", name).status == 0
    outcome = run(tmp_path, "check", "--set", "a=3", "--", name)
    assert (outcome.fault, outcome.status) == ("", 2)


LONG = "y" * 5000
LINES = [
    ["check", LONG], ["check", "c.yaml", LONG], ["check", "--" + LONG], [LONG], ["run", "\n"], ["show", LONG],
    ["plot", "c.yaml", "--roots", LONG], ["run", "c.yaml", "-o", LONG], ["check"], ["check", "--set"],
    ["plot", "c.yaml", "--point", "9" * 5000], ["show", "\udcff"], ["run", "-o", ".", "c.yaml"],
    ["run", "c.yaml", "--shard", LONG], ["merge", LONG, LONG],
]  # fmt: skip


@pytest.mark.parametrize(
    "words", LINES, ids=lambda words: " ".join(word[:9] for word in words).encode("unicode_escape").decode()
)
def test_command_line_is_refused_in_one_short_sentence(run, tmp_path, words):
    (tmp_path / "c.yaml").write_bytes(CONFIGS[0].read_bytes())
    outcome = run(tmp_path, *words)
    assert (outcome.fault, outcome.status in (2, 3)) == ("", True)


REAL = len([*DRAWN, *SPREAD]) if MORE > 1 else 2
"""Cases given to the command itself, in turn to `check` and to `run`; one of every kind in `make stress`."""
MET_SOLVER = 99


@pytest.fixture(scope="module")
def no_solver(tmp_path_factory):
    """A directory for PYTHONPATH in which importing PETSc or SLEPc ends with status MET_SOLVER."""
    directory = tmp_path_factory.mktemp("no solver")
    for name in ("petsc4py", "slepc4py"):
        (directory / f"{name}.py").write_text(f"import os\nos._exit({MET_SOLVER})\n")
    return directory


def the_command(directory, no_solver, *words):
    """How `rodsweep words...` ends in a directory, without a solver."""
    ended = subprocess.run(
        [BIN / "rodsweep", *map(os.fsencode, words)],
        cwd=directory,
        capture_output=True,
        timeout=300,
        check=False,
        env=os.environ | {"PYTHONPATH": f"{no_solver}:{os.environ.get('PYTHONPATH', '')}"},
    )
    return Outcome(ended.returncode, False, ended.stdout.decode(), ended.stderr.decode())


@pytest.mark.long
@pytest.mark.parametrize("number", range(REAL))
def test_the_command_itself_refuses_and_leaves_nothing(tmp_path, no_solver, number):
    kind = [*DRAWN, *SPREAD][number % len([*DRAWN, *SPREAD])]
    cases = [case for case in cases_of(kind) if case.refused] or cases_of(kind)
    case = Random(number).choice(cases)
    command = "run" if number % 2 and case.refused else "check"
    (tmp_path / "c.yaml").write_bytes(case.config)
    outcome = the_command(tmp_path, no_solver, command, "c.yaml", *words_of(case))
    assert complaint(outcome, case.refused) == "", case.name
    assert [path.name for path in tmp_path.iterdir()] == ["c.yaml"]
