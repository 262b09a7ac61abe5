"""Looking at a run while it goes on: all that is done is seen, and the run notices nothing."""

import h5py
import numpy as np
import pytest
import xarray as xr
from contents import content, same
from ranks import kill, ranks_in, wait_for_end
from slow_runs import FOR_EVER, pause_until_journalled, slowly
from surveyed import few

from rodsweep.api.dataset import open_result
from rodsweep.errors import EnvironmentIncomplete
from rodsweep.results.file import current_state
from rodsweep.results.file.current_state import read_file_and_journals, write_snapshot
from rodsweep.results.file.view import read_view
from rodsweep.results.run.journal import journal_directory

SPECTRA = """
task: spectrum
parameters:
  F: {start: 1, stop: 60, num: 60}
  k1: [100, .inf]
  k2: 50
  gamma3: 1.0e-4
spectrum: {modes: 2, follow: false}
"""


@pytest.fixture
def waiting(command):
    """A run on two ranks that wait behind their twentieth points."""
    command.write("c.yaml", SPECTRA)
    process = command.started("run", "c.yaml", ranks=2, patch=slowly(FOR_EVER, 20))
    pause_until_journalled(process, command.directory / "c.h5", 40)
    yield process
    kill(process.pid, *ranks_in(command.directory).values())
    process.communicate()
    wait_for_end(command.directory)


def of_points_done(whole, part):
    """Variables of two files at the points that are done in the second, as if these were all."""
    done = part["status"] != -1
    shape = done.shape
    points = {name for name, values in part.items() if values.shape[: done.ndim] == shape}
    return [{name: each[name][done] for name in points} for each in (whole, part)]


@pytest.mark.long
def test_running_sweep_is_seen_as_far_as_it_has_come(command, waiting):
    path, pages = command.directory / "c.h5", command.directory / "c.h5.journal"
    before = {page.name: page.read_bytes() for page in [path, *pages.iterdir()]}
    taken = command("snapshot", "c.h5")
    assert taken.stdout == "wrote c-snapshot.h5: 40 of 120 points are done\n", taken.stderr
    shown = " ".join(command("show", "c.h5").stdout.split())
    assert "80 points are missing" in shown
    assert "40 of the computed points are so far only in the journal" in shown
    assert "ok 40" in shown
    assert "wrote c.csv" in command("export", "c.h5").stdout
    data = open_result(path)
    assert waiting.poll() is None
    assert {page.name: page.read_bytes() for page in [path, *pages.iterdir()]} == before
    assert command("run", "c.yaml", "-o", "whole.h5").returncode == 0
    whole, part = (content(command.directory / name) for name in ("whole.h5", "c-snapshot.h5"))
    assert np.count_nonzero(part["status"] != -1) == 40
    assert same(*of_points_done(whole, part))
    seen = {name: read_view(path).variables[name] for name in part}
    assert same(part, seen)
    assert same(part, {name: data[name].values for name in part})
    with xr.open_dataset(command.directory / "c-snapshot.h5", engine="h5netcdf") as file:
        assert file.attrs["snapshot"]
        np.testing.assert_array_equal(file.growth_rate.values, data.growth_rate.values)


@pytest.mark.long
def test_snapshot_is_taken_again_and_continued(command, waiting):
    assert command("snapshot", "c.h5", "-o", "s.h5").returncode == 0
    assert command("snapshot", "c.h5", "-o", "s.h5").returncode == 0
    done = command("run", "c.yaml", "-o", "s.h5")
    assert "80 of 120 points to do, 40 kept" in done.stdout
    refused = command("snapshot", "c.h5", "-o", "s.h5")
    assert (refused.returncode, "s.h5 exists and is not a snapshot" in refused.stderr) == (2, True)
    itself = command("snapshot", "c.h5", "-o", "c.h5")
    assert (itself.returncode, "is the file itself" in itself.stderr) == (2, True)


@pytest.mark.parametrize("name", ["nowhere.h5", "c.yaml"])
def test_snapshot_of_no_result_is_refused(command, name):
    command.write("c.yaml", SPECTRA)
    refused = command("snapshot", name)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert [path.name for path in command.directory.iterdir()] == ["c.yaml"]


@pytest.mark.parametrize("look", few(["snapshot", "view", "dataset"], 1))
def test_points_that_are_folded_in_meanwhile_are_not_lost_from_sight(command, waiting, monkeypatch, look):
    """The run ends between the reading of the file and of its journals."""
    path = command.directory / "c.h5"
    real = current_state.read_journals
    folds = []

    def read_after_a_fold(*words):
        if not folds:
            folds.append(1)
            kill(waiting.pid, *ranks_in(command.directory).values())
            wait_for_end(command.directory)
            assert command("run", "c.yaml").returncode == 0
        return real(*words)

    monkeypatch.setattr(current_state, "read_journals", read_after_a_fold)
    if look == "view":
        status = read_view(path).variables["status"]
    elif look == "dataset":
        status = open_result(path).status.values
    else:
        assert write_snapshot(path, command.directory / "s.h5") == (120, 120)
        status = content(command.directory / "s.h5")["status"]
    assert folds
    assert np.count_nonzero(status == -1) == 0


def test_file_that_never_stays_is_given_up(tmp_path):
    path = tmp_path / "a.h5"
    path.write_bytes(b"")
    journal_directory(path).mkdir()
    with pytest.raises(EnvironmentIncomplete, match="keeps replacing it"):
        read_file_and_journals(path, lambda: path.write_bytes(path.read_bytes() + b" "))


@pytest.mark.long
def test_running_limit_cycles_can_be_looked_at(command):
    """Whatever the task: what is done is shown, and what is missing is missing."""
    command.write(
        "c.yaml",
        "task: limit_cycle\naccuracy: 1.0e-3\n"
        "parameters: {F: [10, 40, 50], k1: 1.0e4, k2: 100, gamma3: 0.01}\nlimit_cycle: {samples: 4}\n",
    )
    process = command.started("run", "c.yaml", ranks=1, patch=slowly(FOR_EVER, 2))
    pause_until_journalled(process, command.directory / "c.h5", 2)
    taken = command("snapshot", "c.h5")
    assert "2 of 3 points are done" in taken.stdout, taken.stderr
    assert command("plot", "c.h5").returncode == 0
    kill(process.pid, *ranks_in(command.directory).values())
    process.communicate()
    wait_for_end(command.directory)
    with h5py.File(command.directory / "c-snapshot.h5") as file:
        assert file["tip_y"].shape == (3, 1, 1, 1, 1, 4)
        assert np.isfinite(file["period"][1])
        assert "finished" not in file.attrs
