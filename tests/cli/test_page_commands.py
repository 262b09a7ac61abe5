"""`rodsweep report` refuses names in one sentence, and leaves what is there."""

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
        (("c.h5", "-o", "folder.html"), "--output folder.html is not a name for a page; choose another"),
        ((".",), ". is a directory; name a file"),
        (
            ("c.h5", "copy.html", "-o", "copy.html"),
            "--output copy.html is a file to report and would be overwritten; choose another",
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
