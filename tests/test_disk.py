"""Disks that refuse: each ends with one sentence and status 3, loses nothing, and the run goes on later."""

import os
import subprocess
import time
from contextlib import contextmanager

import pytest
from conftest import Command
from contents import content, same

CONFIG = """
task: spectrum
parameters:
  F: {start: 0, stop: 60, num: 1500}
  k1: [100, 1.0e4, .inf]
  k2: [50, 1.0e4]
  gamma3: [0, 1.0e-4]
"""


@contextmanager
def disk(tmp_path, options):
    """A file system of its own in a directory; skips where nobody may mount one."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", options, "none", place]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("mounting a small file system is not allowed here")
    try:
        yield Command(place)
    finally:
        subprocess.run(["umount", "-l", place], check=True)


def one_sentence(done, what):
    assert done.returncode == 3, done.stderr
    assert done.stderr.count("rodsweep:") == 1, done.stderr
    assert what in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("ranks", [0, 2])
def test_read_only_directory_is_refused_before_anything_is_solved(tmp_path, ranks):
    with disk(tmp_path, "size=64m") as command:
        command.write("c.yaml", CONFIG)
        subprocess.run(["mount", "-o", "remount,ro", command.directory], check=True)
        one_sentence(command("run", "c.yaml", ranks=ranks), "c.h5 cannot be written: Read-only file system")
        assert [path.name for path in command.directory.iterdir()] == ["c.yaml"]


def test_directory_without_permission_is_refused(command):
    if os.geteuid() == 0:
        pytest.skip("root may write everywhere")
    command.write("c.yaml", CONFIG)
    command.directory.chmod(0o500)
    try:
        one_sentence(command("run", "c.yaml"), "c.h5 cannot be written: Permission denied")
    finally:
        command.directory.chmod(0o700)


def test_too_small_a_disk_is_refused_before_anything_is_solved(tmp_path):
    with disk(tmp_path, "size=4m") as command:
        command.write("c.yaml", CONFIG)
        one_sentence(command("run", "c.yaml"), "MB are free")
        assert [path.name for path in command.directory.iterdir()] == ["c.yaml"]


@pytest.mark.parametrize("ranks", [0, 2])
def test_disk_that_fills_up_in_the_middle_costs_no_point(tmp_path, ranks):
    with disk(tmp_path, "size=64m") as command:
        command.write("c.yaml", CONFIG)
        process = subprocess.Popen(
            command.argv("run", "c.yaml", ranks=ranks),
            cwd=command.directory,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env=dict(os.environ),
        )
        pages = command.directory / "c.h5.journal"
        deadline = time.monotonic() + 60
        while not any(page.stat().st_size > 2000 for page in pages.glob("rank-*")):
            assert process.poll() is None, process.communicate()
            assert time.monotonic() < deadline
            time.sleep(0.01)
        hog = command.directory / "hog"
        with hog.open("wb", buffering=0) as file:
            try:
                while True:
                    file.write(bytes(1 << 12))
            except OSError:
                pass
        _, err = process.communicate(timeout=60)
        assert process.returncode == 3, err
        assert "No space left on device" in err
        assert "make room and run again" in err
        assert "Traceback" not in err
        hog.unlink()
        again = command("run", "c.yaml", ranks=2)
        assert again.returncode == 0, again.stderr
        assert " kept" in again.stdout
        assert command("run", "c.yaml", "-o", "whole.h5", ranks=2).returncode == 0
        assert same(content(command.directory / "c.h5"), content(command.directory / "whole.h5"))
