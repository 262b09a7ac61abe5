"""The command bench: what it writes, what it refuses, where its peers are; timing in turns; the spectrum."""

import re
import subprocess
import sys
from functools import partial
from importlib.metadata import version

import h5py
import mpmath as mp
import numpy as np
import pytest
from conftest import ROOT
from reference import dense_arm
from rods import rod_of
from surveyed import survey_only

from rodsweep.bench import peers as bench_peers
from rodsweep.bench.peers import (
    NO_PEERS,
    PEER_PHRASES_BY_STUDY,
    PeerContribution,
    left_out_peers_sentence,
    peer_package,
    peers_of_study,
)
from rodsweep.bench.spectrum import arm_spectra
from rodsweep.bench.spectrum import study as spectrum
from rodsweep.bench.spectrum.arm_spectra import (
    ARM_RODS,
    UncachedArms,
    arm_table,
    exact_arm_spectrum,
    measure_arm_spectra,
)
from rodsweep.bench.spectrum.rodsweep_and_exact_spectra import (
    CERTIFIED_NAME,
    KRYLOV_SCHUR_NAME,
    MODE_COUNT,
    UNCERTIFIED_NAME,
    exact_spectrum,
    relative_error,
    rodsweep_spectrum,
)
from rodsweep.bench.spectrum.study import (
    ELEMENT_ORDERS,
    HARD_RODS,
    SPECTRUM_RACE_NAME,
    hard_rod_table,
    krylov_schur,
    measure_hard_rods,
    run_spectrum_study,
)
from rodsweep.bench.study import (
    BenchmarkReport,
    Measurement,
    TimedMethod,
    every_nth_setting,
    measure_case,
    time_runs,
)
from rodsweep.cli.benching import machine_attributes
from rodsweep.model.rod import Rod
from rodsweep.results.file.benchmark_file import write_measurements

EASY = Rod(F=30.0, k1=1e4, k2=1e4, gamma3=1e-4)


def test_exact_eigenvalues_are_those_of_the_reference(reference_spectra):
    for point in reference_spectra[::20]:
        rod = rod_of(*(float(point[name]) for name in ("F", "k1", "k2", "gamma3")))
        if rod.F < 0 or max(point["condition"]) > 50:
            continue
        with mp.workdps(40):
            for root, parts in zip(exact_spectrum(rod, 4), point["eigenvalues"], strict=False):
                listed = mp.mpc(*parts)
                assert abs(root - listed) < mp.mpf(10) ** -23 * abs(listed)


def test_exact_eigenvalues_are_refused_where_they_are_not_proved():
    with pytest.raises(ArithmeticError, match="undecided"):
        exact_spectrum(Rod(F=37.6559805452711, k1=1e4, k2=1e4, gamma3=1e-4), 2)


def test_error_is_that_of_the_worst_eigenvalue_and_infinite_for_none():
    roots = [mp.mpc(1), mp.mpc(2)]
    assert relative_error(np.array([2.0 + 1e-6j, 1.0]), roots) == pytest.approx(5e-7)
    assert relative_error(np.array([1.0]), roots) == pytest.approx(0.5)
    assert relative_error(np.empty(0), roots) == np.inf


def test_the_solver_alone_converges_to_the_exact_eigenvalues():
    """Spectrally: two sizes farther the error is a hundredth, until rounding; at its best below 1e-9."""
    roots = exact_spectrum(EASY, MODE_COUNT)
    errors = [relative_error(krylov_schur(EASY, size), roots) for size in ELEMENT_ORDERS]
    assert min(errors) < 1e-9
    coarse = [error for error in errors if error > 1e-8]
    assert all(later < earlier / 10 for earlier, later in zip(coarse[:-1], coarse[1:], strict=True))


def test_own_error_on_the_hard_rods_is_rounding():
    for rod in HARD_RODS.values():
        for certify in (False, True):
            assert relative_error(rodsweep_spectrum(rod, certify), exact_spectrum(rod, MODE_COUNT)) < 1e-14


