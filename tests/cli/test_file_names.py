"""Names whose ending says another kind of file, and files of another kind, are refused in a sentence."""

import pytest
from faults import small

import rodsweep as rs
from rodsweep.config.json_schema import json_schema

RESULTS = "is not a name for results, which are HDF5: it must end in .h5, .hdf5, .nc"


@pytest.fixture(scope="module")
def results(loaded, tmp_path_factory):
    from conftest import Command

    command = Command(tmp_path_factory.mktemp("names"), lambda: loaded)
    command.write("c.yaml", small.CONFIGS["thresholds"])
    command.write("c.csv", small.POINTS)
    assert command("run", "c.yaml").returncode == 0
    return command


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (("run", "c.yaml", "-o", "r.csv"), f"r.csv {RESULTS}"),
        (("run", "c.yaml", "-o", "r"), f"r {RESULTS}"),
        (
            ("run", "c.yaml", "-o", "."),
            ". is a directory; name a file for results, which ends in .h5, .hdf5, .nc",
        ),
        (("merge", "m.txt", "c.h5"), f"m.txt {RESULTS}"),
        (("snapshot", "c.h5", "-o", "s.xlsx"), f"s.xlsx {RESULTS}"),
        (("export", "c.h5", "-o", "beat.xlsx"), "--output beat.xlsx: the name must end in .csv or .tsv"),
        (("plot", "c.h5", "-o", "p.csv"), "--output p.csv: the name must end in .png, .pdf, .svg"),
        (("bench", "spectrum", "--quick", "-o", "b.txt"), "--output b.txt: the name must end in .md"),
        (
            ("show", "c.yaml"),
            "c.yaml is a config, not a result file; `rodsweep run` makes a result file from it",
        ),
        (
            ("export", "c.yaml"),
            "c.yaml is a config, not a result file; `rodsweep run` makes a result file from it",
        ),
        (("check", "c.h5"), "c.h5 is a result file, not a config; `rodsweep show` prints its content"),
        (("export", "."), ". is a directory; name a file"),
        (("plot", "."), ". is a directory; name a file"),
        (("plot", ".."), ".. is a directory; name a file"),
        (("snapshot", "."), ". is a directory; name a file"),
        (("show", "."), ". is not a file"),
        (("run", ""), "CONFIG is empty; give the name of a file"),
        (("run", "c.yaml", "--output", ""), "--output is empty; give the name of a file"),
        (("run", "c.yaml", "-o", ""), "--output is empty; give the name of a file"),
        (("show", ""), "FILE is empty; give the name of a file"),
        (("plot", "c.h5", ""), "FILE is empty; give the name of a file"),
        (("explore", ""), "FILE | CONFIG is empty; give the name of a file"),
        (
            ("run", "c.csv"),
            "c.csv is a table, not a config; name the table in a config, as parameters.points",
        ),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else "",
)
def test_a_name_for_another_kind_of_file_is_refused_with_the_endings_that_there_are(words, sentence, results):
    before = sorted(path.name for path in results.directory.iterdir())
    done = results(*words)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith(f"rodsweep: {sentence}")
    assert done.stderr.count("\n") == 1
    assert sorted(path.name for path in results.directory.iterdir()) == before


@pytest.mark.long
@pytest.mark.parametrize("name", ["r.h5", "r.hdf5", "r.nc"])
def test_results_may_have_each_of_the_endings(name, results):
    assert results("run", "c.yaml", "-q", "-o", name).returncode == 0
    assert results("show", name).returncode == 0
    assert rs.open(results.directory / name).attrs["task"] == "thresholds"


@pytest.mark.parametrize(
    ("override", "sentence"),
    [
        (
            "tolerance=3",
            "unknown key tolerance; known keys are title, task, parameters, accuracy, material, thresholds",
        ),
        ("gamma3=3", "unknown key gamma3; did you mean parameters.gamma3?"),
        ("crossings=3", "unknown key crossings; did you mean thresholds.crossings?"),
        ("parameters.F_max=3", "unknown key parameters.F_max; did you mean thresholds.F_max?"),
        ("parameters.length=3", "unknown key parameters.length; did you mean parameters.arm.length?"),
        ("parameters.accuracy=1", "unknown key parameters.accuracy; did you mean accuracy?"),
        (
            "parameters.twist=3",
            "unknown key parameters.twist; known keys are F, k1, k2, gamma3, gamma1, taper, points, columns",
        ),
    ],
)
def test_a_key_in_another_place_is_told_where_it_belongs(override, sentence, results):
    done = results("check", "c.yaml", "--set", override)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert sentence in done.stderr


def test_an_option_that_is_called_as_another_task_is_told_where_it_belongs(results):
    results.write("s.yaml", small.CONFIGS["spectrum"])
    done = results("check", "s.yaml", "--set", "modes=3")
    assert done.stderr == "rodsweep: s.yaml: unknown key modes; did you mean spectrum.modes?\n"


def test_no_page_shows_what_pydantic_has_for_nothing():
    from conftest import ROOT

    for page in (ROOT / "docs").glob("*.md"):
        assert "Undefined" not in page.read_text(), page
    assert "Undefined" not in str(json_schema())
