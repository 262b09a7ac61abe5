"""Nonlinear arms: tapered, in segments, of rubber. Equations, cycles, normal forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from mixed_motion import rate as mixed_rate
from reference.displaced_segments import Segments
from reference.strain_collocation import Arm, Law
from surveyed import survey_only

from rodsweep.bench.limit_cycle.swept_rods import TWO_SEGMENT_PROFILE
from rodsweep.determinant.arm.determinant import arm_determinant, forget_arm_determinants
from rodsweep.discretization.elements.mesh import mesh_with_edges
from rodsweep.discretization.explicit_system import ExplicitSystem
from rodsweep.discretization.plane_equations import write_balance, write_balance_parameter_derivative
from rodsweep.discretization.straight.mixed_form import MixedForm
from rodsweep.discretization.stress.form import StressForm
from rodsweep.discretization.stresses_at_jumps import interpolate_stress, stresses_at_both_sides
from rodsweep.model.material.laws import LAWS
from rodsweep.model.material.profile import FACTOR_NAMES, Profile
from rodsweep.model.material.rod_material import DEFAULT_MATERIAL, RodMaterial
from rodsweep.model.material.stress_strain import LocalSection, stress_minus_rest_stress
from rodsweep.model.parameters import PARAMETERS
from rodsweep.model.rod import Rod
from rodsweep.solve.changes.threshold_kinds import ThresholdKind
from rodsweep.solve.changes.thresholds import ThresholdsRequest, solve_thresholds
from rodsweep.solve.cycle.accuracy.refinement import refined_cycle
from rodsweep.solve.cycle.by_integration import solve_by_integration
from rodsweep.solve.cycle.cycle_of_neighbouring_rod import CycleStart
from rodsweep.solve.cycle.cycle_outcome import CycleRequest
from rodsweep.solve.cycle.hopf_start import hopf_point_below_force, orbit_from_hopf
from rodsweep.solve.cycle.limit_cycle import solve_cycle
from rodsweep.solve.cycle.straight_rod import straight_rod_stability
from rodsweep.solve.cycle.transient.motion_mesh import coarse_mesh_for_branch_to_cycle
from rodsweep.solve.hopf.criticality import solve_criticality
from rodsweep.solve.orbit.matrix.workspace import NewtonWorkspace
from rodsweep.solve.orbit.measures import CycleMotion
from rodsweep.solve.orbit.newton import solve_by_newton
from rodsweep.solve.spectrum.path import leader_in_range

STEP = Profile((0.0, 0.4, 0.4, 1.0), ((1.0,) * 6,) * 2 + ((3.0, 0.5, 2.0, 1.0, 1.5, 0.7),) * 2)
JUMP_OF_ONE = Profile((0.0, 0.4, 0.4, 1.0), ((1.0,) * len(FACTOR_NAMES),) * 4)
ONES = Profile((0.0, 0.3, 1.0), ((1.0,) * len(FACTOR_NAMES),) * 3)
RUBBER = [RodMaterial(*names) for names in LAWS]
NAMES = ["-".join(names) for names in LAWS]
ARMS = {
    "cone": (RodMaterial(), 0.5, (0.0, 1.0)),
    "segments": (RodMaterial(profile=STEP), 0.6, (0.0, 0.4, 1.0)),
    "rubber": (RodMaterial("neo_hookean", "fixed"), 0.7, (0.0, 1.0)),
    "swelling": (RodMaterial("neo_hookean", "swelling"), 0.7, (0.0, 0.3, 1.0)),
    "uniform swelling": (RodMaterial("neo_hookean", "swelling"), 1.0, (0.0, 1.0)),
    "rubber segments": (RodMaterial("neo_hookean", "fixed", STEP), 0.6, (0.0, 0.4, 1.0)),
    "swelling segments": (RodMaterial("neo_hookean", "swelling", STEP), 0.7, (0.0, 0.2, 0.4, 1.0)),
}


def request(accuracy, start="mode"):
    return CycleRequest(accuracy, 0.01, 4, 0, 0, 9, 400, start)


def on_mesh(name, **changed):
    """An arm of `ARMS` in its stresses on a coarse mesh."""
    material, taper, edges = ARMS[name]
    values = {"F": 20.0, "k1": 200.0, "k2": 150.0, "gamma3": 0.02, "gamma1": 0.7, "taper": taper} | changed
    return StressForm(Rod(**values, material=material), mesh_with_edges(edges, 7))


def moving(form, size, seed=0):
    """(state, V, G) of a random state."""
    x = size * np.random.default_rng(seed).standard_normal(form.unknown_count)
    V, G = np.empty((2, 3, form.mesh.node_count + 1))
    write_balance(x, V, G, form.nodal_rod, form.mesh.node_matrices)
    return x, V, G


@pytest.mark.parametrize("name", ARMS)
def test_the_jacobian_is_the_derivative_of_the_rate(name):
    form = on_mesh(name)
    system = ExplicitSystem(form.rod, form.mesh)
    z = 0.3 * np.random.default_rng(1).standard_normal(system.unknown_count)
    h = 1e-6
    differences = [
        (system.state_derivative(z + h * e) - system.state_derivative(z - h * e)) / (2 * h)
        for e in np.eye(system.unknown_count)
    ]
    J = system.jacobian(z)
    assert np.abs(J - np.array(differences).T).max() < 1e-8 * np.abs(J).max()


@pytest.mark.parametrize("parameter", PARAMETERS)
@pytest.mark.parametrize("name", ARMS)
def test_the_balance_changes_with_every_parameter_as_its_differences_say(name, parameter):
    form = on_mesh(name)
    x, V, _ = moving(form, 1.0)
    change = np.empty((3, *V.shape))
    write_balance_parameter_derivative(
        x, V, change, form.nodal_rod_parameter_derivative(parameter), form.nodal_rod, form.mesh.node_matrices
    )
    at = form.rod.coordinate(parameter)
    h = 1e-6 * max(abs(at), 1e-3)
    ends = []
    for side in (1, -1):
        beside = replace(form, rod=form.rod.with_coordinate(parameter, at + side * h))
        ends.append(moving(beside, 1.0)[2])
    difference = (ends[0] - ends[1]) / (2 * h)
    assert np.abs(change[2] - difference).max() < 1e-6 * np.abs(difference).max()


@pytest.mark.parametrize("name", ARMS)
def test_the_energy_grows_by_what_the_force_gives_and_the_fluid_takes(name):
    form = on_mesh(name)
    x, V, G = moving(form, 0.3)
    weighted = form.nodal_rod.compliance * form.mesh.quadrature_weights
    rates = form.layout.state(G / weighted, V)
    h = 1e-4 / np.abs(rates).max()
    steps = [form.elastic_energy(x + k * h * rates) for k in (-2, -1, 1, 2)]
    growth = (steps[0] - 8 * steps[1] + 8 * steps[2] - steps[3]) / (12 * h)
    lost = np.sum(form.mesh.quadrature_weights * form.nodal_rod.drag * V**2)
    power = -form.nodal_rod.tip_stress @ G[:, -1] - lost
    assert growth == pytest.approx(power, abs=1e-7 * lost)


@pytest.mark.parametrize("name", ARMS)
def test_the_mixed_form_has_the_same_motion_to_third_order(name):
    """Without V eliminated: its linear, quadratic and cubic terms are those of the balance."""
    form = on_mesh(name)
    mixed = MixedForm(form.rod, form.mesh)
    errors = []
    for size in (0.02, 0.01):
        x, V, G = moving(form, size)
        X = mixed.layout.state(form.stresses(x), V)
        cubic = mixed.trilinear_map(X, X, X) / 6
        S, _ = mixed.stresses_and_velocities(mixed_rate(mixed, X) + cubic)
        errors.append(np.abs(S[:, :-1] - G[:, :-1]).max() / np.abs(G).max())
        balanced = mixed.stresses_and_velocities(mixed_rate(mixed, X) + cubic)[1]
        errors[-1] = max(errors[-1], np.abs(balanced).max() / np.abs(V).max())
    if form.rod.material.law == "linear":
        assert max(errors) < 1e-12
    else:
        assert errors[1] < max(errors[0] / 7, 1e-12)  # what is left is of fourth order in all, relative third


@pytest.mark.parametrize(
    "material", [RodMaterial(profile=ONES), DEFAULT_MATERIAL], ids=["profile of ones", "taper of nearly 1"]
)
def test_an_arm_that_does_not_vary_beats_as_the_uniform_rod(material):
    values = {"F": 50.0, "k1": 1e4, "k2": 1e2, "gamma3": 1e-2}
    taper = 1.0 if material.profile else 1 + 1e-13
    uniform, arm = (
        solve_cycle(Rod(**values), request(1e-8)),
        solve_cycle(Rod(**values, taper=taper, material=material), request(1e-8)),
    )
    assert arm.status == uniform.status
    allowed = arm.errors.period_error + uniform.errors.period_error
    assert arm.measures.period == pytest.approx(uniform.measures.period, rel=allowed)
    assert arm.measures.tip_y_max == pytest.approx(uniform.measures.tip_y_max, rel=2e-8)
    assert arm.multiplier == pytest.approx(uniform.multiplier, abs=2e-8)


CYCLES = [
    (0, 0.55, {"F": 24.0, "k1": 1e3, "k2": 50.0, "gamma3": 3e-3, "gamma1": 0.7}),
    (1, 0.67, {"F": 27.0, "k1": 300.0, "k2": 25.0, "gamma3": 2e-2, "gamma1": 1.0}),
    (2, 1.26, {"F": 51.0, "k1": 500.0, "k2": 400.0, "gamma3": 9e-2, "gamma1": 1.9}),
]


@pytest.mark.long
@pytest.mark.parametrize(
    ("law", "taper", "values"),
    [pytest.param(*case, marks=() if case[0] == 1 else survey_only) for case in CYCLES],
    ids=NAMES,
)
def test_cycles_are_those_of_strains_marched_in_time(law, taper, values):
    """By code that shares nothing: Chebyshev collocation of the strains, SciPy's Radau."""
    material = RUBBER[law]
    rod = Rod(**values, taper=taper, material=material)
    found = solve_cycle(rod, request(1e-8), None, "F")
    assert found.status.name == "cycle"
    orbit = found.start_for_next_rod.predictor.orbit

    def radius(u):
        return 1 - (1 - taper) * u

    arm = Arm(
        rod.F,
        lambda u: (rod.k1 * radius(u) ** 2, rod.k2 * radius(u) ** 2, radius(u) ** 4),
        lambda u: (rod.gamma1, 1.0, rod.gamma3 * radius(u) ** 2),
        Law(material.law, material.section),
    )
    strains = orbit.form.mesh.evaluation_matrix(arm.u[:-1]) @ orbit.form.strains(orbit.start_state).T
    period, y = arm.cycle(strains.T.ravel(), found.measures.period)
    assert period == pytest.approx(found.measures.period, rel=2e-8)
    assert y == pytest.approx(found.measures.tip_y_max, rel=2e-7)


