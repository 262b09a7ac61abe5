"""The task criticality: coefficients of Hopf points, their errors, and what a user sees of them."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from mixed_motion import mixed_form
from scipy.interpolate import BarycentricInterpolator
from second_normal_form import coefficients
from shown import shown
from surveyed import few
from test_paper import run, stated

import rodsweep as rs
from rodsweep.determinant.parameter_path import ParameterPath
from rodsweep.discretization.elements.mesh import uniform_mesh
from rodsweep.discretization.stress.form import StressForm
from rodsweep.model.rod import Rod
from rodsweep.results.file.view import read_view
from rodsweep.solve.changes.thresholds import ThresholdsRequest
from rodsweep.solve.changes.thresholds_along_path import find_imaginary_axis_crossings, find_thresholds
from rodsweep.solve.cycle.accuracy.refinement import refined_cycle
from rodsweep.solve.cycle.hopf_start import orbit_by_normal_form
from rodsweep.solve.hopf import criticality
from rodsweep.solve.hopf.criticality import solve_criticality
from rodsweep.solve.hopf.normal_form import normal_form, normal_form_by_mesh_rule
from rodsweep.solve.hopf.status import CriticalityStatus
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.unsolvable import Unsolvable
from rodsweep.tasks.criticality import criticality_values
from rodsweep.tasks.running.job import job_of_file

INF = math.inf
STRETCHABLE = Rod(F=0.0, k1=200.0, k2=1e4, gamma3=1e-4)
FILAMENT = Rod(F=0.0, k1=INF, k2=INF, gamma3=0.0)
SUBCRITICAL = Rod(F=0.0, k1=108.0, k2=1e4, gamma3=0.1, gamma1=0.5)
"""Already the first Hopf point is subcritical."""


def solved(rod, accuracy=1e-10, F_max=160.0, most=16):
    return solve_criticality(rod, ThresholdsRequest(F_max, accuracy, True, most))


def hopf_points(rod, **asked):
    """The rod at each of its Hopf points, the crossing there, and the coefficients."""
    found = solved(rod, **asked)
    assert found.status == CriticalityStatus.ok
    for hopf, known in zip(found.search_result.thresholds, found.coefficients, strict=True):
        yield Rod(F=hopf.value, k1=rod.k1, k2=rod.k2, gamma3=rod.gamma3), hopf, known


# --- the coefficients -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rod", "signs"),
    [
        (Rod(F=0.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=0.5), [-1, -1]),
        (STRETCHABLE, [-1, 1]),
        (SUBCRITICAL, [1, 1]),
        (Rod(F=0.0, k1=110.0, k2=300.0, gamma3=0.1), [-1]),
        (Rod(F=0.0, k1=500.0, k2=20.0, gamma3=1e-2, gamma1=0.8), [-1, -1]),
    ],
)
def test_coefficients_are_those_of_another_code(rod, signs):
    """In shapes at Chebyshev's nodes, with third derivatives: its rounding leaves some nine digits."""
    for (at, hopf, known), sign in zip(hopf_points(rod), signs, strict=False):
        n = (at.F, rod.k1, rod.k2, rod.gamma3, rod.gamma1)
        c, slope = coefficients(n, 1j * hopf.frequency, 34)
        assert known.landau == pytest.approx(c, rel=2e-8)
        assert known.growth_slope == pytest.approx(slope, rel=1e-7)
        assert known.criticality == sign


def cycle_near(at, hopf, known, gamma1, part):
    """(largest tip y squared, frequency less that of the Hopf point), both over F - F_H, of a cycle."""
    F = at.F * (1 + part * math.copysign(1, known.amplitude_coefficient))
    normal = normal_form_by_mesh_rule(at.with_values(gamma1=gamma1), 1j * hopf.frequency, 1e-6)
    form = StressForm(
        (replace(at, F=F)).with_values(gamma1=gamma1), uniform_mesh(1, normal.mixed_form.mesh.node_count)
    )
    measures = refined_cycle(orbit_by_normal_form(normal, form), 1e-11, NewtonWorkspace()).measures
    return np.array([measures.tip_y_max**2, measures.frequency - hopf.frequency]) / (F - at.F)


