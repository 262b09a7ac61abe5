"""The normal form of Hopf points: its modes, its coefficients, and cycles that know nothing of it."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import mixed_motion as mixed
import numpy as np
import pytest
from mixed_motion import mixed_form, whole_A
from rods import rod_of

from rodsweep.determinant.roots.newton import eigenvalue_with_slope_and_error
from rodsweep.determinant.value import root_error_w_scale_and_wave_number
from rodsweep.model.rod import Coefficients, Rod
from rodsweep.solve.cycle.limit_cycle import CycleRequest, CycleStatus, solve_cycle
from rodsweep.solve.hopf.normal_form import (
    elements_for_landau_coefficient,
    elements_with_third_more_unknowns,
    normal_form,
    normal_form_by_mesh_rule,
    normal_form_on,
)
from rodsweep.solve.unsolvable import Unsolvable

INF = np.inf
# Hopf points to 25 digits: tests/reference/thresholds.json.
STIFF = Rod(F=37.6559805452710669, k1=1e4, k2=1e4, gamma3=1e-4), 191.209209231243243j
SOFT = Rod(F=27.4271941267592812, k1=1e4, k2=1e2, gamma3=1e-2), 113.547607864984988j
STRETCHABLE = Rod(F=49.758004916191496, k1=200.0, k2=1e4, gamma3=1e-4), 334.321465737703369j
RESTABILIZED = Rod(F=155.60015929879066, k1=200.0, k2=1e4, gamma3=1e-4), 3367.2809575968313j
FILAMENT = Rod(F=37.6954308403185826, k1=INF, k2=INF, gamma3=0.0), 191.258635765253103j
CLOSING = Rod(F=75.97818719759563, k1=147.93, k2=1e4, gamma3=1e-4), 782.8760757884106j
EACH = pytest.mark.parametrize("rod, w", [STIFF, SOFT, STRETCHABLE, RESTABILIZED, FILAMENT, CLOSING])
ORDER = 18


@cache
def form_of(rod, gamma1=1.0, elements=1, order=ORDER):
    return mixed_form(rod.with_values(gamma1=gamma1), elements, order)


@cache
def normal_of(rod, w, gamma1=1.0, elements=1, order=ORDER):
    return normal_form(form_of(rod, gamma1, elements, order), w)


def beyond(point, part):
    """The rod at a force that is larger by a part."""
    return replace(point[0], F=point[0].F * (1 + part))


# --- the modes --------------------------------------------------------------------------------------------


@EACH
def test_modes_are_those_of_the_eigenvalue(rod, w):
    form, normal = form_of(rod), normal_of(rod, w)
    assert normal.w == pytest.approx(w, rel=1e-11)
    pencil = whole_A(form) - normal.w * np.diag(form.M)
    for matrix, vector in ((pencil, normal.q), (pencil.conj().T, normal.p)):
        residual = np.abs(matrix @ vector)
        assert residual.max() <= 1e-13 * (np.abs(matrix) @ np.abs(vector)).max()
    assert np.vdot(normal.p, form.M * normal.q) == pytest.approx(1, rel=1e-13)


@EACH
def test_right_mode_deflects_the_tip_by_a_half(rod, w):
    form, q = form_of(rod), normal_of(rod, w).q
    assert form.tip_y_functional @ q == pytest.approx(0.5, rel=1e-14)
    assert -mixed.reaction(form, q)[1] / w == pytest.approx(0.5, rel=1e-9)
    v2 = form.stresses_and_velocities(q)[1][1]
    assert v2[-1] / w == pytest.approx(0.5, rel=1e-9)


@EACH
def test_slope_is_that_of_the_root_of_the_determinant(rod, w):
    direction = Coefficients(1.0, -rod.c1, 0.0, 0.0)
    root, slope, _ = eigenvalue_with_slope_and_error(w, rod.coefficients, direction)
    assert root == pytest.approx(w, rel=1e-13)
    assert normal_of(rod, w).eigenvalue_slope == pytest.approx(slope, rel=1e-9)


@EACH
def test_nearest_eigenvalue_is_found_from_a_rough_guess(rod, w):
    rough = normal_form(form_of(rod), w * (1 + 0.02 - 0.01j))
    assert rough.landau == pytest.approx(normal_of(rod, w).landau, rel=1e-9)


def test_no_normal_form_where_nothing_oscillates():
    with pytest.raises(Unsolvable, match="real: no mode oscillates there"):
        normal_form(form_of(Rod(F=5.0, k1=1e4, k2=1e4, gamma3=1e-4)), -17.8 + 0j)
    with np.errstate(invalid="ignore"), pytest.raises(Unsolvable, match="iteration finds no eigenvalue"):
        normal_form(form_of(STIFF[0]), complex(np.nan, 1.0))


# --- the coefficients -------------------------------------------------------------------------------------


@EACH
def test_second_order_fields_satisfy_their_equations(rod, w):
    form, normal = form_of(rod), normal_of(rod, w)
    q, M = normal.q, np.diag(form.M)
    for matrix, field, source in (
        (2j * normal.w.imag * M - whole_A(form), normal.h20, form.bilinear_map(q, q)),
        (-whole_A(form), normal.h11, form.bilinear_map(q, q.conj())),
    ):
        assert np.abs(matrix @ field - source).max() <= 1e-12 * (np.abs(matrix) @ np.abs(field)).max()
        assert np.all(form.reflection_signs * field == field)
    assert np.all(form.reflection_signs * q == -q)
    assert normal.h11.dtype == float


@pytest.mark.kernel
@EACH
def test_coefficient_converges_to_ten_digits_whatever_the_mesh(rod, w):
    exact = normal_of(rod, w, order=26)
    orders = {
        order: abs(normal_of(rod, w, order=order).landau / exact.landau - 1) for order in (10, 12, 14, 18)
    }
    assert orders[18] <= 1e-10
    assert orders[14] <= 1e-2 * orders[10]
    assert normal_of(rod, w, elements=3, order=13).landau == pytest.approx(exact.landau, rel=1e-10)


@pytest.mark.long
@pytest.mark.parametrize("accuracy", [1e-6, 1e-10])
def test_accuracy_asked_for_is_reached(accuracy):
    """At all Hopf points of the reference."""
    seen = 0
    for rod, w in hopf_points():
        normal = normal_form_by_mesh_rule(rod, w, accuracy)
        exact = normal_form_by_mesh_rule(rod, w, accuracy**1.5)
        assert exact.mixed_form.unknown_count > normal.mixed_form.unknown_count
        assert abs(normal.landau / exact.landau - 1) <= accuracy
        seen += 1
    assert seen > 50


def hopf_points():
    """(rod, w) of those of the reference in whose modes less than five waves are."""
    for row in json.loads((Path(__file__).parents[2] / "reference" / "thresholds.json").read_text()):
        for event in row["events"]:
            if event["kind"].startswith("hopf"):
                numbers = event["F"], row["k1"], row["k2"], row["gamma3"]
                rod, w = rod_of(*map(float, numbers)), 1j * float(event["frequency"])
                if root_error_w_scale_and_wave_number(w, rod.coefficients)[2] < 10 * np.pi:
                    yield rod, w


def test_what_is_no_eigenvalue_has_no_normal_form():
    said = "misses the eigenvalue w = 0.01\\+191.2j of the rod at F = 37.656; the nearest eigenvalue of"
    with pytest.raises(Unsolvable, match=said):
        normal_form_by_mesh_rule(STIFF[0], 0.01 + 191.2j, 1e-8)
    with pytest.raises(Unsolvable, match="needs [0-9]+ mesh nodes, more than"):
        normal_form_by_mesh_rule(STIFF[0], 1e12j, 1e-8)


def test_filament_is_the_limit_of_rods():
    """Linearly in c1, c2 and gamma3, which are of the same small size here."""
    exact = normal_of(*FILAMENT).landau
    off = []
    for small in (1e-7, 1e-8):
        rod = Rod(F=FILAMENT[0].F, k1=1 / small, k2=1 / small, gamma3=small)
        off.append(abs(normal_form(form_of(rod), FILAMENT[1]).landau / exact - 1))
    assert off[0] <= 1e-3
    assert off[1] == pytest.approx(off[0] / 10, rel=0.05)


def test_axial_drag_changes_the_cycles_and_not_the_linear_problem():
    one, other = (normal_of(*SOFT, gamma1) for gamma1 in (1.0, 0.5))
    assert other.eigenvalue_slope == pytest.approx(one.eigenvalue_slope, rel=1e-9)
    assert abs(other.amplitude_coefficient) > 1.2 * abs(one.amplitude_coefficient)


# --- cycles -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("rod, w", [STIFF, RESTABILIZED, FILAMENT])
def test_motion_solves_the_equations_to_second_order(rod, w):
    """What is left of w M dX/dphase = A X + B(X, X)/2 shrinks with the cube of the amplitude."""
    form, normal = form_of(rod), normal_of(rod, w)
    phases = 2 * np.pi * np.arange(9) / 9
    left = []
    for amplitude in (1e-3, 1e-4):
        X = normal.cycle_states(amplitude, phases)
        assert form.tip_y_functional @ X.T == pytest.approx(amplitude * np.cos(phases), abs=1e-12 * amplitude)
        left.append(np.abs(w.imag * form.M * (harmonic_derivative(9) @ X) - mixed.rate(form, X)).max())
    assert left[0] / left[1] == pytest.approx(1000, rel=0.01)


def harmonic_derivative(n):
    """By the phase, of a trigonometric polynomial at n equidistant phases, n odd."""
    shift = np.arange(n)[:, None] - np.arange(n)
    with np.errstate(divide="ignore"):
        D = 0.5 * (-1.0) ** shift / np.sin(np.pi * shift / n)
    np.fill_diagonal(D, 0)
    return D


def solved_cycle(form, X, frequency):
    """(first harmonic of the tip's y, frequency): Fourier collocation of the mixed form by Newton's method.

    X: a first guess at n equidistant phases, (n, unknowns), whose tip is at rest in the first.
    """
    n, unknowns = X.shape
    D, each = harmonic_derivative(n), np.arange(n)
    for _ in range(8):
        dX = D @ X
        J = np.zeros((n * unknowns + 1,) * 2)
        blocks = J[:-1, :-1].reshape(n, unknowns, n, unknowns)
        blocks[:, np.arange(unknowns), :, np.arange(unknowns)] = frequency * form.M[:, None, None] * D
        blocks[each, :, each, :] -= np.array([mixed.jacobian(form, x) for x in X])
        J[:-1, -1] = (form.M * dX).ravel()
        J[-1, :-1] = np.outer(D[0], form.tip_y_functional).ravel()
        residual = np.append(
            (frequency * form.M * dX - mixed.rate(form, X)).ravel(), dX[0] @ form.tip_y_functional
        )
        step = np.linalg.solve(J, -residual)
        X, frequency = X + step[:-1].reshape(n, unknowns), frequency + step[-1]
        tip = X @ form.tip_y_functional
        if np.abs(step[:-1].reshape(n, unknowns) @ form.tip_y_functional).max() <= 1e-8 * np.abs(tip).max():
            return 2 * abs(np.fft.fft(tip)[1]) / n, frequency
    raise AssertionError("no cycle")


def near_by(point, part, gamma1, order=14, phases=9):
    """(squared amplitude, frequency less that of the Hopf point), both over F - F_H, of a cycle near by."""
    normal, rod = normal_of(*point, gamma1, order=order), beyond(point, part)
    form, step = mixed_form(rod.with_values(gamma1=gamma1), 1, order), part * point[0].F
    squared, frequency = normal.squared_y_and_frequency(rod.F)
    start = normal.cycle_states(squared**0.5, 2 * np.pi * np.arange(phases) / phases)
    amplitude, frequency = solved_cycle(form, start, frequency)
    return np.array([amplitude**2, frequency - point[1].imag]) / step


# The filament and the nearly straight branch beyond restabilization too, which no motion in time reaches.
@pytest.mark.kernel
@pytest.mark.parametrize(
    "point, gamma1, side, accuracy",  # where the window closes, w bends in F over a hundredth of it
    [
        (STIFF, 1.0, 1, 1e-6),
        (SOFT, 0.5, 1, 1e-6),
        (FILAMENT, 1.0, 1, 1e-6),
        (RESTABILIZED, 1.0, 1, 1e-6),
        (CLOSING, 1.0, -1, 3e-5),
    ],
)
def test_cycles_by_fourier_collocation_are_born_as_the_normal_form_says(point, gamma1, side, accuracy):
    part = side * 2e-4
    near, far = near_by(point, part / 2, gamma1), near_by(point, part, gamma1)
    squared, slope = 2 * near - far  # at the Hopf point, but for the square of the part
    normal = normal_of(*point, gamma1)
    assert np.sign(normal.amplitude_coefficient) == side
    assert squared * point[0].F * side == pytest.approx(normal.amplitude_coefficient**2, rel=accuracy)
    assert slope == pytest.approx(normal.frequency_slope, rel=accuracy)
    assert normal.is_supercritical == (side * normal.eigenvalue_slope.real > 0)


def test_cycle_of_a_neighbouring_eigenvalue_is_the_same_in_the_limit():
    """The normal form at a force beyond the Hopf point, of an eigenvalue that grows."""
    off = []
    for part in (4e-3, 2e-3):
        rod = beyond(SOFT, part)
        squared, frequency = normal_form(form_of(rod), SOFT[1]).squared_y_and_frequency(rod.F)
        exact = near_by(SOFT, part, 1.0) * (part * SOFT[0].F) + [0, SOFT[1].imag]
        off.append(np.abs([squared, frequency] / exact - 1))
    assert off[1][0] <= 0.01
    assert off[0][0] / off[1][0] == pytest.approx(2, rel=0.1)
    assert off[0][1] / off[1][1] == pytest.approx(4, rel=0.1)


def test_cycles_that_a_motion_in_time_reaches_are_born_as_the_normal_form_says():
    """By PETSc TS, in strains instead of stresses."""
    found = []
    for part in (2e-3, 4e-3):
        rod = beyond(SOFT, part)
        y = normal_of(*SOFT).squared_y_and_frequency(rod.F)[0] ** 0.5
        point = Rod(F=rod.F, k1=rod.k1, k2=rod.k2, gamma3=rod.gamma3, gamma1=1.0)
        cycle = solve_cycle(point, CycleRequest(1e-8, y, 1, 0, 0, 0, 300))
        assert cycle.status == CycleStatus.cycle
        change = [cycle.measures.tip_y_max**2, cycle.measures.frequency - SOFT[1].imag]
        found.append(np.array(change) / (part * SOFT[0].F))
    squared, slope = 2 * found[0] - found[1]
    assert squared * SOFT[0].F == pytest.approx(normal_of(*SOFT).amplitude_coefficient ** 2, rel=1e-4)
    assert slope == pytest.approx(normal_of(*SOFT).frequency_slope, rel=1e-4)


def test_a_high_hopf_point_of_a_thin_cone_has_a_normal_form():
    """At most 400 nodes were allowed: 348 have an error of 1e-11 there, but only a finer mesh shows it."""
    cone = Rod(F=69.86250471383605, k1=5480.0, k2=326.0, gamma3=9.01e-3, taper=0.2)
    w = 2559.553405456654j
    meshes = [elements_for_landau_coefficient(cone, w, 1e-5)]
    for _ in range(4):
        meshes.append(elements_with_third_more_unknowns(meshes[-1]))
    coarse, fine = (normal_form_on(elements, cone, w, 1e-8) for elements in meshes[-2:])
    assert fine.mixed_form.mesh.node_count > 400
    assert abs(fine.landau - coarse.landau) < 1e-10 * abs(fine.landau)