SEGMENTS = [
    ("fixed", {"F": 30.0, "k1": 200.0, "k2": 300.0, "gamma3": 1e-2, "gamma1": 0.8}),
    ("swelling", {"F": 45.0, "k1": 500.0, "k2": 300.0, "gamma3": 1e-2, "gamma1": 1.2}),
]


@pytest.mark.parametrize(
    ("section", "values"),
    [pytest.param(*segments, marks=survey_only) for segments in SEGMENTS],
    ids=["fixed", "swelling"],
)
def test_cycles_of_rubber_segments_are_those_of_displacements_marched_in_time(section, values):
    """By code that shares nothing, in which positions are continuous at the jump and strains are not."""
    factors = (0.6, 0.7, 0.5, 1.0, 1.2, 0.8)
    material = RodMaterial("neo_hookean", section, Profile(STEP.u, ((1.0,) * 6,) * 2 + (factors,) * 2))
    rod = Rod(**values, material=material)
    found = solve_cycle(rod, request(1e-8), None, "F")
    assert found.status.name == "cycle"
    orbit = found.start_for_next_rod.predictor.orbit
    stiffness, drag = (rod.k1, rod.k2, 1.0), (rod.gamma1, 1.0, rod.gamma3)
    outer = [np.multiply(own, f) for own, f in ((stiffness, factors[:3]), (drag, factors[3:]))]
    segments = Segments(
        rod.F, (0.0, 0.4, 1.0), (stiffness, outer[0]), (drag, outer[1]), Law(material.law, section), order=14
    )
    shape = orbit.form.mesh.evaluation_matrix(segments.u) @ orbit.form.shape(orbit.start_state).T
    period, y = segments.cycle(shape.T, found.measures.period, turns=1)
    assert period == pytest.approx(found.measures.period, rel=1e-7)
    assert y == pytest.approx(found.measures.tip_y_max, rel=3e-7)


