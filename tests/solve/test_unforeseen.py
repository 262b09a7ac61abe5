"""Exceptions that no solver foresees: the point fails with a traceback in the log, the sweep goes on."""

import re
import warnings

import h5py
import numpy as np
import pytest
from contents import content
from ranks import wait_for_end
from surveyed import survey_only

import rodsweep as rs

SPECTRA = """
task: spectrum
parameters: {F: [10, 20, 30, 40], k1: 1.0e4, k2: 1.0e4, gamma3: 1.0e-4}
spectrum: {follow: false}
"""
FOLLOWED = SPECTRA.replace("[10, 20, 30, 40]", "{start: 10, stop: 40, num: 16}").replace("follow: false", "")
CYCLES = """
task: limit_cycle
parameters: {F: [40, 45, 50], k1: 1.0e4, k2: 100, gamma3: 1.0e-2}
accuracy: 1.0e-4
"""
CHAIN = CYCLES + "limit_cycle: {start: neighbour}\n"
WHEN_SOLVERS_ARE_LOADED = """
from rodsweep.tasks.running.job import Job

solver = Job.solver

def with_a_bug(job):
    break_it()
    return solver(job)

Job.solver = with_a_bug
"""
"""What calls the function `break_it` of a patch once MPI has been started."""
BROKEN_SPECTRUM = f"""
{WHEN_SOLVERS_ARE_LOADED}
def break_it():
    import rodsweep.solve.spectrum.search as search

    class Broken(search.SpectrumSearch):
        def find_spectrum(self):
            if self.problem.rod.F == 20:
                raise StopIteration("a bug")
            return super().find_spectrum()

    search.SpectrumSearch = Broken
"""
BROKEN_CYCLE = f"""
{WHEN_SOLVERS_ARE_LOADED}
def break_it():
    import rodsweep.solve.cycle.limit_cycle as limit_cycle

    real = limit_cycle.solve_cycle

    def solve_cycle(point, *words):
        if point.F == 45:
            raise StopIteration("a bug")
        return real(point, *words)

    limit_cycle.solve_cycle = solve_cycle
"""
BROKEN_STRETCH = f"""
{WHEN_SOLVERS_ARE_LOADED}
def break_it():
    import rodsweep.solve.spectrum.path.neighbouring_rods as following

    def broken(*words):
        raise IndexError("a bug")

    following.follow_spectra, following.warm_up = broken, lambda: None
"""


def without(variables, place):
    """Variables, each (points, ...), without one point."""
    return {name: np.delete(values, place, axis=0) for name, values in variables.items()}


def points(path):
    """All variables along the points of a file whose only axis longer than 1 is the first, F."""
    with h5py.File(path) as file:
        count = file["status"].shape[0]
    return {n: v for n, v in content(path).items() if v.ndim >= 4 and v.shape[0] == count}


@pytest.mark.parametrize(
    ("config", "patch", "place", "ranks"),
    [
        pytest.param(SPECTRA, BROKEN_SPECTRUM, 1, 0, marks=survey_only),
        pytest.param(SPECTRA, BROKEN_SPECTRUM, 1, 2, marks=survey_only),
        pytest.param(CYCLES, BROKEN_CYCLE, 1, 0, marks=survey_only),
        (CHAIN, BROKEN_CYCLE, 1, 2),
    ],
    ids=["point", "two ranks", "cycle", "chain"],
)
def test_point_that_raises_fails_and_the_others_go_on(command, config, patch, place, ranks):
    command.write("c.yaml", config)
    run = command("run", "c.yaml", ranks=ranks, patch=patch)
    assert run.returncode == 1, run.stderr
    assert re.search(
        r"failed, for example at .*: unforeseen StopIteration: a bug \(.*, line \d+, in \w+\), a bug",
        run.stdout,
    )
    assert "1 unforeseen exception, a bug: please report it with c.h5.log" in run.stdout
    assert "Traceback" not in run.stderr
    log = (command.directory / "c.h5.log").read_text()
    assert log.count("Traceback") == 1
    assert "StopIteration: a bug" in log
    assert f"F={(20.0, 45.0)[patch is BROKEN_CYCLE]}" in log
    again = command("run", "c.yaml", patch=patch)
    assert "complete, nothing to do" in again.stdout
    assert again.returncode == 1
    assert (command.directory / "c.h5.log").read_text() == log
    assert command("run", "c.yaml", "-o", "whole.h5").returncode == 0
    failed, whole = (points(command.directory / name) for name in ("c.h5", "whole.h5"))
    assert failed["status"].ravel()[place] != 0
    if config is not CHAIN:  # where the next point starts from the mode
        ours, theirs = without(failed, place), without(whole, place)
        assert all(np.array_equal(ours[n], theirs[n], equal_nan=ours[n].dtype.kind == "f") for n in theirs)