@pytest.mark.long
@pytest.mark.parametrize(
    "rod",
    [
        STRETCHABLE,
        FILAMENT,
        Rod(F=0.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=0.5),
        Rod(F=0.0, k1=150.0, k2=INF, gamma3=5e-3, gamma1=0.6),
        Rod(F=0.0, k1=1e6, k2=50.0, gamma3=1.0, gamma1=0.7),
        Rod(F=0.0, k1=1e3, k2=INF, gamma3=0.0, gamma1=0.5),
        Rod(F=0.0, k1=110.0, k2=300.0, gamma3=0.1),
        Rod(F=0.0, k1=INF, k2=1e4, gamma3=1e-6, gamma1=0.5),
        Rod(F=0.0, k1=240.0, k2=1e3, gamma3=1e-3, gamma1=0.5),
        Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-2),
    ],
)
def test_cycles_at_the_hopf_point_are_those_of_the_coefficients(rod):
    """Stable cycles and unstable ones, at F_H (1 +- 1e-4) and (1 +- 1e-5), extrapolated to F_H."""
    for at, hopf, known in list(hopf_points(rod))[:2]:
        far, near = (cycle_near(at, hopf, known, rod.gamma1, part) for part in (1e-4, 1e-5))
        squared, slope = (10 * near - far) / 9
        assert abs(squared * at.F) ** 0.5 == pytest.approx(abs(known.amplitude_coefficient), rel=1e-8)
        assert slope == pytest.approx(known.frequency_slope, rel=1e-8)


FORCES = np.array([1e-4, 5e-5, 2e-5, 1e-5])
"""Relative distances from the Hopf point, where a fold is so near that two are not enough."""


@pytest.mark.parametrize("rod", [SUBCRITICAL, Rod(F=0.0, k1=50.0, k2=100.0, gamma3=1.0)])
def test_cycles_of_rods_whose_fold_is_near_are_those_of_the_coefficients_too(rod):
    """The force and the frequency are smooth in y squared through the fold, hence extrapolated in that."""
    at, hopf, known = next(iter(hopf_points(rod)))
    assert known.criticality == 1
    cycles = np.array([cycle_near(at, hopf, known, rod.gamma1, part) for part in FORCES])
    squared = np.abs(cycles[:, 0]) * at.F * FORCES
    force = float(BarycentricInterpolator(squared, 1 / cycles[:, 0])(0))
    frequency = float(BarycentricInterpolator(squared, cycles[:, 1] / cycles[:, 0])(0))
    assert abs(at.F / force) ** 0.5 == pytest.approx(abs(known.amplitude_coefficient), rel=1e-8)
    assert frequency / force == pytest.approx(known.frequency_slope, rel=1e-8)


def test_both_signs_are_among_the_rods_above():
    signs = [known.criticality for _, _, known in hopf_points(STRETCHABLE)]
    assert signs == [-1, 1]


def random_rods(count):
    rng = np.random.default_rng(16)
    for _ in range(count):
        k1, k2 = (INF if rng.random() < 0.15 else 10 ** rng.uniform(low, 8) for low in (1.5, 1.2))
        gamma3 = 0.0 if rng.random() < 0.2 else 10 ** rng.uniform(-7, 0)
        yield Rod(F=0.0, k1=k1, k2=k2, gamma3=gamma3, gamma1=rng.uniform(0.5, 1))