@pytest.mark.parametrize("rod", ARM_RODS.values(), ids=list(ARM_RODS))
def test_exact_eigenvalues_of_arms_are_those_of_another_code(rod):
    """The other code loses digits in stiff arms."""
    found = dense_arm.eigenvalues(rod, p=10)[:MODE_COUNT]
    assert relative_error(found, exact_arm_spectrum(rod)) < 1e-8
    for certify in (False, True):
        assert relative_error(rodsweep_spectrum(rod, certify), exact_arm_spectrum(rod)) < 1e-13


def test_no_arm_is_solved_twice():
    """A solved arm is kept, and its second spectrum would cost nothing."""
    arm = UncachedArms(ARM_RODS["cone"])
    forces = [arm.next_arm().F for _ in range(60)]
    assert len(set(forces)) == 60
    assert forces[-1] < ARM_RODS["cone"].F * (1 + 1e-13)


def test_table_of_arms_has_time_and_error_of_every_method(monkeypatch):
    monkeypatch.setattr(arm_spectra, "ARM_RODS", {"cone": ARM_RODS["cone"]})
    bad = TimedMethod("coarse", "3", "a", lambda arm: np.ones(MODE_COUNT, complex))
    lines = arm_table(measure_arm_spectra([bad], 1), 1).splitlines()
    assert lines[2] == "| method | cone |"
    for name in (UNCERTIFIED_NAME, CERTIFIED_NAME, KRYLOV_SCHUR_NAME):
        (line,) = (line for line in lines if line.startswith(f"| {name} |"))
        assert re.fullmatch(r"\d+\.\d\d ms, \de-1\d", line.split(" | ")[1].rstrip(" |"))
    assert lines[-1].startswith("| coarse | no better than 1e+")


def test_method_that_fails_has_no_finite_error_and_says_how(monkeypatch):
    def fails(rod):
        raise np.linalg.LinAlgError("no convergence")

    monkeypatch.setattr(spectrum, "HARD_RODS", {"easy": EASY})
    rows = measure_hard_rods([TimedMethod("fails", "3", "a", fails)], 1)
    assert rows[-1].error == np.inf
    assert rows[-1].failure == "failed (LinAlgError)"
    assert "| fails | failed |" in hard_rod_table(rows)


def test_race_takes_all_in_turn_and_times_the_second_of_two(monkeypatch):
    monkeypatch.setattr("rodsweep.bench.study.MAX_CACHE_SENSITIVE_SECONDS", np.inf)
    order = []
    raced = time_runs([lambda: order.append("a"), lambda: order.append("b") or 7], [2, 1])
    assert order == ["a", "b", "a", "a", "b", "b", "a", "a"]
    assert [timed.outcome for timed in raced] == [None, 7]
    assert [len(timed.processor_seconds) for timed in raced] == [2, 1]


def test_race_makes_long_runs_once_a_round(monkeypatch):
    monkeypatch.setattr("rodsweep.bench.study.MAX_CACHE_SENSITIVE_SECONDS", 0.0)
    order = []
    time_runs([lambda: order.append("a"), lambda: order.append("b")], [2, 0])
    assert order == ["a", "b", "a", "a"]


def test_slow_method_is_run_once():
    runs = []
    (measurement,) = measure_case(
        "c", 3, [TimedMethod("m", "s", "g", runs.append, is_slow=True)], 5, lambda _: {"error": 0.5}
    )
    assert runs == [3]
    assert (measurement.error, measurement.group) == (0.5, "g")
    assert np.isfinite(measurement.seconds)


def test_time_of_other_programs_is_counted():
    """The program ends when it has taken a tenth of a second of the processor, however long that may last."""
    words = [sys.executable, "-c", "import time\nwhile time.process_time() < 0.1: pass"]
    (timed,) = time_runs([lambda: subprocess.run(words, check=True)], [1])
    assert timed.median_seconds > 0.05


