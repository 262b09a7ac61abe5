"""Result files and journals moved, deleted, cut or replaced under a run: no measured point is lost."""

import os
import shutil
import signal

import pytest
from contents import content, same
from ranks import PATIENCE
from slow_runs import FOR_EVER, pause_until_journalled, slowly
from surveyed import few

CONFIG = """
task: spectrum
parameters: {F: [1, 2, 3, 4, 5, 6, 7], k1: [100, 200], k2: 1.0e4, gamma3: 1.0e-4}
spectrum: {modes: 2}
"""
KEPT = "9 of 14 points to do, 5 kept"


def struck(command, strike):
    """How a run ends that is asked to stop behind its fifth point, after something was done to its files."""
    command.write("c.yaml", CONFIG)
    process = command.started("run", "c.yaml", "-o", "a.h5", patch=slowly(FOR_EVER, 5))
    path = command.directory / "a.h5"
    pause_until_journalled(process, path, 5)
    strike(path, path.with_name("a.h5.journal"))
    process.send_signal(signal.SIGTERM)
    out, err = process.communicate(timeout=PATIENCE)
    return process.returncode, out, err


def goes_on(command):
    """Continues the run, which has kept its points, to the file of an undisturbed one."""
    again = command("run", "c.yaml", "-o", "a.h5")
    assert again.returncode == 0, again.stderr
    assert KEPT in again.stdout
    assert command("run", "c.yaml", "-o", "whole.h5").returncode == 0
    assert same(content(command.directory / "a.h5"), content(command.directory / "whole.h5"))
    assert [path.name for path in command.directory.glob("*.journal*")] == []


def moved(path, journal):
    path.rename(path.with_name("b.h5"))


def journal_deleted(path, journal):
    shutil.rmtree(journal)


def both_deleted(path, journal):
    path.unlink()
    shutil.rmtree(journal)


def cut(path, journal):
    os.truncate(path, 3000)


def replaced(path, journal):
    path.unlink()
    path.write_text("mine")


@pytest.mark.parametrize("strike", few([both_deleted, moved, journal_deleted], 1))
def test_run_whose_files_are_gone_writes_them_anew(command, strike):
    code, out, err = struck(command, strike)
    assert (code, err) == (75, ""), err
    assert ("a new file holds the points" in out) == (strike is not journal_deleted)
    assert "5 points kept, the same command continues" in out
    goes_on(command)


@pytest.mark.long
@pytest.mark.parametrize("strike", [cut, replaced])
def test_another_file_in_the_place_of_a_result_is_left_and_the_points_wait(command, strike):
    code, _, err = struck(command, strike)
    assert (code, err.count("\n")) == (3, 1), err
    path = command.directory / "a.h5"
    other = path.read_bytes()
    refused = command("run", "c.yaml", "-o", "a.h5")
    for said in (err, refused.stderr):
        assert "move this file away, and the same command will use the points in a.h5.journal" in said
    assert (refused.returncode, path.read_bytes()) == (2, other)
    path.rename(path.with_name("b.h5"))
    goes_on(command)


def test_fresh_sets_journals_aside_from_where_they_can_be_taken_back(command):
    struck(command, cut)
    done = command("run", "c.yaml", "-o", "a.h5", "--fresh")
    assert "journals that --fresh does not use are kept in a.h5.journal-1" in done.stdout
    assert "14 of 14 points to do" in done.stdout
    (command.directory / "a.h5").unlink()
    (command.directory / "a.h5.journal-1").rename(command.directory / "a.h5.journal")
    goes_on(command)


def test_journals_of_another_config_are_set_aside(command):
    struck(command, cut)
    (command.directory / "a.h5").unlink()
    command.write("other.yaml", CONFIG.replace("modes: 2", "modes: 3"))
    done = command("run", "other.yaml", "-o", "a.h5", "-q")
    assert (
        done.stdout
        == "a.h5: journals that do not match the config and its points are kept in a.h5.journal-1\n"
    )
    (command.directory / "a.h5").unlink()
    (command.directory / "a.h5.journal-1").rename(command.directory / "a.h5.journal")
    goes_on(command)


def test_file_edited_while_it_is_computed_is_not_sealed_as_it_is(command):
    """What another program writes meanwhile is noticed before the points are folded in."""

    def edit(path, journal):
        import h5py

        with h5py.File(path, "r+") as file:
            file["k1"][1] = 300

    code, _, err = struck(command, edit)
    assert code == 3
    assert "its variable k1 was changed after rodsweep wrote it" in err
    assert "a.h5.journal" in err
