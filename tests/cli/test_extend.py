"""Extending a file: only what is missing is computed, and the file is that of the larger config alone."""

import h5py
import numpy as np
import pytest
from contents import content, same
from ranks import kill, ranks_in, wait_for_end
from ruamel.yaml import YAML
from slow_runs import FOR_EVER, pause_until_journalled, slowly
from surveyed import survey_only

from rodsweep import __version__
from rodsweep.api.dataset import open_result
from rodsweep.config.document.reading import resolved_config, validated_config
from rodsweep.errors import InputError
from rodsweep.results.file.combination.config_comparison import fingerprint_of
from rodsweep.results.file.validation import FORMAT_NUMBER

SPECTRA = """
task: spectrum
parameters:
  F: [10, 30]
  k1: [100, .inf]
  k2: 50
  gamma3: [0, 1.0e-4]
spectrum: {modes: 2}
"""
THRESHOLDS = """
task: thresholds
parameters: {k1: [100, 200], k2: [100, 1.0e4], gamma3: 1.0e-4}
thresholds: {crossings: 2}
"""
DIAGRAM = """
task: phase_diagram
parameters:
  F: {start: 10, stop: 60, num: 6}
  k1: [160, 200, 1.0e3]
  k2: 1.0e4
  gamma3: 1.0e-4
phase_diagram: {curves: false}
"""
MODES = """
task: modes
parameters: {F: [10, 20], k1: 100, k2: 50, gamma3: 0.01}
modes: {modes: 1, nodes: 9, growth: false}
"""
CYCLES = """
task: limit_cycle
parameters: {F: [10, 40, 60], k1: [1.0e3, 1.0e4], k2: 100, gamma3: 0.01}
accuracy: 1.0e-3
limit_cycle: {harmonics: 2}
"""
ARM = """
task: spectrum
parameters:
  arm: {length: 10 cm, radius: 5 mm, young: 100 kPa, viscosity: 1.4 Pa s, pressure: [1 kPa, 2 kPa]}
spectrum: {modes: 1}
"""
LONGITUDINAL = [("modes: 2", "modes: 2, longitudinal: true"), ("k2: 50", "k2: 50\n  gamma1: 1")]
CHAINS = CYCLES.replace("harmonics: 2", "harmonics: 2, start: neighbour, along: F")


def extended(command, small, changes, ranks=0):
    """The outcome of extending the file of a config after replacements, compared with a run of the whole."""
    large = small
    for old, new in changes:
        assert old in large
        large = large.replace(old, new)
    command.write("small.yaml", small)
    command.write("large.yaml", large)
    command.solved("small.yaml", "c.h5")
    done = command("run", "large.yaml", "-o", "c.h5", "--extend", ranks=ranks)
    assert done.returncode == 0, done.stderr
    command.solved("large.yaml")
    whole, added = (content(command.directory / name) for name in ("large.h5", "c.h5"))
    assert same(whole, added)
    assert not list(command.directory.glob("*.journal"))
    with h5py.File(command.directory / "large.h5") as one, h5py.File(command.directory / "c.h5") as other:
        for name in ("fingerprint", "config", "config_resolved"):
            assert one.attrs[name] == other.attrs[name]
        assert other.attrs["finished"]
    return done.stdout


@pytest.mark.parametrize(
    ("small", "changes", "todo"),
    [
        (SPECTRA, [("[10, 30]", "[5, 10, 20, 30, 40]"), ("k2: 50", "k2: [50, 60]")], "32 of 40"),
        pytest.param(SPECTRA, [("[10, 30]", "{start: 0, stop: 40, num: 5}")], "12 of 20", marks=survey_only),
        (SPECTRA, [("100, .inf", "100, 1.0e3, .inf")], "4 of 12"),
        pytest.param(SPECTRA, [("modes: 2", "modes: 3")], "8 of 8", marks=survey_only),
        (SPECTRA, [("modes: 2", "modes: 2, vectors: true, nodes: 5")], "8 of 8"),
        (SPECTRA.replace(".inf", "200"), LONGITUDINAL, "0 of 8"),
        pytest.param(
            SPECTRA.replace(".inf", "200").replace("k2: 50", "k2: 50\n  taper: 0.8"),
            LONGITUDINAL,
            "0 of 8",
            marks=survey_only,
        ),
        (THRESHOLDS, [("[100,", "[100, 170,"), ("crossings: 2", "crossings: 20")], "8 of 9"),
        (DIAGRAM, [("160,", "150, 160,"), ("false", "true")], "1 of 4"),
        pytest.param(DIAGRAM, [("num: 6", "num: 11")], "3 of 3", marks=survey_only),
        (MODES, [("[10, 20]", "[10, 15, 20]")], "1 of 3"),
        pytest.param(MODES, [("growth: false", "growth: true")], "2 of 2", marks=survey_only),
        pytest.param(CYCLES, [("[10, 40,", "[10, 20, 40,")], "2 of 8", marks=survey_only),
        (CYCLES, [("harmonics: 2", "harmonics: 3, samples: 4, shapes: 2, nodes: 5, time: tau1")], "4 of 6"),
        pytest.param(CYCLES, [("harmonics: 2", "harmonics: 2, transient: 7")], "6 of 6", marks=survey_only),
        (ARM, [("[1 kPa,", "[1 kPa, 1.5 kPa,")], "1 of 3"),
        pytest.param(CHAINS, [("60]", "60, 70]")], "2 of 8", marks=survey_only),
        pytest.param(CHAINS, [("40,", "40, 50,")], "4 of 8", marks=survey_only),
        (CHAINS, [("1.0e3,", "1.0e3, 2.0e3,")], "3 of 9"),
    ],
)
def test_extended_file_is_that_of_the_larger_config(command, small, changes, todo):
    told = extended(command, small, changes)
    assert f"{todo} points to do" in told


