"""The configs of the paper's figures on coarser grids: each gives the number in its head comment.

Every config is run as by a user, its figure is drawn, and its result is opened.
"""

import re
from math import isnan

import h5py
import matplotlib.image
import numpy as np
import pytest
import xarray as xr
from conftest import ROOT
from surveyed import few

import rodsweep as rs

CONFIGS = ROOT / "configs"
FILAMENT = 37.6954308403185779  # Fc, 27 digits in tests/reference/thresholds.json


def stated(name):
    """The numbers in a config's head comment, as floats."""
    head = "".join(line for line in (CONFIGS / f"{name}.yaml").read_text().splitlines(True) if line[0] == "#")
    return [float(number) for number in re.findall(r"-?\d+\.\d+", head)]


def run(command, name, *overrides):
    """The coarse run of a config: its file, open; the figure is drawn beside it."""
    words = [word for override in overrides for word in ("--set", override)]
    outcome = command("run", CONFIGS / f"{name}.yaml", *words)
    assert outcome.returncode == 0, outcome.stderr
    drawn = command.drawn("plot", f"{name}.h5", "-o", f"{name}.png")
    assert drawn.returncode == 0, drawn.stderr
    picture = matplotlib.image.imread(command.directory / f"{name}.png")
    assert np.ptp(picture[..., :3]) > 0.5
    xr.open_dataset(command.directory / f"{name}.h5", engine="h5netcdf").close()
    return h5py.File(command.directory / f"{name}.h5")


def test_every_config_says_what_to_expect():
    for path in CONFIGS.glob("*.yaml"):
        head = path.read_text().split("\n\n")[0]
        assert "# Expected: " in head, path
        assert stated(path.stem), path


@pytest.mark.parametrize(
    ("name", "onset", "hopf", "frequency"),
    [("fig2a", 0, 1, 2), ("fig2b", 0, 1, 2), ("fig2c", None, 0, 1), ("fig2d", 0, None, None)],
)
def test_figure_2(command, name, onset, hopf, frequency):
    """Just below and just above each threshold that the comment states."""
    numbers = stated(name)
    at = [numbers[i] for i in (onset, hopf) if i is not None]
    forces = [F * (1 + side) for F in at for side in (-1e-9, 1e-9)]
    with run(command, name, f"parameters.F={forces}", "accuracy=1e-2") as file:
        w, unstable = file["frequency"][:, 0, 0, 0, 0], file["unstable_count"][:, 0, 0, 0]
        if onset is not None:
            assert w[0] == 0 < w[1]
        if hopf is not None:
            assert unstable[-2:].tolist() == [0, 2]
            assert w[-1] == pytest.approx(numbers[frequency], rel=1e-4)
        else:
            assert (unstable == 0).all()


def test_figure_3(command):
    onset, hopf, *_ = stated("fig3")
    axes = "parameters.k2=[20, 1.0e4, 1.0e8]", "parameters.gamma3=[1.0e-8, 1.0e-4, 1.0]"
    with run(command, "fig3", *axes) as file:
        F_onset, F_hopf = file["F_onset"][0], file["F_hopf"][0]
        assert F_onset[1, 1] == pytest.approx(onset, rel=1e-12)
        assert F_hopf[1, 1] == pytest.approx(hopf, rel=1e-12)
        # The plateau is the filament's, compressed as k1 = 1e4 does: F (1 - F/k1) = Fc.
        plateau = F_hopf[2, 0]
        assert plateau * (1 - plateau / 1e4) == pytest.approx(FILAMENT, rel=1e-6)
        assert (np.diff(F_hopf, axis=0) > 0).all()
        # The paper: "increase monotonically" with 1/gamma3. At k2 = 20 the onset does not.
        assert (np.diff(F_onset[1:], axis=1) < 0).all()
        assert file["certified"][:].all()


def test_the_onset_of_a_soft_rod_does_not_rise_with_inverse_drag(command):
    """Beside the paper's Fig. 3: for k2 below about 34 the onset has a minimum over gamma3."""
    axes = "parameters.k2=5", "parameters.gamma3=[0.01, 0.5, 10]"
    with run(command, "fig3", *axes) as file:
        small, middle, large = file["F_onset"][0, 0]
        assert middle < large < small
    assert (
        "F_onset rises with 1/gamma3 on 0 of 1 line of rods, is not monotone on 1"
        in command("show", "fig3.h5").stdout
    )