OFF_BY_A_JUMP = [
    (
        2.7e-8,
        ("linear", "fixed"),
        {"F": 54.37758574938067, "k1": 2808.1155575582607, "k2": math.inf, "gamma3": 6.698685675566226e-4},
        0.18093417109640694,
        (0.594, 1.202430505513659, 4.625674396181283, 0.3264042448040304),
    ),
    (
        4.4e-8,
        ("neo_hookean", "swelling"),
        {"F": 54.58068419055371, "k1": 18191.830117097787, "k2": 8204.985700532343, "gamma3": 0.0},
        0.6462785980729304,
        (0.517, 0.5220515092504533, 2.110895372407469, 0.571584538310548),
    ),
]


@pytest.mark.long
@pytest.mark.parametrize("accuracy, names, values, gamma1, jump", OFF_BY_A_JUMP, ids=["linear", "swelling"])
def test_the_largest_y_of_segments_is_within_its_error(accuracy, names, values, gamma1, jump):
    """A tip integrated with the mean strain at the jump was off by 7.9 and 1.4 times the stated error."""
    at, *stiffness = jump
    factors = (*stiffness, 1.0, 1.0, 1.0)
    profile = Profile((0.0, at, at, 1.0), ((1.0,) * len(FACTOR_NAMES),) * 2 + (factors,) * 2)
    rod = Rod(**values, gamma1=gamma1, material=RodMaterial(*names, profile))
    memory = NewtonWorkspace()
    form = StressForm(rod, coarse_mesh_for_branch_to_cycle(rod))
    found = refined_cycle(orbit_from_hopf(form, hopf_point_below_force(rod), memory), accuracy, memory)
    orbit = found.orbit
    finer = mesh_with_edges(orbit.form.mesh.edges, orbit.form.mesh.order + 8)
    start = orbit.on_mesh(finer, 2 * orbit.interval_count, orbit.stage_count + 1)
    exact = CycleMotion(solve_by_newton(start, 1e-12, memory).orbit).tip_extrema["tip_y_max"]
    assert abs(found.measures.tip_y_max / exact - 1) <= found.errors.amplitude_error