@pytest.mark.long
def test_extension_killed_at_any_point_goes_on_with_the_same_command(command):
    large = SPECTRA.replace("[10, 30]", "{start: 0, stop: 40, num: 41}")
    command.write("small.yaml", SPECTRA)
    command.write("large.yaml", large.replace("modes: 2", "modes: 2, vectors: true, nodes: 5"))
    command.solved("large.yaml")
    command.solved("small.yaml", "c.h5")
    path = command.directory / "c.h5"
    before = path.read_bytes()
    words = ("run", "large.yaml", "-o", "c.h5", "--extend")
    process = command.started(*words, ranks=2, patch=slowly(FOR_EVER, 20))
    pause_until_journalled(process, path, 40)
    kill(process.pid, *ranks_in(command.directory).values())
    process.communicate()
    wait_for_end(command.directory)
    assert (command.directory / "c.h5.journal" / "before-1.h5").read_bytes() == before
    again = command(*words)
    assert again.returncode == 0, again.stderr
    assert "124 of 164 points to do, 40 kept" in again.stdout
    assert same(content(path), content(command.directory / "large.h5"))
    assert not (command.directory / "c.h5.journal").exists()


@pytest.mark.parametrize("step", ["write_records", "seal", "delete_matching_files"])
def test_kill_while_the_file_is_exchanged_loses_nothing(command, step):
    """Before the new file is whole, before it takes the name, and right after it has."""
    command.write("small.yaml", SPECTRA)
    command.write("large.yaml", SPECTRA.replace("[10, 30]", "[10, 20, 30]"))
    command.solved("large.yaml")
    command.solved("small.yaml", "c.h5")
    path, words = command.directory / "c.h5", ("run", "large.yaml", "-o", "c.h5", "--extend")
    before = path.read_bytes()
    module = "replacement" if step == "seal" else "result_file_writer"
    patch = f"""
import os, signal
from rodsweep.results.file import {module}
def end(*words):
    if words[-1] != "rank-*":  # journals are dropped before, too
        os.kill(os.getpid(), signal.SIGKILL)
{module}.{step} = end
"""
    assert command(*words, patch=patch).returncode == -9
    assert (path.read_bytes() == before) == (step != "delete_matching_files")
    again = command(*words)
    assert again.returncode == 0, again.stderr
    assert "4 of 12 points to do, 8 kept" in again.stdout
    assert same(content(path), content(command.directory / "large.h5"))
    assert not (command.directory / "c.h5.journal").exists()


def test_journal_of_an_interrupted_run_is_extended_too(command):
    command.write("small.yaml", SPECTRA)
    command.write("large.yaml", SPECTRA.replace("[10, 30]", "[10, 20, 30]"))
    process = command.started("run", "small.yaml", "-o", "c.h5", ranks=1, patch=slowly(FOR_EVER, 5))
    pause_until_journalled(process, command.directory / "c.h5", 5)
    kill(process.pid, *ranks_in(command.directory).values())
    process.communicate()
    wait_for_end(command.directory)
    done = command("run", "large.yaml", "-o", "c.h5", "--extend")
    assert "7 of 12 points to do, 5 kept" in done.stdout
    command.solved("large.yaml")
    assert same(*(content(command.directory / name) for name in ("c.h5", "large.h5")))


def test_value_that_rounding_has_moved_is_computed_anew(command):
    moved = float(np.nextafter(30, 31))
    command.write("small.yaml", SPECTRA.replace("30]", f"{moved!r}]"))
    command.write("large.yaml", SPECTRA)
    command.solved("small.yaml", "c.h5")
    done = command("run", "large.yaml", "-o", "c.h5", "--extend")
    assert "4 of 8 stored points are computed again" in done.stdout
    assert "4 of 8 points to do, 4 kept" in done.stdout
    command.solved("large.yaml")
    assert same(*(content(command.directory / name) for name in ("c.h5", "large.h5")))