@pytest.mark.kernel
@pytest.mark.parametrize("accuracy", [1e-5, 1e-10])
def test_errors_are_below_their_estimates(accuracy):
    """Against meshes that are finer by a third; the estimates are below what was asked for."""
    seen = 0
    for rod in random_rods(30):
        for at, hopf, known in hopf_points(rod, accuracy=accuracy, F_max=100.0):
            finer = max(known.order + 8, known.order * 4 // 3) | 1
            exact = normal_form(
                mixed_form(at.with_values(gamma1=rod.gamma1), known.elements, finer), 1j * hopf.frequency
            )
            assert abs(known.landau / exact.landau - 1) <= known.landau_error <= accuracy
            assert (
                abs(known.growth_slope / exact.eigenvalue_slope - 1) <= known.growth_slope_error <= accuracy
            )
            assert (
                abs(known.amplitude_coefficient / exact.amplitude_coefficient - 1)
                <= known.amplitude_coefficient_error
            )
            assert abs(known.frequency_slope / exact.frequency_slope - 1) <= known.frequency_slope_error
            seen += 1
    assert seen > 25


@pytest.mark.kernel
@pytest.mark.parametrize("k1, k2", [(260.3967, 7.1442), (136.5294, 20.2691), (168.2091, 28.0025)])
def test_errors_are_below_their_estimates_where_rounding_is_largest(k1, k2):
    """Of rods soft in stretch and shear, up to where they are nearly crushed."""
    rod = Rod(F=0.0, k1=k1, k2=k2, gamma3=0.0, gamma1=0.7)
    found = solved(rod, accuracy=1e-12, F_max=300.0, most=40)
    for hopf, known in zip(found.search_result.thresholds, found.coefficients, strict=True):
        at = Rod(F=hopf.value, k1=rod.k1, k2=rod.k2, gamma3=rod.gamma3)
        finer = mixed_form(at.with_values(gamma1=rod.gamma1), known.elements, known.order + 8)
        off = abs(normal_form(finer, 1j * hopf.frequency).landau / known.landau - 1)
        assert off <= known.landau_error <= 5e-11
    assert hopf.value > 0.8 * k1


@pytest.mark.kernel
@pytest.mark.parametrize(
    "u, k2, exact",
    [
        # Legendre polynomials of orders 24 and 28 for y', theta' and s, four to five elements an interval.
        ((0, 0.38, 0.38, 0.84, 1), (1, 1, 0.68, 4.5, 0.32), -165.700065505 - 77.479794704j),
        ((0, 0.5, 1), (0.5, 4.5, 0.3), -237.180773245 - 129.667887816j),
    ],
)
def test_errors_are_below_their_estimates_where_the_material_varies_quickly(u, k2, exact):
    """Halved elements of a lower order were no better than their predecessor, which hid errors of 6e-10 of
    the first arm, ten times those stated; the second mesh of the second arm missed the eigenvalue."""
    arm = rs.Rod(k1=3734, k2=4.26, gamma3=1e-5, gamma1=3, profile={"u": u, "k2": k2})
    born = arm.criticality(F_max=16, accuracy=1e-10)
    error = abs(complex(born.landau_real[0], born.landau_imag[0]) / exact - 1)
    assert error <= born.landau_error[0] + 5e-12 <= 1e-10


def test_errors_tell_how_near_two_hopf_points_are_to_meeting():
    """The real part of dw/dF passes through 0 where a window closes, and with it the digits of a."""
    errors = [
        max(
            known.amplitude_coefficient_error
            for _, _, known in hopf_points(Rod(F=0.0, k1=k1, k2=1e4, gamma3=1e-4))
        )
        for k1 in (200.0, 147.93, 147.9221)
    ]
    assert errors[0] < 1e-11
    assert errors[1] > 10 * errors[0]
    assert errors[2] > 5 * errors[1]


@pytest.mark.parametrize("k1", [150.0, 147.93, 147.9221])
def test_error_of_the_force_is_in_that_of_the_coefficient(k1):
    """What c does within the error of F_H, by a difference over a distance that rounding does not feel."""
    rod = Rod(F=0.0, k1=k1, k2=1e4, gamma3=1e-4)
    for at, hopf, known in hopf_points(rod):
        step = 1e-6 * at.F
        beside = mixed_form(
            (replace(at, F=at.F + step)).with_values(gamma1=rod.gamma1), known.elements, known.order
        )
        moved = normal_form(beside, 1j * hopf.frequency + known.growth_slope * step).landau
        by_force = abs(moved / known.landau - 1) * hopf.error / step
        assert known.landau_error >= by_force
        if k1 < 147.925:
            assert by_force > 3e-12  # more than rounding leaves


def test_hopf_points_are_those_of_all_transitions():
    for rod in (
        STRETCHABLE,
        Rod(F=0.0, k1=1e4, k2=1e2, gamma3=1e-2),
        FILAMENT,
        Rod(F=0.0, k1=60.0, k2=10.0, gamma3=0.5),
    ):
        end = min(200.0, rod.k1 * (1 - 1e-6))
        path = ParameterPath(Rod(F=0.0, k1=rod.k1, k2=rod.k2, gamma3=rod.gamma3), "F")
        every, pairs = find_thresholds(path, 0.0, end), find_imaginary_axis_crossings(path, 0.0, end)
        crossings = [c for c in every.thresholds if not c.kind.switches_real_and_complex]
        assert [(c.value, c.kind, c.unstable_after) for c in pairs.thresholds] == [
            (c.value, c.kind, c.unstable_after) for c in crossings
        ]
        assert pairs.is_proved
        assert pairs.unstable_at_end == every.unstable_at_end


# --- statuses ---------------------------------------------------------------------------------------------


def test_sign_within_its_error_is_undecided():
    """Next to a generalised Hopf point: Re c is 2e-6 of |c|, and as large by the other code."""
    rod = Rod(F=0.0, k1=150.0, k2=1e4, gamma3=1e-6)
    rough, fine = solved(rod, accuracy=1e-3, F_max=100.0), solved(rod, F_max=100.0)
    assert (rough.status, fine.status) == (CriticalityStatus.sign_undecided, CriticalityStatus.ok)
    assert [known.criticality for known in rough.coefficients] == [-1, 0]
    assert [known.criticality for known in fine.coefficients] == [-1, 1]
    hopf, known = fine.search_result.thresholds[1], fine.coefficients[1]
    c, _ = coefficients((hopf.value, rod.k1, rod.k2, rod.gamma3, rod.gamma1), 1j * hopf.frequency, 34)
    assert known.landau.real == pytest.approx(c.real, rel=1e-3)
    assert known.landau.real < 3e-6 * abs(c)
    assert known.amplitude_coefficient_error > 1e5 * known.landau_error


def test_hopf_point_that_fails_does_not_lose_the_others(monkeypatch):
    made = criticality.hopf_coefficients

    def first_fails(at, hopf, accuracy):
        if at.F < 100:
            raise Unsolvable("no mesh is fine enough")
        return made(at, hopf, accuracy)

    monkeypatch.setattr(criticality, "hopf_coefficients", first_fails)
    found = solved(STRETCHABLE)
    assert found.status == CriticalityStatus.coefficients_failed
    assert found.message == "Hopf point at F = 49.7580049162: no mesh is fine enough"
    assert [known.are_known for known in found.coefficients] == [False, True]
    assert math.isnan(found.coefficients[0].criticality)
    assert found.coefficients[1].criticality == 1


def test_search_that_fails_is_a_status(monkeypatch):
    def lost(*_, **__):
        raise Unsolvable("no a-priori bound on the eigenvalues applies to this rod")

    monkeypatch.setattr(criticality, "_hopf_points", lost)
    found = solved(STRETCHABLE)
    assert (found.status, found.message) == (
        CriticalityStatus.failed,
        "no a-priori bound on the eigenvalues applies to this rod",
    )


def test_more_than_rounding_leaves_is_not_promised():
    found = solved(Rod(F=0.0, k1=1e4, k2=20.0, gamma3=0.0), accuracy=1e-13, F_max=60.0)
    assert found.status == CriticalityStatus.accuracy_not_reached
    assert all(1e-13 < known.landau_error < 1e-11 for known in found.coefficients)


def test_full_list_also_names_its_inaccurate_coefficients():
    found = solved(Rod(F=0.0, k1=1e4, k2=20.0, gamma3=0.0), accuracy=1e-13, F_max=120.0, most=1)
    assert found.status == CriticalityStatus.list_full
    assert found.coefficients[0].landau_error > 1e-13
    force = f"{found.search_result.thresholds[0].value:.9g}"
    assert "accuracy is missed" in found.message and f"coefficients at F = {force}" in found.message


def test_list_that_is_full_says_so():
    found = solved(STRETCHABLE, most=1)
    assert found.status == CriticalityStatus.list_full
    assert len(found.coefficients) == 1
    assert len(found.search_result.thresholds) == 2


# --- as a user sees it ------------------------------------------------------------------------------------

CONFIG = (
    "task: criticality\nparameters: {{k1: {k1}, k2: 1.0e4, gamma3: 1.0e-4}}\ncriticality: {{F_max: 180}}\n"
)


def test_numbers_of_one_rod_come_out_of_show(command):
    told = shown(command, CONFIG.format(k1=200))
    assert re.search(r"F, k3/L\^2 +49\.758004916\d+ +\de-1\d +155\.6001592987\d+ +\de-1\d", told)
    above = "the straight rod has 2 unstable modes beyond it"
    assert f"hopf at F = 49.758: supercritical, stable cycles at larger F; {above}" in told
    none = "the straight rod has 0 unstable modes beyond it"
    assert f"restabilization at F = 155.6: subcritical, unstable cycles at larger F; {none}" in told
    assert re.search(r"frequency, rad/tau2 +334\.32146573", told)
    assert re.search(r"Re c, 1/\(tau2 L\^2\) +-971\.91953336\d* +\de-\d+", told)
    assert re.search(r"Im c, 1/\(tau2 L\^2\) +-387\.9588634", told)
    assert re.search(r"a, L +0\.5811406522\d* +\de-1\d", told)
    assert re.search(r"^k1 +200 +k3/L\^2", told, re.MULTILINE)  # a single value is printed once
    assert "is proved complete for 1 of 1 rod" in told


def test_show_counts_the_signs_of_many_rods_and_names_the_subcritical(command):
    told = shown(command, CONFIG.format(k1="[100, 150, 200, 1.0e4]"))
    assert "Hopf points at 3 of 4 rods" in told
    assert "first Hopf point of each rod: 3 supercritical;" in told
    assert "all Hopf points: 4 supercritical, 2 subcritical;" in told
    rod = "k1 = 150, k2 = 10000, gamma3 = 0.0001, gamma1 = 1"
    assert f"subcritical Hopf points, with the amplitude coefficient a, for {rod}: F = 85.5693 (" in told


def test_file_has_a_value_where_there_is_a_hopf_point_and_none_elsewhere(command):
    shown(command, CONFIG.format(k1="[100, 200]"))
    v = read_view(command.directory / "c.h5").variables
    assert v["crossing_count"].ravel().tolist() == [0, 2]
    assert v["criticality"][1, 0, 0, 0, :2].tolist() == [-1, 1]
    assert v["crossing_frequency_error"][1, 0, 0, 0, 0] < 1e-9
    for name in ("criticality", "landau_real", "landau_error", "amplitude_coefficient", "frequency_slope"):
        assert np.isnan(v[name][0]).all()
        assert np.isnan(v[name][1, 0, 0, 0, 2:]).all()


@pytest.mark.parametrize("k1", few(["[150, 200, .inf]", "[120, 150, 200, 400]"], 1))
def test_figure_over_one_parameter(command, k1):
    shown(command, CONFIG.format(k1=k1))
    drawn = command.drawn("plot", "c.h5", "-o", "c.svg")
    assert drawn.returncode == 0
    assert "the normal forms of Hopf points along k1" in drawn.stdout
    assert (command.directory / "c.svg").stat().st_size > 5000


@pytest.mark.long
def test_figure_over_two_parameters(command):
    config = CONFIG.format(k1="[100, 108, 200]").replace(
        "gamma3: 1.0e-4", "gamma3: [0.001, 0.1], gamma1: 0.5"
    )
    shown(command, config)
    drawn = command.drawn("plot", "c.h5", "-o", "c.pdf")
    assert drawn.returncode == 0
    assert "the normal form of the first Hopf point over k1 and gamma3" in drawn.stdout


def test_figure_of_rods_without_hopf_points_is_refused(command):
    shown(command, CONFIG.format(k1="[50, 60]"))
    refused = command.drawn("plot", "c.h5", "-o", "c.png")
    assert refused.returncode == 2
    assert "c.h5 holds no Hopf point with a normal form that could be drawn" in refused.stderr


@pytest.mark.long
def test_config_shows_the_numbers_of_its_head(command):
    """Which are those of the other code, too."""
    axes = "parameters.k1=[100, 200]", "parameters.gamma3=[1.0e-4, 0.1]"
    with run(command, "criticality", *axes) as file:
        F_hopf, a, F_again, a_again, _, F_subcritical, a_subcritical = stated("criticality")
        F, found, side = (
            file[name][:, 0, :, 0] for name in ("crossing_F", "amplitude_coefficient", "criticality")
        )
        assert F[1, 0, :2] == pytest.approx([F_hopf, F_again], rel=1e-12)
        assert found[1, 0, :2] == pytest.approx([a, a_again], rel=1e-8)
        assert side[1, 0, :2].tolist() == [-1, 1]
        assert F[0, 1, 0] == pytest.approx(F_subcritical, rel=1e-10)
        assert found[0, 1, 0] == pytest.approx(a_subcritical, rel=1e-8)
        assert side[0, 1, 0] == 1
        assert np.isnan(F[0, 0]).all()
        c, slope = coefficients(
            (F[0, 1, 0], 100.0, 1e4, 0.1, 1.0), 1j * file["crossing_frequency"][0, 0, 1, 0, 0], 34
        )
        assert abs(F[0, 1, 0] * slope.real / c.real) ** 0.5 == pytest.approx(-a_subcritical, rel=2e-8)


def test_record_has_all_variables_of_the_layout_and_no_other(tmp_path):
    config = tmp_path / "c.yaml"
    config.write_text(CONFIG.format(k1=200))
    names = {variable.name for variable in job_of_file(config, ()).layout.variables}
    assert set(criticality_values(solved(STRETCHABLE), 16)) == names


def test_rod_answers_in_python():
    answer = rs.Rod(k1=200, k2=1e4, gamma3=1e-4).criticality(F_max=180, accuracy=1e-8)
    assert answer.status == "ok"
    assert list(answer.criticality[:2]) == ["supercritical", "subcritical"]
    assert answer.amplitude_coefficient[0] == pytest.approx(0.58114065227, rel=1e-8)


def test_thresholds_do_not_feel_the_axial_drag_and_coefficients_do():
    data = rs.sweep("criticality", k1=[200.0], k2=1e4, gamma3=1e-4, gamma1=[0.5, 1.0])
    F, a = (data[name].values[0, 0, 0, :, 0] for name in ("crossing_F", "amplitude_coefficient"))
    assert F[0] == F[1]
    assert a[0] > 1.1 * a[1]
