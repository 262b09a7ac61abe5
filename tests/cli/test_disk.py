"""Disks that refuse: each ends with one sentence and status 3, loses nothing, and the run goes on later."""

import os
import shlex
import subprocess
from contextlib import contextmanager

import h5py
import pytest
from contents import content, same
from ranks import PATIENCE
from slow_runs import pause_until_journalled, slowly
from surveyed import few

CONFIG = """
task: spectrum
parameters:
  F: {start: 0, stop: 60, num: 500}
  k1: [100, 1.0e4, .inf]
  k2: [50, 1.0e4]
  gamma3: [0, 1.0e-4]
"""


@contextmanager
def disk(command, options):
    """A file system of its own in a directory; skips where nobody may mount one."""
    place = command.directory / "disk"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", options, "none", place]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("mounting a small file system is not allowed here")
    try:
        yield command.in_directory(place)
    finally:
        subprocess.run(["umount", "-l", place], check=True)


def one_sentence(done, what):
    assert done.returncode == 3, done.stderr
    assert done.stderr.count("rodsweep:") == 1, done.stderr
    assert what in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("ranks", [0, 2])
def test_read_only_directory_is_refused_before_anything_is_solved(command, ranks):
    with disk(command, "size=64m") as small:
        small.write("c.yaml", CONFIG)
        subprocess.run(["mount", "-o", "remount,ro", small.directory], check=True)
        one_sentence(small("run", "c.yaml", ranks=ranks), "c.h5 cannot be written: Read-only file system")
        assert [path.name for path in small.directory.iterdir()] == ["c.yaml"]


def test_file_in_the_place_of_the_journal_is_named(command):
    path = command.write("c.yaml", CONFIG.replace("{start: 0, stop: 60, num: 500}", "60"))
    (command.directory / "c.h5.journal").write_text("mine")
    one_sentence(command("run", path), "c.h5.journal is not a directory; move it away")
    assert (command.directory / "c.h5.journal").read_text() == "mine"


def test_too_small_a_disk_for_an_extension_leaves_the_file(command):
    with disk(command, "size=1m") as small:
        small.write("c.yaml", CONFIG.replace("{start: 0, stop: 60, num: 500}", "60"))
        assert small("run", "c.yaml").returncode == 0
        before = (small.directory / "c.h5").read_bytes()
        small.write("c.yaml", CONFIG)
        one_sentence(small("run", "c.yaml", "--extend"), "MB are free")
        assert (small.directory / "c.h5").read_bytes() == before
        assert sorted(path.name for path in small.directory.iterdir()) == ["c.h5", "c.yaml"]


@pytest.mark.long
@pytest.mark.parametrize("word", ["check", "run"])
def test_full_disk_under_a_log_of_both_streams_ends_with_3(command, word):
    """Nothing can be said any more; at exit Python flushes again, which must not change the status."""
    command.write("c.yaml", CONFIG.replace("1500", "2"))
    with open("/dev/full", "w") as full:
        argv = command.argv(word, "c.yaml")
        run = subprocess.run(argv, cwd=command.directory, stdout=full, stderr=full, check=False)
    assert run.returncode == 3


@pytest.mark.long
def test_closed_streams_and_a_window_of_no_columns_change_nothing(command):
    """The result file must not take the number of a closed stream, into which C libraries write."""
    command.write("c.yaml", CONFIG.replace("1500", "2"))
    argv = shlex.join(map(str, command.argv("run", "c.yaml")))
    run = subprocess.run(f"{argv} <&- >&- 2>&-", shell=True, cwd=command.directory, check=False)
    assert run.returncode == 0
    with h5py.File(command.directory / "c.h5") as file:
        assert (file["status"][...] == 0).all()
    assert command("show", "c.h5", COLUMNS="0").returncode == 0


def test_directory_without_permission_is_refused(command):
    command.write("c.yaml", CONFIG)
    command.directory.chmod(0o500)
    # Root may write everywhere, unless it gives that up.
    weak = (
        ["setpriv", "--bounding-set=-dac_override", "--inh-caps=-dac_override"] if os.geteuid() == 0 else []
    )
    argv = [*weak, *command.argv("run", "c.yaml")]
    try:
        run = subprocess.run(argv, cwd=command.directory, capture_output=True, text=True, check=False)
        one_sentence(run, "c.h5 cannot be written: Permission denied")
    finally:
        command.directory.chmod(0o700)


def test_too_small_a_disk_is_refused_before_anything_is_solved(command):
    with disk(command, "size=1m") as small:
        small.write("c.yaml", CONFIG)
        one_sentence(small("run", "c.yaml"), "MB are free")
        assert [path.name for path in small.directory.iterdir()] == ["c.yaml"]


@pytest.mark.long
@pytest.mark.parametrize("ranks", few([2, 0], 1))
def test_disk_that_fills_up_in_the_middle_costs_no_point(command, ranks):
    with disk(command, "size=64m") as small:
        small.write("c.yaml", CONFIG)
        process = small.started("run", "c.yaml", ranks=ranks, patch=slowly(0.05))
        pause_until_journalled(process, small.directory / "c.h5", 10)
        hog = small.directory / "hog"
        with hog.open("wb", buffering=0) as file:
            try:
                while True:
                    file.write(bytes(1 << 12))
            except OSError:
                pass
        _, err = process.communicate(timeout=PATIENCE)
        assert process.returncode == 3, err
        assert "No space left on device" in err
        assert "make room and run again" in err
        assert "Traceback" not in err
        hog.unlink()
        again = small("run", "c.yaml")
        assert again.returncode == 0, again.stderr
        assert " kept" in again.stdout
        assert small("run", "c.yaml", "-o", "whole.h5").returncode == 0
        assert same(content(small.directory / "c.h5"), content(small.directory / "whole.h5"))


OUTPUTS = [
    ("plot", "f.png"),
    ("plot", "f.pdf"),
    ("plot", "f.svg"),
    ("plot", "f.gif"),
    ("export", "f.csv"),
    ("report", "f.html"),
    ("snapshot", "f.h5"),
]
BEATING = """
task: limit_cycle
parameters: {F: [42], k1: 1.0e4, k2: 100, gamma3: 1.0e-2}
limit_cycle: {shapes: 12}
accuracy: 1.0e-4
"""


def test_a_full_disk_leaves_no_part_of_a_figure_table_or_page(command):
    command.write("c.yaml", BEATING)
    command.solved("c.yaml")
    with disk(command, "size=64k") as small:
        (small.directory / "fill").write_bytes(bytes(64 << 10))
        for word, name in OUTPUTS:
            done = small(word, command.directory / "c.h5", "-o", name)
            one_sentence(done, f"{name} cannot be written: No space left on device")
            assert [path.name for path in small.directory.iterdir()] == ["fill"], word


@pytest.mark.parametrize("name", ["f.png", "f.html"])
def test_a_portrait_is_solved_only_if_it_can_be_written(command, name):
    with disk(command, "size=64k") as small:
        subprocess.run(["mount", "-o", "remount,ro", small.directory], check=True)
        done = small("portrait", "--k1", "1e4", "--k2", "1e2", "--gamma3", "1e-2", "-o", name)
        one_sentence(done, f"{name} cannot be written: its directory is not writable")
        assert done.stdout == ""