def test_study_of_the_spectrum_has_a_row_for_every_method(monkeypatch, tmp_path):
    monkeypatch.setattr(spectrum, "HARD_RODS", {"easy": EASY})
    monkeypatch.setattr(spectrum, "FORCE_COUNT", 1)
    monkeypatch.setattr(arm_spectra, "ARM_RODS", {"cone": ARM_RODS["cone"]})
    exact = TimedMethod("a peer", "7", "g", partial(rodsweep_spectrum, certify=False))
    study = run_spectrum_study(
        quick=True,
        peers=PeerContribution({SPECTRUM_RACE_NAME: [exact]}, skipped_peer_sentences=["Another is skipped."]),
    )
    for name in ("rodsweep, certificate on", "rodsweep, certificate off", KRYLOV_SCHUR_NAME, "a peer"):
        assert study.text.count(f"| {name} |") == (2 if name == "a peer" else 3)
        assert f"| {name} | 4 |" in study.text
    assert study.text.endswith("\n\nAnother is skipped.")
    study.draw(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_a_quick_run_takes_every_nth_setting_of_each_method():
    every = [TimedMethod(method, str(k), "", print) for method in "ab" for k in range(4)]
    taken = [(c.method, c.setting) for c in every_nth_setting(every, 3)]
    assert taken == [("a", "0"), ("a", "3"), ("b", "0"), ("b", "3")]


def test_numbers_of_a_study_are_in_the_file(tmp_path):
    rows = (
        Measurement("c", "m", "s", 0.5, 1e-3, "g", extra_columns={"steps": 3.0}),
        Measurement("c", "n", "", 1.0, np.inf),
    )
    write_measurements(
        tmp_path / "a.h5", {"x": BenchmarkReport("x", "", rows).table()}, {"processor": "none"}
    )
    with h5py.File(tmp_path / "a.h5") as file:
        assert file.attrs["processor"] == "none"
        assert file["x/seconds"][:].tolist() == [0.5, 1.0]
        assert file["x/method"].asstr()[:].tolist() == ["m", "n"]
        assert file["x/steps"][0] == 3.0
        assert np.isnan(file["x/steps"][1])


def test_study_without_errors_has_no_figure():
    assert not BenchmarkReport("x", "", (Measurement("c", "m", "s", 0.5, np.nan),)).is_drawable


@pytest.mark.parametrize("name", ["nowhere/a.md", "a.png", "a.h5", "."])
def test_a_name_that_cannot_take_the_markdown_is_refused_at_once(command, name):
    done = command("bench", "limit_cycle", "-o", name)
    assert done.returncode == 2
    assert done.stderr.startswith("rodsweep: --output")


@survey_only
def test_command_times_the_peers_of_its_checkout(command, tmp_path):
    done = command("bench", "spectrum", "--quick", "-o", "b.md")
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "b.md").read_text()
    assert "## spectrum" in done.stdout
    assert "are left out" not in text
    assert text.startswith("# Performance\n")
    assert "| rodsweep, certificate on | 20 |" in text
    assert "| Chebyshev, first-order system, QZ | 20 |" in text
    assert f"scipy {version('scipy')}" in text
    assert "![Errors against time, spectrum](b_spectrum.png)" in text
    assert (tmp_path / "b_spectrum.png").exists()
    with h5py.File(tmp_path / "b.h5") as file:
        assert np.isfinite(file["spectrum/error"][:]).sum() > 100
        assert file.attrs["petsc"]


@pytest.mark.long
def test_command_without_the_folder_times_rodsweep_alone_and_says_who_is_left_out(command, tmp_path):
    """As installed: the package without what is beside it."""
    (tmp_path / "site").mkdir()
    (tmp_path / "site" / "rodsweep").symlink_to(ROOT / "rodsweep")
    done = command.afresh("bench", "spectrum", "--quick", "-o", "b.md", PYTHONPATH=str(tmp_path / "site"))
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "b.md").read_text()
    sentence = left_out_peers_sentence(["spectrum"])
    assert f"\n\n{sentence}\n\n## spectrum" in text
    assert sentence in done.stdout
    assert sentence.count(". ") == 0
    assert "Chebyshev" in sentence
    assert "--peers CHECKOUT/benchmarks" in sentence
    methods = re.findall(r"^\| ([^|]*) \| 20 \|", text, re.MULTILINE)
    assert methods == ["rodsweep, certificate off", "rodsweep, certificate on", KRYLOV_SCHUR_NAME]


