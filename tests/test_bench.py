"""The command bench: what it writes, what it refuses; timing in turns; the errors of the spectrum's peers."""

import h5py
import mpmath as mp
import numpy as np
import pytest

from rodsweep.bench.spectrum import study as spectrum
from rodsweep.bench.spectrum.exact import exact_spectrum, relative_error
from rodsweep.bench.spectrum.peers import PEERS, chebyshev_first_order, dense_inverse, displacement_elements
from rodsweep.bench.spectrum.study import HARD, MODES, every_size, spectrum_study
from rodsweep.bench.study import Measurement, Study, race
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
    roots = exact_spectrum(EASY, MODES)
    errors = [relative_error(peer.solve(EASY, size, MODES), roots) for size in peer.sizes]
    assert min(errors) < 1e-9
    coarse = [error for error in errors if error > 1e-8]
    assert all(later < earlier / 10 for earlier, later in zip(coarse[:-1], coarse[1:], strict=True))


def test_forms_without_stiffness_keep_their_digits_where_the_plain_ones_lose_them():
    stiff = HARD[next(name for name in HARD if name.startswith("stiff"))]
    roots = exact_spectrum(stiff, MODES)
    assert relative_error(dense_inverse(stiff, 18, MODES), roots) < 1e-12
    assert relative_error(chebyshev_first_order(stiff, 24, MODES), roots) < 1e-11
    assert relative_error(displacement_elements(stiff, 18, MODES), roots) > 1e-8


def test_own_error_on_the_hard_rods_is_rounding():
    for rod in HARD.values():
        for certify in (False, True):
            assert relative_error(spectrum.own(rod, certify), exact_spectrum(rod, MODES)) < 1e-14


def test_method_that_fails_is_a_measurement_without_time(monkeypatch):
    def fails(rod, size, modes):
        raise np.linalg.LinAlgError("no convergence")

    monkeypatch.setattr(spectrum, "PEERS", [spectrum.Peer("fails", "a", fails, (3,))])
    rows = every_size("easy", EASY, 1)
    assert rows[-1].error == np.inf
    assert np.isnan(rows[-1].seconds)
    assert "failed" in spectrum.hard_table(rows)


def test_race_takes_all_in_turn_and_times_the_second_of_two():
    order = []
    seconds, outcomes = race([lambda: order.append("a"), lambda: order.append("b") or 7], 2)
    assert order == ["a", "b", "a", "a", "b", "b", "a", "a", "b", "b"]
    assert outcomes == [None, 7]
    assert all(value >= 0 for value in seconds)


def test_study_of_the_spectrum_has_a_row_for_every_method(monkeypatch, tmp_path):
    monkeypatch.setattr(spectrum, "HARD", {"easy": EASY})
    monkeypatch.setattr(spectrum, "FORCES", 1)
    study = spectrum_study(quick=True)
    for peer in PEERS:
        assert study.text.count(f"| {peer.name} |") == 2
    assert "| rodsweep, certificate on | 4 |" in study.text
    study.draw(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_numbers_of_a_study_are_in_the_file(tmp_path):
    rows = (
        Measurement("c", "m", "s", 0.5, 1e-3, "g", {"steps": 3.0}),
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
    assert "### spectrum" in done.stdout
    assert "| rodsweep, certificate on | 20 |" in text
    assert "![Errors against time, spectrum](b_spectrum.png)" in text
    assert (tmp_path / "b_spectrum.png").exists()
    with h5py.File(tmp_path / "b.h5") as file:
        assert np.isfinite(file["spectrum/error"][:]).sum() > 100
        assert file.attrs["petsc"]