def test_stretch_that_raises_is_solved_point_by_point(command):
    command.write("c.yaml", FOLLOWED)
    run = command("run", "c.yaml", patch=BROKEN_STRETCH)
    assert run.returncode == 0, run.stderr
    assert "1 unforeseen exception" in run.stdout
    log = (command.directory / "c.h5.log").read_text()
    assert "16 points together, from F=10.0" in log
    assert "IndexError: a bug" in log
    command.write("alone.yaml", FOLLOWED.replace("spectrum: {}", "spectrum: {follow: false}"))
    assert command("run", "alone.yaml").returncode == 0
    ours, alone = (points(command.directory / name) for name in ("c.h5", "alone.h5"))
    assert all(np.array_equal(ours[n], alone[n], equal_nan=ours[n].dtype.kind == "f") for n in alone)


@pytest.mark.parametrize("ranks", [0, 2])
def test_strict_ends_the_run_at_the_first(command, ranks):
    command.write("c.yaml", SPECTRA)
    run = command("run", "c.yaml", "--strict", ranks=ranks, patch=BROKEN_SPECTRUM)
    wait_for_end(command.directory)
    assert run.returncode == 70
    assert "StopIteration: a bug" in run.stderr
    assert "at F=20.0" in run.stderr
    assert "StopIteration: a bug" in (command.directory / "c.h5.log").read_text()
    again = command("run", "c.yaml")
    assert again.returncode == 0, again.stderr


def test_bug_outside_of_points_has_a_status_of_its_own(command):
    command.write("c.yaml", SPECTRA)
    patch = (
        "import rodsweep.results.file.result_file_writer as store\n"
        "def broken(self, *words): raise ValueError('a bug')\n"
        "store.ResultFileWriter.__init__ = broken\n"
    )
    run = command("run", "c.yaml", patch=patch)
    assert run.returncode == 70
    assert "ValueError: a bug" in run.stderr
    assert run.stderr.splitlines()[-1] == "rodsweep: this is a bug; please report it with the lines above"


def test_in_python_a_sweep_warns_and_a_rod_raises(monkeypatch):
    from rodsweep.solve.spectrum import search

    class Broken(search.SpectrumSearch):
        def find_spectrum(self):
            raise KeyError("a bug")

    asked = {"F": [10, 20], "k1": 1e4, "k2": 1e4, "gamma3": 1e-4}
    rs.sweep("spectrum", **asked)  # loads what is loaded at first use
    monkeypatch.setattr(search, "SpectrumSearch", Broken)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        data = rs.sweep("spectrum", **asked)
    assert [str(w.message).count("KeyError: 'a bug'") for w in said] == [2, 2]
    attributes = data.status.attrs
    names = dict(zip(attributes["flag_values"], attributes["flag_meanings"].split(), strict=True))
    assert [names[value] for value in data.status.values.ravel()] == ["failed", "failed"]
    with pytest.raises(KeyError):
        rs.sweep("spectrum", strict=True, **asked)
    with pytest.raises(KeyError):
        rs.Rod(F=10, k1=1e4, k2=1e4, gamma3=1e-4).spectrum()
