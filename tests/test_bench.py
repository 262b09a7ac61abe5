"""The command bench: what it writes, what it refuses; timing in turns; the errors of the spectrum's peers."""

import subprocess
import sys

import h5py
import mpmath as mp
import numpy as np
import pytest

from rodsweep.bench.spectrum import study as spectrum
from rodsweep.bench.spectrum.eigensolvers import (
    PEERS,
    WANTED_MODES,
    chebyshev_first_order,
    dense_inverse,
    displacement_elements,
    own_spectrum,
)
from rodsweep.bench.spectrum.exact import exact_spectrum, relative_error
from rodsweep.bench.spectrum.study import HARD_RODS, every_size, hard_table, spectrum_study
from rodsweep.bench.study import Contender, Measurement, Study, contest, race
from rodsweep.model.rod import Rod
from rodsweep.results.file.measurements import write_measurements

EASY = Rod(30.0, 1e4, 1e4, 1e-4)


def test_exact_eigenvalues_are_those_of_the_reference(reference_spectra):
    for point in reference_spectra[::20]:
        rod = Rod(*(float(point[name]) for name in ("F", "k1", "k2", "gamma3")))
        if rod.F < 0 or max(point["condition"]) > 50:
            continue
        with mp.workdps(40):
            for root, parts in zip(exact_spectrum(rod, 4), point["eigenvalues"], strict=False):
                listed = mp.mpc(*parts)
                assert abs(root - listed) < mp.mpf(10) ** -23 * abs(listed)


def test_exact_eigenvalues_are_refused_where_they_are_not_proved():
    with pytest.raises(ArithmeticError, match="undecided"):
        exact_spectrum(Rod(37.6559805452711, 1e4, 1e4, 1e-4), 2)


def test_error_is_that_of_the_worst_eigenvalue_and_infinite_for_none():
    roots = [mp.mpc(1), mp.mpc(2)]
    assert relative_error(np.array([2.0 + 1e-6j, 1.0]), roots) == pytest.approx(5e-7)
    assert relative_error(np.array([1.0]), roots) == pytest.approx(0.5)
    assert relative_error(np.empty(0), roots) == np.inf


@pytest.mark.parametrize("peer", PEERS, ids=lambda peer: peer.name)
def test_every_peer_converges_to_the_exact_eigenvalues(peer):
    """Spectrally: two sizes farther the error is a hundredth, until rounding; at its best below 1e-9."""
    roots = exact_spectrum(EASY, WANTED_MODES)
    errors = [relative_error(peer.solve(EASY, size), roots) for size in peer.sizes]
    assert min(errors) < 1e-9
    coarse = [error for error in errors if error > 1e-8]
    assert all(later < earlier / 10 for earlier, later in zip(coarse[:-1], coarse[1:], strict=True))


def test_forms_without_stiffness_keep_their_digits_where_the_plain_ones_lose_them():
    stiff = HARD_RODS[next(name for name in HARD_RODS if name.startswith("stiff"))]
    roots = exact_spectrum(stiff, WANTED_MODES)
    assert relative_error(dense_inverse(stiff, 18), roots) < 1e-12
    assert relative_error(chebyshev_first_order(stiff, 24), roots) < 1e-11
    assert relative_error(displacement_elements(stiff, 18), roots) > 1e-8


def test_own_error_on_the_hard_rods_is_rounding():
    for rod in HARD_RODS.values():
        for certify in (False, True):
            assert relative_error(own_spectrum(rod, certify), exact_spectrum(rod, WANTED_MODES)) < 1e-14


def test_method_that_fails_has_no_finite_error_and_says_how(monkeypatch):
    def fails(rod):
        raise np.linalg.LinAlgError("no convergence")

    monkeypatch.setattr(spectrum, "HARD_RODS", {"easy": EASY})
    rows = every_size([Contender("fails", "3", "a", fails)], 1)
    assert rows[-1].error == np.inf
    assert rows[-1].failure == "failed (LinAlgError)"
    assert "| fails | failed |" in hard_table(rows)