def test_the_straight_rod_is_the_same_whatever_was_solved_before():
    """To the last bit: propagators of D made for other |w| would change the eigenvalue by rounding errors."""
    material = RodMaterial("neo_hookean", "swelling", jump_in_k3())
    rod = Rod(F=24.0, k1=400.0, k2=300.0, gamma3=0.01, material=material)
    alone = straight_rod_stability(rod)
    for first in (10, 14, 20, 28):
        forget_arm_determinants()
        for size in np.geomspace(first, 1e5 * first, 60):
            arm_determinant(rod).propagators_for(size)
        assert straight_rod_stability(rod) == alone


def jump_in_k3():
    """A profile whose bending stiffness jumps to a half at u = 0.5 and falls towards the tip."""
    rows = [tuple(k3 if name == "k3" else 1.0 for name in FACTOR_NAMES) for k3 in (1, 1, 0.5, 0.4, 0.3)]
    return Profile((0.0, 0.5, 0.5, 0.8, 1.0), tuple(rows))


def test_a_jump_of_factor_one_is_none():
    """Of the balance to rounding, although the stress at the jump is solved for."""
    values = {"F": 30.0, "k1": 200.0, "k2": 150.0, "gamma3": 0.02, "taper": 0.7}
    grid = mesh_with_edges((0.0, 0.4, 1.0), 7)
    materials = (RodMaterial("neo_hookean", "swelling", profile) for profile in (None, JUMP_OF_ONE))
    plain, jumping = (StressForm(Rod(**values, material=material), grid) for material in materials)
    assert (len(plain.nodal_rod.jump_nodes), len(jumping.nodal_rod.jump_nodes)) == (0, 1)
    (x, V, G), (_, V_jumping, G_jumping) = (moving(form, 5.0) for form in (plain, jumping))
    assert np.abs(V_jumping - V).max() < 1e-13 * np.abs(V).max()
    assert np.abs(G_jumping - G).max() < 1e-13 * np.abs(G).max()
    assert jumping.elastic_energy(x) == pytest.approx(plain.elastic_energy(x), rel=1e-14)