@pytest.mark.long
def test_figure_4(command):
    k1, F, partial = stated("fig4")[:3]
    axes = "parameters.F.num=51", "parameters.k1.num=17"
    with run(command, "fig4", *axes) as file:
        folds = [i for i in range(len(file["fold"])) if file["fold_kind"][i] == 1 and file["fold_of"][i] == 1]
        (fold,) = folds
        assert file["fold_k1"][fold] == pytest.approx(k1, rel=1e-12)
        assert file["fold_F"][fold] == pytest.approx(F, rel=1e-10)
        assert abs(file["fold_F"][fold] - F) <= file["fold_F_error"][fold] < 1e-8
        assert file["partial_beam_k1"][()] == pytest.approx(partial, rel=1e-12)
        assert file["curve_agreement"][()] < 1e-11
        assert file["curves_untraced"][()] == 0
        # The map knows the class on either side of the window, and of a crushed rod.
        words = dict(
            zip(file["class"].attrs["flag_values"], file["class"].attrs["flag_meanings"].split(), strict=True)
        )
        row = int(np.argmin(np.abs(file["k1"][:] - 200)))
        classes = [words[c] for c in file["class"][row, 0, 0]]
        assert [c for c, before in zip(classes, [None, *classes], strict=False) if c != before] == [
            "monotone", "oscillatory", "flutter", "oscillatory", "crushed",
        ]  # fmt: skip
    told = command("show", "fig4.h5").stdout.replace("\n", " ")
    assert f"k1 = {k1:.13g}" in told
    assert "4 Fc = 150.7817233613" in told


@pytest.mark.parametrize("name", ["fig7", "fig8", "fig9"])
def test_figures_7_to_9(command, name):
    growth_rate, *frequency = stated(name)[:2] if name != "fig7" else stated(name)[:1]
    with run(command, name, "modes.nodes=17") as file:
        first = (0, 0, 0, 0, 0)
        assert file["growth_rate"][first] == pytest.approx(growth_rate, rel=1e-11)
        assert file["frequency"][first] == pytest.approx(frequency[0] if frequency else 0, rel=1e-11)
        assert file["Y_real"][first][-1] == pytest.approx(1, rel=1e-12)
        growth = file["transient_growth"][0, 0, 0, 0]
        assert not isnan(growth)
        assert np.isinf(growth) == (name == "fig9")


@pytest.mark.long
def test_figure_5(command):
    T_one, y_one, _, T_half, y_half = stated("fig5")
    with run(command, "fig5", "limit_cycle.samples=32", "limit_cycle.shapes=8") as file:
        assert file["period"][:].ravel() == pytest.approx([T_half, T_one], rel=1e-8)
        assert file["tip_y_max"][:].ravel() == pytest.approx([y_half, y_one], abs=1e-8)
        assert (file["multiplier"][:] < 1).all()
        assert np.abs(file["energy_imbalance"][:]).max() < 1e-8
        assert file["shape_y"].shape[-2:] == (8, 33)


@pytest.mark.long
def test_beating_arm(command):
    """By collocation, in the survey by integration too; the config states 17.7890 s and 6.46957 cm too."""
    of_period, seconds, of_height, centimetres = stated("beating_arm")[-4:]
    for method, accuracy in few((("collocation", "1e-6"), ("integration", "1e-5")), 1):
        overrides = f"limit_cycle.method={method}", "limit_cycle.shapes=8", f"accuracy={accuracy}"
        with run(command, "beating_arm", *overrides) as file:
            period, y, period_si, y_si = (
                file[name][...].item() for name in ("period", "tip_y_max", "period_si", "tip_y_max_si")
            )
            assert [period, y] == pytest.approx([of_period, of_height], rel=2 * float(accuracy))
            assert [period_si, 100 * y_si] == pytest.approx([seconds, centimetres], rel=2 * float(accuracy))
            assert file["status"][...].item() == 0
        (command.directory / "beating_arm.h5").unlink()