def test_list_of_points_is_extended_in_any_order(command):
    listed = "task: spectrum\nparameters: {points: p.csv}\nspectrum: {modes: 2}\n"
    command.write("a.yaml", listed)
    command.write("p.csv", "F,k1,k2,gamma3\n10,100,50,0\n20,100,50,0\n")
    assert command("run", "a.yaml", "-o", "c.h5").returncode == 0
    command.write("p.csv", "gamma3,F,k1,k2\n0,30,100,50\n0,20,100,50\n0,10,100,50\n")
    done = command("run", "a.yaml", "-o", "c.h5", "--extend")
    assert "1 of 3 points to do, 2 kept" in done.stdout
    assert command("run", "a.yaml").returncode == 0
    assert same(*(content(command.directory / name) for name in ("c.h5", "a.h5")))
    command.write("p.csv", "gamma3,F,k1,k2\n0,30,100,50\n0,10,100,50\n")
    refused = command("run", "a.yaml", "-o", "c.h5", "--extend")
    assert (refused.returncode, "F = 20, k1 = 100" in refused.stderr) == (2, True), refused.stderr


@pytest.mark.parametrize(
    ("small", "old", "new", "sentence"),
    [
        (SPECTRA, "[10, 30]", "[10, 20]", "parameters.F = 30 is in the file and not in the config"),
        (SPECTRA, ".inf", "1.0e300", "parameters.k1 = inf is in the file and not in the config"),
        (SPECTRA, "modes: 2", "modes: 1", "spectrum.modes is 2 in the file and 1 in the config"),
        (SPECTRA, "modes: 2}", "modes: 2}\naccuracy: 1.0e-8", "accuracy is 1e-10 in the file and 1e-08"),
        (SPECTRA, "modes: 2", "modes: 2, certify: false", "spectrum.certify is true in the file and false"),
        (
            SPECTRA,
            "modes: 2",
            "modes: 2, method: krylov_schur",
            'spectrum.method is "determinant" in the file',
        ),
        (SPECTRA, SPECTRA, THRESHOLDS, 'task is "spectrum" in the file and "thresholds" in the config'),
        (DIAGRAM, "num: 6", "num: 7", "parameters.F = 20 is in the file and not in the config"),
        (CHAINS, "along: F", "along: k1", 'limit_cycle.along is "F" in the file and "k1" in the config'),
    ],
)
def test_what_does_not_contain_the_file_is_refused(command, small, old, new, sentence):
    command.write("small.yaml", small)
    assert old in small
    command.write("large.yaml", small.replace(old, new))
    command.solved("small.yaml", "c.h5")
    before = (command.directory / "c.h5").read_bytes()
    done = command("run", "large.yaml", "-o", "c.h5", "--extend")
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert sentence in done.stderr
    assert (command.directory / "c.h5").read_bytes() == before
    assert not (command.directory / "c.h5.journal").exists()


PROFILE = "material: {profile: {u: [0, 1], k1: [1, 2], k2: [1, 2], k3: [1, 2]}}\n"
RUBBER = "material: {law: neo_hookean, section: swelling}\n"


@pytest.mark.parametrize(
    ("stored", "asked", "sentence"),
    [
        (THRESHOLDS, THRESHOLDS + RUBBER, "material is not given in the file"),
        (THRESHOLDS + RUBBER, THRESHOLDS.replace("200]", "200, 300]"), "material"),
        (THRESHOLDS + RUBBER, THRESHOLDS + PROFILE, "material.law"),
        (THRESHOLDS, THRESHOLDS.replace("}", ", taper: 0.8}", 1), "parameters"),
        (CYCLES, CYCLES.replace("gamma3: 0.01", "gamma3: 0.01, gamma1: 2"), "gamma1"),
    ],
)
def test_a_file_of_other_rods_is_not_extended(command, stored, asked, sentence):
    command.write("a.yaml", stored)
    command.write("b.yaml", asked)
    assert command("run", "a.yaml", "-o", "c.h5").returncode in (0, 1)
    before = (command.directory / "c.h5").read_bytes()
    refused = command("run", "b.yaml", "-o", "c.h5", "--extend")
    assert (refused.returncode, sentence in refused.stderr) == (2, True), refused.stderr
    assert (command.directory / "c.h5").read_bytes() == before


