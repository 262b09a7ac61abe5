"""The tip from the start to the cycle: a real motion of the rod, whatever becomes of it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from known_cycles import make_view
from rods import rod_of
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from surveyed import survey_only

from rodsweep.discretization.explicit_system import ExplicitSystem
from rodsweep.errors import InputError
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.post.figures import draw
from rodsweep.post.figures.cycle.shapes_and_tip_motion import draw_shapes_and_tip_motion
from rodsweep.post.figures.cycle.transient import draw_transients
from rodsweep.post.figures.limit_cycle import chosen_figure_kind
from rodsweep.post.figures.request import FigureRequest
from rodsweep.solve.cycle.limit_cycle import CycleRequest, solve_cycle
from rodsweep.solve.cycle.transient.amplitude_equation import AMPLITUDE_EQUATION_SETTINGS
from rodsweep.solve.cycle.transient.motion_mesh import MOTION_MESH_SETTINGS, motion_mesh
from rodsweep.solve.cycle.transient.tip_trace import interpolated_between_steps
from rodsweep.solve.motion.leading_mode import leading_mode

SOFT = (1e4, 1e2, 1e-2, 1.0)
STRETCHABLE = (200.0, 1e4, 1e-4, 1.0)
COUNT = 1000
SWELLING = RodMaterial("neo_hookean", "swelling")


@cache
def followed(F, rod=SOFT, amplitude=0.01, count=COUNT):
    """A rod whose transient is stored, once for all tests."""
    return solve_cycle(rod_of(F, *rod), CycleRequest(1e-6, amplitude, 3, 0, 0, 0, 400, transient=count))


def test_transient_begins_at_the_start_and_ends_at_the_cycle_at_equal_times():
    c = followed(50.0)
    time, x, y, theta = c.transient_tip_path
    assert c.transient_tip_path.shape == (4, COUNT)
    assert np.diff(time) == pytest.approx(time[-1] / (COUNT - 1), rel=1e-9)
    assert (time[0], x[0], y[0]) == pytest.approx((0.0, 1 - 50 / 1e4, 0.01), abs=1e-3)
    last = time > time[-1] - c.measures.period
    ends = (x[last].min(), x[last].max(), y[last].max(), theta[last].max())
    m = c.measures
    assert ends == pytest.approx((m.tip_x_min, m.tip_x_max, m.tip_y_max, m.tip_theta_max), rel=2e-3)


def test_transient_is_the_motion_that_another_integrator_finds():
    """SciPy's LSODA on the same compiled equations, over the first two periods."""
    c = followed(60.0, STRETCHABLE, 0.1)
    time, *tip = c.transient_tip_path[:, c.transient_tip_path[0] < 2 * c.measures.period]
    rod = rod_of(60.0, *STRETCHABLE[:3])
    system = ExplicitSystem(rod, motion_mesh(rod, MOTION_MESH_SETTINGS.accuracy_of_stored_motion))
    z = leading_mode(system).state(0.1)
    atol = 1e-7 * np.abs(z).max()
    found = solve_ivp(
        lambda _, z: system.state_derivative(z), (0.0, time[-1]), z, "LSODA", time, rtol=1e-7, atol=atol,
        jac=lambda _, z: system.jacobian(z),
    )  # fmt: skip
    assert np.abs(system.tip_coordinates(found.y.T) - tip).max() < 1e-5