@pytest.mark.long
def test_figure_6(command):
    hopf = stated("fig6")[0]
    forces = f"parameters.F=[27, {hopf + 0.01}, {hopf + 0.04}]"
    with run(command, "fig6", forces, "parameters.gamma1=1") as file:
        status, y = file["status"][:].ravel(), file["tip_y_max"][:].ravel()
        assert status.tolist() == [1, 0, 0]
        assert np.log(y[2] / y[1]) / np.log(4) == pytest.approx(0.5, abs=1e-3)


@pytest.mark.long
def test_what_a_restabilised_rod_does_depends_on_where_it_comes_from(command):
    """Beyond the paper, whose Discussion excludes oscillations outside the linear window of flutter."""
    hopf, period, y = stated("hysteresis_up")[:3]
    for direction, status in (("up", [0, 0]), ("down", [0, 1])):
        with run(command, f"hysteresis_{direction}", "parameters.F=[150, 170]") as file:
            assert 150 < hopf < 170
            assert file["status"][:].ravel().tolist() == status
            if direction == "up":
                assert file["period"][:].ravel()[1] == pytest.approx(period, rel=1e-7)
                assert file["tip_y_max"][:].ravel()[1] == pytest.approx(y, rel=1e-7)
                assert file["linear_growth_rate"][:].ravel()[1] < 0


@pytest.mark.long
def test_filament(command):
    threshold, _, frequency, period, height = stated("filament")
    assert threshold == pytest.approx(FILAMENT, rel=1e-14)
    forces = f"parameters.F=[{threshold * (1 - 1e-4)}, {threshold * (1 + 1e-4)}, 40]"
    with run(command, "filament", forces, "parameters.gamma1=1", "accuracy=1e-6") as file:
        here = (slice(None), 0, 0, 0, 0)
        assert file["status"][here].tolist() == [1, 0, 0]
        assert file["frequency"][here][1] == pytest.approx(frequency, rel=1e-4)
        assert file["period"][here][2] == pytest.approx(period, rel=1e-8)
        assert file["tip_y_max"][here][2] == pytest.approx(height, rel=1e-6)
        assert file["least_stretch"][here][1:].tolist() == [1, 1]


@pytest.mark.long
def test_map_of_beating(command):
    period, height, hopf = stated("beating_map")[-3:]
    with run(command, "beating_map", "parameters.F=[27, 49.5, 50]", "parameters.k2=[100, 110]") as file:
        here = (slice(None), 0, 0, 0, 0)
        assert 27 < hopf < 49.5
        assert file["status"][here].tolist() == [1, 0, 0]
        assert file["period"][here][2] == pytest.approx(period, rel=1e-4)
        assert file["tip_y_max"][here][2] == pytest.approx(height, rel=1e-4)


def test_krylov_schur_alone_counts_what_d_counts(command):
    below, above = stated("krylov_schur")
    forces = [F * (1 + side) for F in (below, above) for side in (-1e-6, 1e-6)]
    with run(command, "krylov_schur", f"parameters.F={forces}") as file:
        assert file["unstable_count"][:, 0, 0, 0].tolist() == [0, 2, 2, 0]
        assert not file["certified"][...].any()
        assert (file["elements"][...] > 0).all()


@pytest.mark.long
def test_integration_alone_gives_the_cycle_that_collocation_gives(command):
    period, height = stated("integration")
    with run(command, "integration", "parameters.F=[30, 40]") as file:
        assert file["period"][1].item() == pytest.approx(period, rel=file["period_error"][1].item())
        assert file["tip_y_max"][1].item() == pytest.approx(height, rel=file["amplitude_error"][1].item())
        assert file["period_error"][1].item() < 1e-6
        assert isnan(file["multiplier"][1].item())


def test_taper(command):
    """A cone of half the radius, and the uniform arm beside it."""
    cone, frequency, uniform = stated("taper")[1:2] + stated("taper")[3:]
    with run(command, "taper", "parameters.taper=[0.5, 1]") as file:
        assert file["F_hopf"][...].ravel() == pytest.approx([cone, uniform], rel=1e-11)
        assert file["hopf_frequency"][...].ravel()[0] == pytest.approx(frequency, rel=1e-11)
        assert file["certified"][...].all()