def test_stress_at_a_jump_is_that_of_both_sides_and_strain_their_mean():
    form = on_mesh("swelling segments", F=40.0)
    x = 20.0 * np.random.default_rng(3).standard_normal(form.unknown_count)
    S = form.stresses(x)
    ((before, behind),) = stresses_at_both_sides(form.nodal_rod, S)
    (node,), (sides,) = form.nodal_rod.jump_nodes, form.nodal_rod.jump_side_coefficients
    both = list(zip(sides, (before, behind), strict=True))
    stresses = [stress_minus_rest_stress(2, LocalSection(*side[:3]), *q) for side, q in both]
    assert stresses[0] == pytest.approx(stresses[1], rel=1e-12)
    for component, place, own in ((0, 1, 0), (2, 2, 1)):
        mean = sum(side[5] * side[place] * q[own] for side, q in both)
        assert mean == pytest.approx(
            form.nodal_rod.compliance[component, node] * S[component, node], rel=1e-12
        )
    assert before[0] != pytest.approx(behind[0], rel=1e-3)


def test_fields_with_a_jump_are_carried_to_other_meshes():
    """A field that is smooth on either side, of which only the mean is a number of the node between."""
    rod = Rod(F=40.0, k1=200.0, k2=150.0, gamma3=0.02, material=RodMaterial("neo_hookean", "swelling", STEP))
    errors = []
    for order in (7, 13):
        source, target = (
            StressForm(rod, mesh_with_edges(edges, each, ratios))
            for edges, each, ratios in (
                ((0.0, 0.4, 1.0), order, (0.9, 1.0)),
                ((0.0, 0.2, 0.4, 0.7, 1.0), order - 2, ()),
            )
        )
        before, behind = (lambda u: np.cos(5 * u), lambda u: 2 + np.sin(4 * u))
        fields = []
        for form in (source, target):
            u, (node,), (sides,) = (
                form.mesh.node_positions,
                form.nodal_rod.jump_nodes,
                form.nodal_rod.jump_side_coefficients,
            )
            S = np.array([np.where(u < u[node], before(u), behind(u)), np.cos(3 * u), 0 * u])
            S[2] = S[0]
            for component, share in ((0, 3), (2, 4)):
                S[component, node] = sides[:, share] @ [before(u[node]), behind(u[node])]
            fields.append(S)
        errors.append(np.abs(interpolate_stress(rod, fields[0], source.mesh, target.mesh) - fields[1]).max())
    assert errors[0] < 1e-2
    assert errors[1] < 1e-7


def test_states_with_a_jump_have_the_values_of_both_sides_on_other_meshes():
    """An extrapolation to the jump from the other nodes of the elements is less accurate."""
    rod = Rod(F=40.0, k1=200.0, k2=150.0, gamma3=0.02, material=RodMaterial("neo_hookean", "swelling", STEP))
    source, target = (
        StressForm(rod, mesh_with_edges(edges, order, ratios))
        for edges, order, ratios in (
            ((0.0, 0.4, 1.0), 8, (0.875, 1.0)),
            ((0.0, 0.2, 0.4, 0.7, 1.0), 9, (1.0, 0.75, 0.5, 1.0)),
        )
    )
    mean = np.zeros((3, source.mesh.node_count + 1))
    (node,) = source.nodal_rod.jump_nodes
    mean[:, node] = 5.0, 0.0, 3.0
    ((before, behind),) = stresses_at_both_sides(source.nodal_rod, mean)
    fields = []
    for form in (source, target):
        u, (jump,), (sides,) = (
            form.mesh.node_positions,
            form.nodal_rod.jump_nodes,
            form.nodal_rod.jump_side_coefficients,
        )
        S = np.zeros((3, len(u)))
        for component, share, one, other in zip((0, 2), (3, 4), before, behind, strict=True):
            wave = 1 + np.sin(15 * (u - u[jump]))
            S[component] = np.where(u < u[jump], one, other) * wave * (1 - u) / (1 - u[jump])
            S[component, jump] = sides[:, share] @ [one, other]
        fields.append(S)
    state = source.layout.state(fields[0], np.zeros_like(fields[0]))
    found = target.stresses(source.states_on_mesh(target.mesh, state))
    extrapolated = target.stresses(source.increments_on_mesh(target.mesh, state))
    error, other_error = (np.abs(each - fields[1]).max() for each in (found, extrapolated))
    assert error < other_error / 5 < 0.1
    assert error < 2e-2
    jump = target.nodal_rod.jump_nodes
    assert found[:, jump] == pytest.approx(fields[1][:, jump], rel=1e-8)