@pytest.mark.long
def test_command_takes_peers_from_a_folder_that_is_named(command, tmp_path):
    write_peers(tmp_path / "mine")
    done = command("bench", "spectrum", "--quick", "-o", "b.md", "--peers", "mine")
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "b.md").read_text()
    assert "mine 1.2" in text
    assert "| zero |" in text
    assert "Chebyshev" not in text


@pytest.mark.parametrize("name", ["nowhere", "empty", "other"])
def test_a_folder_without_peers_is_refused_at_once(command, tmp_path, name):
    (tmp_path / "empty").mkdir()
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "__init__.py").touch()
    done = command("bench", "spectrum", "--peers", name)
    assert done.returncode == 2
    wanted = "must be the folder `benchmarks` of a checkout of rodsweep"
    assert done.stderr == f"rodsweep: --peers {name} {wanted}\n"
    assert not (tmp_path / "bench.md").exists()


def write_peers(directory):
    """A folder of peers, with one for the spectrum that says zero."""
    directory.mkdir()
    (directory / "__init__.py").write_text("def versions():\n    return {'mine': '1.2'}\n")
    (directory / "spectrum.py").write_text(
        "import numpy as np\n"
        "from rodsweep.bench.peers import PeerContribution\n"
        "from rodsweep.bench.study import TimedMethod\n"
        "def peers(quick, place):\n"
        "    zero = TimedMethod('zero', '1', 'g', lambda rod: np.zeros(5))\n"
        "    return PeerContribution({'spectrum': [zero]})\n"
    )


def test_a_study_without_peers_in_the_folder_has_none(tmp_path):
    package = peer_package(None)
    assert package.__file__ == str(ROOT / "benchmarks" / "__init__.py")
    assert peers_of_study(package, "sweep", True, tmp_path) is NO_PEERS
    assert peers_of_study(None, "spectrum", True, tmp_path) is NO_PEERS
    assert left_out_peers_sentence(["sweep"]) == ""


@pytest.mark.parametrize("missing", ["pyproject.toml", "benchmarks/__init__.py"])
def test_a_folder_of_this_name_that_is_no_checkouts_is_left_alone(monkeypatch, tmp_path, missing):
    """Other packages too bring a folder `benchmarks` to where packages are installed."""
    (tmp_path / "benchmarks").mkdir()
    for name in {"pyproject.toml", "benchmarks/__init__.py"} - {missing}:
        (tmp_path / name).touch()
    monkeypatch.setattr(bench_peers, "RODSWEEP_CHECKOUT_FOLDER", tmp_path)
    assert peer_package(None) is None


def test_who_is_left_out_is_said_for_every_study_with_peers():
    rooms = [path.parent.name for path in (ROOT / "benchmarks").glob("*/__init__.py")]
    assert sorted(PEER_PHRASES_BY_STUDY) == sorted(rooms)


def test_a_benchmark_names_its_processor():
    """By words, as /proc/cpuinfo or else the platform has it, and not by the number of a core."""
    assert re.search("[A-Za-z]{2}", machine_attributes()["processor"])


def test_a_figure_that_the_disk_refuses_leaves_the_old_figure(tmp_path):
    """A limit on the size of files fails in `write` as a full disk does."""
    output = tmp_path / "a.png"
    output.write_bytes(b"old")
    code = f"""
import resource, signal
from pathlib import Path
from rodsweep.errors import EnvironmentIncomplete
from rodsweep.post.work_precision import draw_work_precision
table = dict(case=["a"], method=["b"], group=["c"], seconds=[1.0], error=[1e-3])
draw_work_precision(table, "ms", None, Path({str(tmp_path / "whole.png")!r}))
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
try:
    draw_work_precision(table, "ms", None, Path({str(output)!r}))
except EnvironmentIncomplete as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "a.png cannot be written: File too large" in done.stdout
    assert output.read_bytes() == b"old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.png", "whole.png"]
