"""`rodsweep report` and `rodsweep portrait` refuse names in one sentence, and leave what is there."""

import shutil

import pytest
from faults import small


@pytest.fixture
def results(command):
    command.write("c.yaml", small.CONFIGS["thresholds"])
    command.solved("c.yaml")
    return command


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("absent.h5",), "absent.h5 does not exist"),
        (("c.yaml",), "c.yaml is a config, not a result file; `rodsweep run` makes a result file from it"),
        (("c.h5", "-o", "p.txt"), "--output p.txt: the name must end in .html"),
        (("c.h5", "-o", "no/p.html"), "--output no/p.html: there is no directory no"),
        (
            ("c.h5", "-o", "folder.html"),
            "--output folder.html is not a regular file; choose another name for the page",
        ),
        ((".",), ". is a directory; name a file"),
        (
            ("c.h5", "copy.html", "-o", "copy.html"),
            "--output copy.html is an input file and would be overwritten; choose another name",
        ),
    ],
)
def test_a_report_is_refused_in_a_sentence(results, words, sentence):
    (results.directory / "folder.html").mkdir()
    shutil.copy(results.directory / "c.h5", results.directory / "copy.html")
    before = {path.name: path.stat().st_mtime_ns for path in results.directory.iterdir()}
    done = results("report", *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"rodsweep: {sentence}\n"
    assert {path.name: path.stat().st_mtime_ns for path in results.directory.iterdir()} == before


def test_a_report_needs_a_file(command):
    assert command("report").returncode == 2


ROD = ("--k1", "1e4", "--k2", "1e2", "--gamma3", "1e-2")


@pytest.mark.long
def test_a_portrait_is_drawn_and_said(command):
    done = command("portrait", *ROD, "--F-max", "40", "--accuracy", "1e-3", "-o", "p.svg")
    assert done.returncode == 0, done.stderr
    told, wrote = done.stdout.splitlines()
    assert "becomes unstable at F = 27.4272 (frequency 113.548 rad/tau2; supercritical" in told
    assert wrote.startswith("wrote p.svg: ")
    assert (command.directory / "p.svg").stat().st_size > 20_000


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ((*ROD, "-o", "p.txt"), "--output p.txt: the name must end in .png, .pdf, .svg, .html"),
        ((*ROD, "-o", "no/p.png"), "--output no/p.png: there is no directory no"),
        ((*ROD, "-o", "no/p.html"), "--output no/p.html: there is no directory no"),
        (
            (*ROD, "-o", "folder.png"),
            "--output folder.png is not a regular file; choose another name for the picture",
        ),
        (
            (*ROD, "--F-max", "-1"),
            "--F-max = -1.0 is not allowed; it should be a finite number above 0",
        ),
        (
            ("--k1", "-3", "--k2", "1", "--gamma3", "1"),
            "--k1 = -3 is not allowed; it must be a number above 0, or inf for an inextensible rod",
        ),
        ((*ROD, "--gamma1", "-1"), "--gamma1 = -1 is not allowed; it must be a finite number above 0"),
        (
            (*ROD, "--accuracy", "2"),
            "--accuracy = 2.0 is not allowed; it should be a number from 1e-13 to 0.01",
        ),
        ((*ROD, "--profile", "no.csv"), "--profile: no.csv does not exist; give the name of a CSV file"),
        ((*ROD, "--law", "x"), "--law = 'x' is not allowed; it should be linear or neo_hookean"),
        ((*ROD, "--poisson", "0.3"), "--viscosity is missing; an arm needs the viscosity of its fluid"),
        (("--k1", "x", "--k2", "1", "--gamma3", "1"), "Invalid value for '--k1': 'x' is not a valid float."),
    ],
)
def test_a_portrait_is_refused_in_a_sentence(command, words, sentence):
    (command.directory / "folder.png").mkdir()
    done = command("portrait", *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"rodsweep: {sentence}\n"
    assert [path.name for path in command.directory.iterdir()] == ["folder.png"]