@pytest.mark.long
@pytest.mark.parametrize("material", [RodMaterial(profile=STEP), RUBBER[2]], ids=["segments", "swelling"])
def test_cycles_agree_with_arkimex_alone(material):
    rod = Rod(F=60.0, k1=500.0, k2=1e2, gamma3=1e-2, material=material)
    found, marched = solve_cycle(rod, request(1e-8)), solve_by_integration(rod, request(1e-5))
    assert found.status.name == marched.status.name == "cycle"
    error = marched.errors.period_error
    assert marched.measures.period == pytest.approx(found.measures.period, rel=error)
    assert marched.measures.tip_y_max == pytest.approx(found.measures.tip_y_max, rel=error)


SWELLING_STEP = RodMaterial("neo_hookean", "swelling", STEP)


@pytest.mark.parametrize("material", [*RUBBER, SWELLING_STEP], ids=[*NAMES, "segments"])
def test_the_normal_form_is_the_limit_of_cycles(material):
    """Amplitude squared over the distance, by Richardson extrapolation from four forces.

    The truncation error is of fourth order, at most 1e-9 here; the rest is the error of the cycles.
    """
    rod = Rod(F=0.0, k1=500.0, k2=1e3, gamma3=1e-3, gamma1=0.8, taper=0.8, material=material)
    found = solve_criticality(rod, ThresholdsRequest(60.0, 1e-9, True, 2))
    hopf, born = found.search_result.thresholds[0], found.coefficients[0]
    assert found.status.name == "ok"
    ratios = []
    for distance in (8e-3, 4e-3, 2e-3, 1e-3):
        cycle = solve_cycle(replace(rod, F=hopf.value * (1 + distance)), request(1e-10, "hopf"))
        assert cycle.status.name == "cycle"
        ratios.append(cycle.measures.tip_y_max**2 / distance)
    for factor in (2, 4, 8):
        pairs = zip(ratios[1:], ratios[:-1], strict=True)
        ratios = [(factor * near - far) / (factor - 1) for near, far in pairs]
    assert math.sqrt(ratios[0]) == pytest.approx(born.amplitude_coefficient, rel=1e-8)


@pytest.mark.parametrize("material", RUBBER, ids=NAMES)
def test_inextensible_cones_of_every_law_are_one(material):
    """With k1 = inf no law acts but through the bending factor at h1 = 1, which is 1."""
    values = {"F": 20.0, "k1": math.inf, "k2": math.inf, "gamma3": 0.0, "taper": 0.6}
    linear, arm = (
        solve_cycle(Rod(**values, material=b), request(1e-7)) for b in (DEFAULT_MATERIAL, material)
    )
    assert arm.status == linear.status
    assert arm.measures.period == pytest.approx(linear.measures.period, rel=2e-7)
    assert arm.measures.tip_y_max == pytest.approx(linear.measures.tip_y_max, rel=2e-7)


def test_a_cone_begins_to_beat_where_its_thresholds_say():
    rod = Rod(F=0.0, k1=1e4, k2=1e4, gamma3=1e-4, taper=0.5)
    found = solve_thresholds(rod, ThresholdsRequest(40.0, 1e-10, True, 8))
    hopf = next(c.value for c in found.thresholds if c.kind == ThresholdKind.hopf)
    assert hopf == pytest.approx(15.4627583986, rel=1e-11)  # physics: by collocation
    for distance, status in ((-1e-4, "straight"), (1e-4, "cycle")):
        assert solve_cycle(replace(rod, F=hopf * (1 + distance)), request(1e-6)).status.name == status