def test_race_takes_all_in_turn_and_times_the_second_of_two(monkeypatch):
    monkeypatch.setattr("rodsweep.bench.study.SHORT", np.inf)
    order = []
    raced = race([lambda: order.append("a"), lambda: order.append("b") or 7], [2, 1])
    assert order == ["a", "b", "a", "a", "b", "b", "a", "a"]
    assert [timed.outcome for timed in raced] == [None, 7]
    assert [len(timed.seconds) for timed in raced] == [2, 1]


def test_race_makes_long_runs_once_a_round(monkeypatch):
    monkeypatch.setattr("rodsweep.bench.study.SHORT", 0.0)
    order = []
    race([lambda: order.append("a"), lambda: order.append("b")], [2, 0])
    assert order == ["a", "b", "a", "a"]


def test_slow_method_is_run_once():
    runs = []
    (measurement,) = contest(
        "c", 3, [Contender("m", "s", "g", runs.append, slow=True)], 5, lambda _: {"error": 0.5}
    )
    assert runs == [3]
    assert (measurement.error, measurement.group) == (0.5, "g")
    assert np.isfinite(measurement.seconds)


def test_time_of_other_programs_is_counted():
    """The program ends when it has taken a tenth of a second of the processor, however long that may last."""
    words = [sys.executable, "-c", "import time\nwhile time.process_time() < 0.1: pass"]
    (timed,) = race([lambda: subprocess.run(words, check=True)], [1])
    assert timed.median > 0.05


def test_study_of_the_spectrum_has_a_row_for_every_method(monkeypatch, tmp_path):
    monkeypatch.setattr(spectrum, "HARD_RODS", {"easy": EASY})
    monkeypatch.setattr(spectrum, "FORCES", 1)
    study = spectrum_study(quick=True)
    for peer in PEERS:
        assert study.text.count(f"| {peer.name} |") == 2
    assert "| rodsweep, certificate on | 4 |" in study.text
    study.draw(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_numbers_of_a_study_are_in_the_file(tmp_path):
    rows = (
        Measurement("c", "m", "s", 0.5, 1e-3, "g", extra={"steps": 3.0}),
        Measurement("c", "n", "", 1.0, np.inf),
    )
    write_measurements(tmp_path / "a.h5", {"x": Study("x", "", rows).table()}, {"processor": "none"})
    with h5py.File(tmp_path / "a.h5") as file:
        assert file.attrs["processor"] == "none"
        assert file["x/seconds"][:].tolist() == [0.5, 1.0]
        assert file["x/method"].asstr()[:].tolist() == ["m", "n"]
        assert file["x/steps"][0] == 3.0
        assert np.isnan(file["x/steps"][1])


def test_study_without_errors_has_no_figure():
    assert not Study("x", "", (Measurement("c", "m", "s", 0.5, np.nan),)).drawable


@pytest.mark.parametrize("name", ["nowhere/a.md", "a.png", "a.h5", "."])
def test_a_name_that_cannot_take_the_markdown_is_refused_at_once(command, name):
    done = command("bench", "limit_cycle", "-o", name)
    assert done.returncode == 2
    assert done.stderr.startswith("rodsweep: --output")


def test_command_writes_markdown_numbers_and_figure(command, tmp_path):
    done = command("bench", "spectrum", "--quick", "-o", "b.md")
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "b.md").read_text()
    assert "## spectrum" in done.stdout
    assert text.startswith("# Performance\n")
    assert "| rodsweep, certificate on | 20 |" in text
    assert "![Errors against time, spectrum](b_spectrum.png)" in text
    assert (tmp_path / "b_spectrum.png").exists()
    with h5py.File(tmp_path / "b.h5") as file:
        assert np.isfinite(file["spectrum/error"][:]).sum() > 100
        assert file.attrs["petsc"]