@pytest.mark.parametrize(
    ("rod", "amplitude", "error", "exact"),
    [
        (
            Rod(F=25.0, k1=5000.0, k2=1000.0, gamma3=0.02, gamma1=0.5),
            0.1,
            2e-9,
            [(0.002, 0.0894876521902), (0.01, 0.0373906213632), (0.03, -0.0252403764343)],
        ),
        (
            Rod(F=35.0, k1=8000.0, k2=60.0, gamma3=0.004, gamma1=5.0),
            0.3,
            2e-9,
            [(0.001, 0.3116267376769), (0.005, 0.2934862282931), (0.02, -0.0829096383393)],
        ),
    ],
)
def test_a_stored_motion_has_the_relaxation_of_its_start(rod, amplitude, error, exact):
    """y of the tip by another code, Radau IIA of order 9 on Legendre polynomials, to 1e-11."""
    outcome = solve_cycle(rod, CycleRequest(1e-6, amplitude, 3, 0, 0, 0, 400, transient=2000))
    time, _, y, _ = outcome.transient_tip_path
    found = CubicSpline(time, y)(np.array([place for place, _ in exact]))
    assert np.abs(found - [value for _, value in exact]).max() < error


@pytest.mark.long
@pytest.mark.parametrize(
    ("rod", "amplitude", "error"),
    [
        (Rod(F=50.0, k1=1e4, k2=1e4, gamma3=1e-4), 0.01, 3e-8),
        (
            Rod(F=31.0, k1=2380.0, k2=1248.0, gamma3=2.82e-3, gamma1=0.5, taper=0.506, material=SWELLING),
            1e-3,
            1e-4,
        ),
        pytest.param(Rod(F=99.533, k1=102.76, k2=175.8, gamma3=0.744), 0.01, 0.02, marks=survey_only),
    ],
)
def test_a_stored_motion_is_that_on_a_finer_mesh(rod, amplitude, error, monkeypatch):
    """The motion grows by a factor of ten to a thousand, and the error of its rate shifts its later phase."""
    request = CycleRequest(1e-6, amplitude, 3, 0, 0, 0, 400, transient=2000)
    stored = solve_cycle(rod, request).transient_tip_path
    monkeypatch.setattr(
        "rodsweep.solve.cycle.transient.motion_mesh.MOTION_MESH_SETTINGS",
        replace(MOTION_MESH_SETTINGS, accuracy_of_stored_motion=1e-13),
    )
    finer = solve_cycle(rod, request).transient_tip_path
    time = stored[0][stored[0] <= finer[0][-1]]
    assert np.abs(stored[2][: len(time)] - CubicSpline(finer[0], finer[2])(time)).max() < error


def test_a_stored_decay_has_the_rate_of_the_leading_mode_between_time_steps_too():
    """Cubic interpolation between the growing steps of the decay is wrong by 1e-3."""
    c = followed(10.0)
    assert c.linear_frequency == 0
    time, _, y, _ = c.transient_tip_path
    late = (time > 2 / abs(c.linear_growth_rate)) & (np.abs(y) > 1e-8)
    assert late.sum() > 100
    amplitude = y[late] * np.exp(-c.linear_growth_rate * time[late])
    assert amplitude.max() < amplitude.min() * (1 + 5e-4)


@pytest.mark.parametrize(("count", "degree"), [(2, 3), (3, 5), (9, 5)])
def test_polynomials_are_interpolated_exactly(count, degree):
    rng = np.random.default_rng(count)
    steps = np.concatenate(([0.0], np.cumsum(rng.uniform(0.1, 1.0, count - 1))))
    motions = [np.polynomial.Polynomial(rng.normal(size=degree + 1)) for _ in range(3)]
    times = np.linspace(0.0, steps[-1], 50)
    values, rates = (
        np.array([f(steps) for f in motions]),
        np.array([f.deriv()(steps) for f in motions]),
    )
    expected = np.array([f(times) for f in motions])
    found = interpolated_between_steps(steps, values, rates, times)
    assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("tiny", [0, -1])
def test_a_tiny_first_or_last_step_spoils_no_interpolation_of_the_steps_beside_it(tiny):
    """Second derivatives from steps of 0.1 and 1e-7 would be wrong by 1, from rounding alone."""
    steps = np.linspace(0.0, 10.0, 101)
    steps = np.insert(steps, 1 if tiny == 0 else 100, steps[tiny] + (1e-7 if tiny == 0 else -1e-7))
    noise = 1e-11 * np.random.default_rng(0).normal(size=(2, 1, len(steps)))
    times = np.linspace(0.0, 10.0, 1001)
    found = interpolated_between_steps(
        steps, np.cos(steps)[None] + noise[0], -np.sin(steps)[None] + noise[1], times
    )
    assert np.abs(found - np.cos(times)).max() < 1e-6


