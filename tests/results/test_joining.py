"""Files of one task whose points belong together are joined to the file of a run of them all, or refused."""

import h5py
import numpy as np
import pytest
from contents import content, same
from surveyed import survey_only

from rodsweep.results.file.seal import seal

SPECTRA = """
task: spectrum
parameters:
  F: {start: 0, stop: 40, num: 5}
  k1: [100, 1.0e3, .inf]
  k2: 50
  gamma3: [0, 1.0e-4]
spectrum: {modes: 2}
"""
DIAGRAM = """
task: phase_diagram
parameters:
  F: {start: 10, stop: 60, num: 6}
  k1: [160, 200, 1.0e3, 1.0e4]
  k2: 1.0e4
  gamma3: 1.0e-4
"""
CHAINS = """
task: limit_cycle
parameters: {F: [40, 50, 60], k1: [1.0e3, 1.0e4], k2: 100, gamma3: 0.01}
accuracy: 1.0e-3
limit_cycle: {start: neighbour, samples: 3}
"""
LONGITUDINAL = SPECTRA.replace(".inf", "1.0e4").replace("50\n", "50\n  gamma1: 1\n")
LONGITUDINAL = LONGITUDINAL.replace("modes: 2", "modes: 2, longitudinal: true")


def computed(command, text, *parts):
    """The files of a config with each of the replacements."""
    names = []
    for number, changes in enumerate(parts, 1):
        part = text
        for old, new in changes:
            assert old in part
            part = part.replace(old, new)
        command.write(f"{number}.yaml", part)
        command.solved(f"{number}.yaml")
        names.append(f"{number}.h5")
    return names


K1 = "100, 1.0e3, .inf"
QUARTERS = (("0, 10, 20", "0"), ("20, 30, 40", "0"), ("0, 10", "1.0e-4"), ("20, 30, 40", "1.0e-4"))
RANGE = "{start: 0, stop: 40, num: 5}"


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        pytest.param(SPECTRA, [[(RANGE, "[0, 20, 40]")], [(RANGE, "[10, 30]")]], marks=survey_only),
        pytest.param(
            SPECTRA,
            [[("100, 1.0e3, .inf", "1.0e3")], [("1.0e3, .inf", "1.0e3")], [("100, 1.0e3, .inf", ".inf")]],
            marks=survey_only,
        ),
        (SPECTRA, [[(RANGE, f"[{F}]"), ("[0, 1.0e-4]", gamma3)] for F, gamma3 in QUARTERS]),
        pytest.param(
            LONGITUDINAL, [[("100, 1.0e3,", "100,")], [("100, 1.0e3, 1.0e4", "1.0e3")]], marks=survey_only
        ),
        (DIAGRAM, [[("160, 200, 1.0e3, 1.0e4", "160, 200")], [("160, 200, ", "")]]),
        (CHAINS, [[("1.0e3, 1.0e4", "1.0e3")], [("1.0e3, 1.0e4", "1.0e4")]]),
    ],
)
def test_joined_files_are_a_run_of_all_their_points(command, text, parts):
    names = computed(command, text, *parts)
    joined = command("merge", "m.h5", *names)
    assert joined.returncode == 0, joined.stderr
    command.write("c.yaml", text)
    again = command("run", "c.yaml", "-o", "m.h5")
    rest = "0 of 4 points to do, 4 kept, then the curves" if text == DIAGRAM else "nothing to do"
    assert rest in again.stdout, again.stdout + again.stderr
    command.solved("c.yaml")
    files = [command.directory / name for name in ("m.h5", "c.h5")]
    assert same(*map(content, files))
    assert not list(command.directory.glob("*.journal"))
    with h5py.File(files[0]) as one, h5py.File(files[1]) as other:
        assert set(one.attrs) == set(other.attrs)
        assert one.attrs["fingerprint"] == other.attrs["fingerprint"]
        assert one.attrs["finished"]
        for name in one:
            assert set(one[name].attrs) == set(other[name].attrs), name
        (command.directory / "own.yaml").write_text(one.attrs["config"])
    assert "nothing to do" in command("run", "own.yaml", "-o", "m.h5").stdout
    for words in (("show", "m.h5"), ("export", "m.h5")):
        assert command(*words).returncode == 0


@pytest.mark.long
def test_a_process_that_solves_first_while_it_joins_can_write_the_file(command):
    """The Hopf points of the joined grid start MPI, in a process that had started nothing."""
    names = computed(command, CHAINS, [("[40, 50, 60]", "[40]")], [("[40, 50, 60]", "[60]")])
    joined = command.afresh("merge", "joined.h5", *names)
    assert (joined.returncode, joined.stderr) == (0, "")
    with h5py.File(command.directory / "joined.h5") as file:
        assert (file["status"][...] == 0).all()


def test_another_file_is_joined_to_one_that_is_there(command):
    names = computed(command, SPECTRA, [(RANGE, "[0, 10]")], [(RANGE, "[20, 30, 40]")])
    assert command("merge", "m.h5", names[0]).returncode == 0
    assert "30 points from 1 file," in command("merge", "m.h5", names[1]).stdout
    with h5py.File(command.directory / "m.h5") as file:
        assert file.attrs["ranks"] == 2  # of both runs
        assert "num: 5" in file.attrs["config"]  # the axis is a range again
    command.write("c.yaml", SPECTRA)
    assert "complete, nothing to do" in command("run", "c.yaml", "-o", "m.h5").stdout