@pytest.mark.parametrize(("old", "new", "told"), [("30]", "30, 40]", True), ("30]", "40]", False)])
def test_refusal_names_extend_where_it_helps(command, old, new, told):
    command.write("small.yaml", SPECTRA)
    command.write("large.yaml", SPECTRA.replace(old, new))
    command.solved("small.yaml", "c.h5")
    refused = command("run", "large.yaml", "-o", "c.h5")
    assert refused.returncode == 2
    assert ("--extend computes only the missing points" in refused.stderr) == told


def test_extend_makes_a_new_file_and_continues_its_own(command):
    command.write("c.yaml", SPECTRA)
    assert "8 of 8 points to do" in command("run", "c.yaml", "--extend").stdout
    assert "complete, nothing to do" in command("run", "c.yaml", "--extend").stdout
    both = command("run", "c.yaml", "--extend", "--fresh")
    assert (both.returncode, "--fresh and --extend are both given" in both.stderr) == (2, True)


@pytest.mark.parametrize("extend", [(), ("--extend",)], ids=["continued", "extended"])
def test_a_finished_file_has_the_text_of_the_last_config(command, extend):
    command.write("c.yaml", SPECTRA)
    command.solved("c.yaml")
    *first, last = SPECTRA.strip().splitlines()
    text = "\n".join(["# the options come first", last, *first, ""])
    command.write("c.yaml", text)
    assert "complete, nothing to do" in command("run", "c.yaml", *extend).stdout
    path = command.directory / "c.h5"
    with h5py.File(path) as file:
        assert file.attrs["config"] == text
    before = path.read_bytes()
    assert command("run", "c.yaml", *extend).returncode == 0
    assert path.read_bytes() == before


@pytest.mark.parametrize(
    ("text", "old", "new", "is_same"),
    [
        (SPECTRA, "[10, 30]", "{start: 10, stop: 30, num: 2}", True),
        (SPECTRA, "[0, 1.0e-4]", "[-0.0, 0.0001]", True),
        (SPECTRA, "modes: 2}", "modes: 2, certify: true}\ntitle: another", True),
        (SPECTRA, "modes: 2", "modes: 2, certify: false", False),
        (SPECTRA, "[10, 30]", "[10, 30.000000000000004]", False),
        (CHAINS, "along: F", "along: longest", True),
        (CHAINS, "along: F", "along: k1", False),
        (CHAINS, "start: neighbour, along: F", "start: mode", False),
        (CYCLES, "k2: 100", "k2: [100], gamma1: 1", True),
        (DIAGRAM, "{start: 10, stop: 60, num: 6}", "[10, 20, 30, 40, 50, 60]", True),
        (DIAGRAM, "{start: 10, stop: 60, num: 6}", "[10, 20, 30, 40, 50, 61]", False),
        (DIAGRAM, "k1: [160, 200, 1.0e3]", "k1: [160, 200, 1.0e3, 1.0e4]", False),
    ],
)
def test_what_changes_no_number_makes_no_other_config(text, old, new, is_same):
    assert old in text
    assert (asked(text) == asked(text.replace(old, new))) == is_same


def asked(text):
    """The fingerprint of the config of a grid."""
    config = validated_config(YAML(typ="safe").load(text))
    columns = [config.parameters.axes[name].array() for name in config.parameter_names]
    return fingerprint_of(resolved_config(config), columns)


@pytest.mark.parametrize(
    "words", [("run", "c.yaml"), ("show", "c.h5"), ("merge", "m.h5", "c.h5"), ("export", "c.h5")]
)
def test_newer_format_is_refused_in_a_sentence(command, words):
    command.write("c.yaml", SPECTRA)
    assert command("run", "c.yaml").returncode == 0
    path = command.directory / "c.h5"
    with h5py.File(path, "r+") as file:
        assert file.attrs["format"] == FORMAT_NUMBER
        file.attrs["format"] = FORMAT_NUMBER + 1
    before = path.read_bytes()
    refused = command(*words)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert f"has format {FORMAT_NUMBER + 1}, written by rodsweep" in refused.stderr
    assert path.read_bytes() == before
    with pytest.raises(InputError, match="has format"):
        open_result(path)


@pytest.mark.parametrize("words", [("run", "c.yaml"), ("show", "c.h5"), ("merge", "m.h5", "c.h5")])
def test_earlier_format_is_refused_in_a_sentence(command, words):
    command.write("c.yaml", SPECTRA)
    assert command("run", "c.yaml").returncode == 0
    path = command.directory / "c.h5"
    with h5py.File(path, "r+") as file:
        file.attrs["format"] = FORMAT_NUMBER - 1
        del file.attrs["seal"]
    before = path.read_bytes()
    refused = command(*words)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert f"was written by an earlier rodsweep ({__version__}, commit" in refused.stderr
    assert path.read_bytes() == before
    with pytest.raises(InputError, match="was written by an earlier"):
        open_result(path)