def test_segments(command):
    hopf = stated("segments")[-1]
    with run(command, "segments", f"parameters.F=[{hopf * (1 - 1e-8)}, {hopf * (1 + 1e-8)}]") as file:
        assert file["unstable_count"][...].ravel().tolist() == [0, 2]
        assert file["certified"][...].all()


@pytest.mark.long
def test_cone_cycles(command):
    """Checked against strains marched in time, and dense eigenvalues of elements in displacements."""
    numbers = stated("cone_cycles")
    with run(command, "cone_cycles", "parameters.F=[16, 20]", "parameters.taper=[0.5, 1]") as file:
        period, y = (file[name][1, 0, 0, 0, 0, 0] for name in ("period", "tip_y_max"))
        assert [period, y] == pytest.approx(numbers[1:3], rel=2e-7)
        first = file["hopf_F"][...][file["hopf_taper"][...] == 0.5].min()
        assert first == pytest.approx(numbers[3], rel=1e-11)


@pytest.mark.long
def test_rubber_branch(command):
    """Its branch is born, and the straight rod stable again, where the comment says; a cycle alone agrees."""
    born, stable_again, period, y = stated("rubber_branch")[:4]
    with run(command, "rubber_branch", "branch.stop=235", "accuracy=1e-3") as file:
        kinds, at = file["special_kind"][0, 0, 0, 0], file["special_at"][0, 0, 0, 0]
        places = sorted(at[kinds == 1])
        assert places == pytest.approx([born, stable_again], rel=1e-11)
        F, outside = file["branch_F"][0, 0, 0, 0], file["unstable_multipliers"][0, 0, 0, 0]
        assert ((stable_again < F) & (outside == 0)).any()
    beating = rs.Rod(F=230, k1=400, k2=1e4, gamma3=1e-4, law="neo_hookean", section="swelling")
    cycle = beating.cycle(accuracy=1e-5, amplitude=0.4)
    assert [cycle.period, cycle.tip_y_max] == pytest.approx([period, y], rel=1e-5)


@pytest.mark.long
def test_rubber(command):
    """The window of the swelling section, and of a fixed section, which never closes."""
    lower, upper, fixed = stated("rubber")
    with run(command, "rubber", "parameters.k1=[300, 500]") as file:
        assert file["F_hopf"][...].ravel() == pytest.approx([np.nan, lower], rel=1e-11, nan_ok=True)
        assert file["F_restabilization"][...].ravel() == pytest.approx(
            [np.nan, upper], rel=1e-11, nan_ok=True
        )
    (command.directory / "rubber.h5").unlink()
    with run(command, "rubber", "material.section=fixed", "parameters.k1=[100, 200]") as file:
        assert file["F_hopf"][1, 0, 0] == pytest.approx(fixed, rel=1e-11)
        assert np.isnan(file["F_restabilization"][...]).all()


def test_cast_arm(command):
    """The threshold of elements in displacements, and its pressure and frequency at 100 kPa."""
    force, pressure, frequency = stated("cast_arm")[-3:]
    with run(command, "cast_arm", "parameters.arm.young=[80 kPa, 100 kPa]") as file:
        assert file["F_hopf"][...].ravel()[1] == pytest.approx(force, rel=4e-9)
        assert file["pressure_hopf"][...].ravel()[1] == pytest.approx(1e3 * pressure, rel=4e-9)
        assert file["frequency_hopf_hz"][...].ravel()[1] == pytest.approx(frequency, rel=4e-9)
        assert file["young"].attrs["units"] == "Pa"
        assert not file["status"][...].any()


@pytest.mark.long
def test_slender(command):
    rubber, linear = stated("slender")
    length = "parameters.arm.length=[12 cm, 14 cm]"
    uniform = "parameters.arm.tip_radius=6 mm"
    with run(command, "slender", length, uniform) as file:
        assert file["F_hopf"][...].ravel()[0] == pytest.approx(rubber, rel=1e-11)
    (command.directory / "slender.h5").unlink()
    of_linear = ("parameters.arm.section=fixed", "parameters.arm.law=linear", uniform)
    with run(command, "slender", length, *of_linear) as file:
        assert file["F_hopf"][...].ravel()[0] == pytest.approx(linear, rel=1e-11)