def test_lists_of_points_are_joined_one_after_the_other(command):
    command.write("a.yaml", "task: spectrum\nparameters: {points: a.csv}\nspectrum: {modes: 2}\n")
    command.write("b.yaml", "task: spectrum\nparameters: {points: b.csv}\nspectrum: {modes: 2}\n")
    command.write("c.yaml", "task: spectrum\nparameters: {points: c.csv}\nspectrum: {modes: 2}\n")
    command.write("a.csv", "F,k1,k2,gamma3\n10,100,50,0\n20,100,50,0\n")
    command.write("b.csv", "F,k1,k2,gamma3\n20,100,50,0\n30,100,50,0\n")
    command.write("c.csv", "F,k1,k2,gamma3\n10,100,50,0\n20,100,50,0\n30,100,50,0\n")
    for name in "abc":
        command.solved(f"{name}.yaml")
    joined = command("merge", "m.h5", "a.h5", "b.h5")
    assert "3 points from 2 files, 0 missing" in joined.stdout, joined.stderr
    assert same(*(content(command.directory / name) for name in ("m.h5", "c.h5")))
    assert "nothing to do" in command("run", "c.yaml", "-o", "m.h5").stdout


def test_points_that_no_file_has_computed_are_missing(command):
    command.write("a.yaml", SPECTRA.replace(RANGE, "[0, 20, 40]"))
    command.write("b.yaml", SPECTRA.replace(RANGE, "[10, 30]"))
    assert command("run", "a.yaml", "--shard", "1/2", "-o", "a.h5").returncode == 0
    command.solved("b.yaml")
    joined = command("merge", "m.h5", "a.h5", "b.h5")
    assert (joined.returncode, "21 points from 2 files, 9 missing" in joined.stdout) == (75, True), joined
    command.write("c.yaml", SPECTRA)
    assert "9 of 30 points to do, 21 kept" in command("run", "c.yaml", "-o", "m.h5").stdout
    command.solved("c.yaml")
    assert same(*(content(command.directory / name) for name in ("m.h5", "c.h5")))


@pytest.mark.long
@pytest.mark.parametrize(
    ("text", "parts", "sentence"),
    [
        (
            SPECTRA,
            [[(RANGE, "[0, 10]"), ("[100,", "[90, 100,")], [(RANGE, "20")]],
            "2 of 24 points are in no file, the first at F = 20, k1 = 90, k2 = 50, gamma3 = 0",
        ),
        (SPECTRA, [[], [("modes: 2", "modes: 3")]], "spectrum.modes is 2 in 1.h5 and 3 in 2.h5"),
        (
            SPECTRA,
            [[], [("modes: 2}", "modes: 2}\naccuracy: 1.0e-8")]],
            "accuracy is 1e-10 in 1.h5",
        ),
        (SPECTRA, [[(RANGE, "10")], [(RANGE, "[10.000000000000002]")]], "which differ by rounding only"),
        (CHAINS, [[], [("60]", "70]")]], "differs from the other files in F"),
        (
            SPECTRA,
            [[], [("  k2:", "  taper: 0.9\n  k2:")]],
            "one has a grid of F, k1, k2 and gamma3, the other a grid of F, k1, k2, gamma3 and taper",
        ),
    ],
)
def test_files_that_do_not_fit_are_refused_in_a_sentence(command, text, parts, sentence):
    names = computed(command, text, *parts)
    refused = command("merge", "m.h5", *names)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1), refused
    assert sentence in refused.stderr
    assert not (command.directory / "m.h5").exists()
    assert not list(command.directory.glob("*.journal"))


@pytest.mark.parametrize(
    ("kernel", "factor", "returncode"), [("", 1 + 1e-9, 2), ("another", 1 + 1e-9, 0), ("another", 1.1, 2)]
)
def test_points_of_two_files_must_agree(command, kernel, factor, returncode):
    """To the last bit where one BLAS kernel computed them, else about as accurately as was asked for."""
    names = computed(command, SPECTRA, [(RANGE, "[0, 10]")], [(RANGE, "[10, 20]")])
    with h5py.File(command.directory / names[1], "r+") as file:
        file["growth_rate"][0, 1, 0, 1, 0] *= factor
        if kernel:
            file.attrs["blas_kernels"] = kernel
    seal(command.directory / names[1])
    joined = command("merge", "m.h5", *names)
    assert joined.returncode == returncode, joined.stderr
    if returncode:
        assert (
            "1.h5 and 2.h5 disagree about the point F = 10, k1 = 1000, k2 = 50, gamma3 = 0.0001: the "
            "values of growth_rate differ"
        ) in joined.stderr
    else:
        whole, first = (content(command.directory / name) for name in ("m.h5", names[0]))
        assert np.array_equal(whole["growth_rate"][:2], first["growth_rate"])