def test_a_stored_motion_has_no_jumps():
    """It grows so slowly, by a few percent a period, that without being stored it would be scaled."""
    c = followed(27.6, amplitude=0.03, count=20_000)
    assert (
        c.linear_growth_rate * c.measures.period < AMPLITUDE_EQUATION_SETTINGS.max_slow_growth_per_return / 2
    )
    period = 2 * np.pi / c.linear_frequency
    time, _, y, _ = c.transient_tip_path
    inner = (np.abs(y[1:-1]) > np.abs(y[:-2])) & (np.abs(y[1:-1]) >= np.abs(y[2:]))
    peaks = np.abs(y[1:-1])[inner][1:]
    assert len(peaks) > 10
    growth = np.exp(c.linear_growth_rate * period / 2)
    assert ((peaks[1:] / peaks[:-1]) < growth * 1.01).all()
    assert np.abs(np.diff(y)).max() < 1.5 * y.max() * 2 * np.pi / period * time[1]
    assert peaks[-1] == pytest.approx(c.measures.tip_y_max, rel=0.03)


@pytest.mark.parametrize("F, rod, amplitude", [(50.0, SOFT, 0.01), (28.0, SOFT, 0.05), (10.0, SOFT, 0.01)])
def test_storing_the_transient_does_not_change_the_fate(F, rod, amplitude):
    with_it = followed(F, rod, amplitude)
    without = solve_cycle(rod_of(F, *rod), CycleRequest(1e-6, amplitude, 3, 0, 0, 0, 400))
    assert with_it.status == without.status
    assert with_it.measures.period == pytest.approx(without.measures.period, rel=1e-6, nan_ok=True)
    assert without.transient_tip_path is None


def test_a_rod_that_is_known_to_straighten_is_followed_all_the_same():
    quick = solve_cycle(rod_of(27.0, *SOFT), CycleRequest(1e-6, 0.01, 3, 0, 0, 0, 400))
    c = followed(27.0)
    assert quick.periods == 0 < c.periods
    assert (c.status, c.message) == (quick.status, quick.message)
    assert c.status.name == "straight"
    time, _, y, _ = c.transient_tip_path
    period = 2 * np.pi / c.linear_frequency
    later = np.interp(time[time + period <= time[-1]] + period, time, y)
    factor = np.linalg.norm(later) / np.linalg.norm(y[: len(later)])
    assert factor == pytest.approx(np.exp(c.linear_growth_rate * period), rel=0.02)


def test_a_rod_that_leaves_the_model_has_its_transient():
    """To where it is crushed, at 4.8e-7 by another code (Radau IIA on Legendre polynomials, two sizes)."""
    c = followed(195.0, STRETCHABLE, 0.2)
    assert c.status.name == "left_the_model"
    assert np.isfinite(c.transient_tip_path).all()
    assert c.transient_tip_path[0, -1] == pytest.approx(4.8e-7, rel=0.05)


def test_a_rod_that_does_not_settle_in_time_has_its_transient():
    c = solve_cycle(rod_of(30.0, *SOFT), CycleRequest(1e-6, 1e-7, 3, 0, 0, 0, 3, transient=50))
    assert c.status.name == "not_settled"
    assert c.transient_tip_path[2, 0] == pytest.approx(1e-7, rel=1e-3)
    assert np.isfinite(c.transient_tip_path).all()


def test_a_cycle_predicted_from_its_neighbour_has_no_transient():
    request = CycleRequest(1e-6, 0.1, 3, 0, 0, 0, 400, start="neighbour", transient=50)
    first = solve_cycle(rod_of(50.0, *SOFT), request, None, "F")
    second = solve_cycle(rod_of(51.0, *SOFT), request, first.start_for_next_rod, "F")
    assert first.transient_tip_path is not None
    assert (second.status.name, second.transient_tip_path) == ("cycle", None)