def test_a_neighbour_is_restored_with_its_build():
    """A chain that was interrupted goes on with the same data."""
    rod = Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2, taper=0.9, material=RodMaterial(profile=STEP))
    neighbour = solve_cycle(rod, request(1e-5), None, "F").start_for_next_rod
    again = CycleStart.from_arrays(neighbour.arrays())
    assert again.predictor.orbit.form.rod == rod
    assert again.predictor.orbit.form.mesh == neighbour.predictor.orbit.form.mesh
    assert again.next_mesh == neighbour.next_mesh
    beside = replace(rod, F=51.0)
    ends = [solve_cycle(beside, request(1e-5), each, "F").measures.period for each in (neighbour, again)]
    assert ends[0] == ends[1]


def test_a_chain_of_arms_goes_on_from_a_checkpoint_with_its_range():
    """The leading eigenvalue has the same bits, with propagators that are interpolated again."""
    material = RodMaterial(profile=TWO_SEGMENT_PROFILE)
    rods = [Rod(F=14.0, k1=1e4 + 50 * k, k2=1e2, gamma3=1e-2, material=material) for k in range(3)]
    neighbour = None
    for rod in rods[:2]:
        neighbour = solve_cycle(rod, request(1e-4), neighbour, "k1").start_for_next_rod
    again = CycleStart.from_arrays(neighbour.arrays())
    assert again.arm_range == neighbour.arm_range is not None
    first = solve_cycle(rods[2], request(1e-4), neighbour, "k1")
    leader_in_range.arm_family_and_hulls_of_range.cache_clear()
    second = solve_cycle(rods[2], request(1e-4), again, "k1")
    assert (first.linear_growth_rate, first.linear_frequency) == (
        second.linear_growth_rate,
        second.linear_frequency,
    )
    assert first.start_for_next_rod.arm_range == neighbour.arm_range


def test_a_slow_fast_cycle_far_longer_than_the_time_constant_of_its_mode_is_found():
    """The leading mode does not oscillate; a run of so many time constants saw one return or none."""
    values = {"F": 180.12686914945215, "k1": 202.094026246852, "k2": 97.0201637314358, "gamma3": 7.6e-4}
    rod = Rod(**values, gamma1=0.81, taper=1.463, material=RodMaterial("neo_hookean"))
    found = solve_cycle(rod, request(1e-5))
    assert found.status.name == "cycle", found.message
    assert found.linear_frequency == 0.0
    assert found.measures.period > 5 / found.linear_growth_rate
    finer = solve_cycle(rod, request(1e-7, start="hopf"))
    assert finer.status.name == "cycle", finer.message
    assert found.measures.period == pytest.approx(finer.measures.period, rel=found.errors.period_error + 1e-9)


@survey_only
def test_a_motion_that_repeats_on_a_coarse_mesh_alone_is_integrated_on_a_finer_one():
    """Strongly compressed segments with a swelling section: near the motion on the first mesh no finer mesh
    has a cycle."""
    rows = (
        ((1.0,) * 6,) * 2 + ((1.0, 1.03, 0.76, 1.0, 1.0, 1.0),) * 2 + ((1.0, 0.757, 1.014) + (1.0,) * 3,) * 2
    )
    profile = Profile((0.0, 0.578, 0.578, 0.748, 0.748, 1.0), rows)
    rod = Rod(
        F=67.93193829115889,
        k1=305.04664257542754,
        k2=123.82153699260373,
        gamma3=9.38533509971412e-05,
        gamma1=0.19147935827034565,
        material=RodMaterial("neo_hookean", "swelling", profile),
    )
    found = solve_cycle(rod, request(1e-5))
    assert found.status.name == "cycle", found.message
    below = solve_cycle(rod.with_values(F=66.0), request(1e-5))
    assert below.status.name == "cycle", below.message
    assert below.measures.period > found.measures.period > 0.9 * below.measures.period
    assert abs(found.measures.energy_imbalance) < 1e-3