# --- the figure -------------------------------------------------------------------------------------------

TWO = ([50.0], [1e4], [1e2], [1e-2], [1.0, 0.5])


def view_with_transients(statuses=(0, 1), there=(True, True), **words):
    view = make_view(TWO, statuses, **words)
    time = np.linspace(0, 0.1, 200) * np.where(there, 1.0, np.nan)[:, None]
    shape = (1, 1, 1, 1, 2, 200)
    y = 0.3 * np.sin(300 * time) * np.array([[1.0], [0.5]])
    values = {"time": time, "x": 1 - y**2, "y": y, "theta": 2 * y}
    view.variables.update({f"transient_{name}": v.reshape(shape) for name, v in values.items()})
    return view


def test_transients_are_drawn_of_points_with_and_without_a_cycle():
    view = view_with_transients()
    figure, shown = draw_transients(view, ())
    assert shown == "the tip from the start on"
    upper, lower = figure.axes[:2], figure.axes[2:4]
    for column in (0, 1):
        stored = {n: view.variables[f"transient_{n}"][0, 0, 0, 0, column] for n in ("time", "x", "y")}
        for axes, name in ((upper[column], "x"), (lower[column], "y")):
            assert np.array_equal(axes.lines[0].get_xdata(), stored["time"])
            assert np.array_equal(axes.lines[0].get_ydata(), stored[name])
    y_max = float(view.variables["tip_y_max"].ravel()[0])
    levels = [[line.get_ydata()[0] for line in axes.lines if line.get_ls() == "--"] for axes in lower]
    assert levels == [[y_max, -y_max], []]
    assert "straight" in upper[1].get_title()


def test_portrait_shows_how_the_beating_emerges_where_all_its_cycles_have_a_transient():
    for there, emerges in (((True, True), True), ((True, False), False)):
        view = view_with_transients((0, 0), there)
        figure, shown = draw_shapes_and_tip_motion(view, ())
        assert ("from the start on" in shown) == emerges
        points = len(figure.axes[2].lines[0].get_xdata())
        assert points == (200 if emerges else 801)


@pytest.mark.long
@pytest.mark.parametrize(
    ("view", "points", "what"),
    [
        pytest.param(view_with_transients((0, 0)), (), "cycle", marks=survey_only),
        pytest.param(view_with_transients((1, 1)), (), "transient", marks=survey_only),
        (view_with_transients((0, 1)), (), "cycle"),
        (view_with_transients((0, 1)), (2,), "transient"),
        pytest.param(view_with_transients((0, 0), stored=()), (), "transient", marks=survey_only),
        (view_with_transients((0, 0), stored=()), (1,), "transient"),
    ],
)
def test_transients_are_suggested_where_there_are_no_shapes_to_draw(tmp_path, view, points, what):
    assert chosen_figure_kind(FigureRequest([view], tmp_path / "f.png", points=points)) == what
    draw(view, tmp_path / "f.png", points=points)


@pytest.mark.parametrize(
    ("view", "points", "message"),
    [
        (make_view(TWO, [0, 0]), (), r"holds no transient_time; run with limit_cycle.transient > 0"),
        (
            view_with_transients((0, 0), (True, False)),
            (2,),
            "motion of this point from its initial state is not stored",
        ),
        (view_with_transients((0, 0), (False, False)), (), "holds no transient that could be drawn"),
        (view_with_transients(), (3,), "points 1 to 2"),
    ],
)
def test_transients_that_are_not_there_are_refused_in_one_sentence(tmp_path, view, points, message):
    with pytest.raises(InputError, match=message) as refused:
        draw(view, tmp_path / "f.png", what="transient", points=points)
    assert len(str(refused.value).splitlines()) == 1
