"""`parameters: {arm: ...}`: axes in SI units, what they become, what files have in SI."""

import csv
import re
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from contents import content, same
from pint import UnitRegistry
from surveyed import only

import rodsweep as rs
from rodsweep.api.keyword_arguments import config_tree, job_of_tree
from rodsweep.model.arm.arm import SlenderArm
from rodsweep.post.figures import draw
from rodsweep.results.file.view import read_view
from rodsweep.results.layouts.si_variables import quantities_at_points, si_name_of

SILICONE = {"length": "10 cm", "radius": "5 mm", "young": "100 kPa", "viscosity": "1.4 Pa s"}
LOADED = SILICONE | {"pressure": "2 kPa"}
QUICK = {
    "spectrum": {"arm": SILICONE | {"pressure": ["1 kPa", "2 kPa"], "poisson": [0.3, 0.5]}, "modes": 2},
    "thresholds": {"arm": SILICONE | {"radius": ["4 mm", "5 mm"]}, "crossings": 4},
    "phase_diagram": {
        "arm": SILICONE | {"pressure": {"start": 0, "stop": "4 kPa", "num": 5}},
        "gamma3": [0.002, 0.004],
        "crossings": 4,
    },
    "modes": {"arm": LOADED | {"length": ["10 cm", "11 cm"]}, "nodes": 5},
    "criticality": {"arm": SILICONE | {"radius": ["4 mm", "5 mm"]}, "crossings": 4, "F_max": 60},
    "branch": {"arm": SILICONE | {"radius": ["4 mm", "5 mm"]}, "stop": 30, "cycles": 40, "accuracy": 1e-4},
    "limit_cycle": {
        "arm": SILICONE | {"force": ["0.19 N", "0.2 N"]},
        "start": "neighbour",
        "accuracy": 1e-3,
        "harmonics": 2,
    },
}
"""A config of every task with an arm, of a grid of parameters or over its quantities."""


def job(task, **keywords):
    return job_of_tree(config_tree(task, keywords))


def test_load_becomes_an_axis_of_F():
    """F = 4 (L/a)^2 p/E, k1 = 4 (L/a)^2, and k2 = 3 k1/(7 + 6 nu)."""
    made = job("spectrum", arm=SILICONE | {"pressure": {"start": "0 kPa", "stop": "5 kPa", "num": 6}})
    columns = made.points.columns_by_name
    assert made.points.shape == (6, 1, 1, 1)
    assert columns["F"] == pytest.approx(16 * np.arange(6), rel=1e-12)
    assert [columns[name][0] for name in ("k1", "k2")] == pytest.approx([1600, 480], rel=1e-12)
    assert columns["gamma3"][0] == SlenderArm(**LOADED).gamma3


def test_longer_range_of_a_load_has_the_same_forces():
    """Scaled ends would move some by their last digit, and `--extend` would compute all anew."""
    first, longer = (
        job("spectrum", arm=SILICONE | {"pressure": {"start": "0 kPa", "stop": stop, "num": num}})
        for stop, num in (("5 kPa", 51), ("6 kPa", 61))
    )
    assert np.array_equal(longer.points.columns_by_name["F"][:51], first.points.columns_by_name["F"])


def test_ratio_of_poisson_becomes_an_axis_of_k2_which_falls_as_it_rises():
    made = job("modes", arm=LOADED | {"poisson": [0.2, 0.4, 0.5]})
    (poisson,) = (values for variable, values in made.quantity_variables if variable.name == "poisson")
    assert made.points.shape == (1, 1, 3, 1)
    assert made.points.columns_by_name["k2"] == pytest.approx(4800 / (7 + 6 * poisson), rel=1e-12)
    assert poisson.tolist() == [0.5, 0.4, 0.2]


def test_logarithmic_ranges_stay_so():
    made = job("spectrum", arm=SILICONE | {"pressure": rs.logspace("0.1 kPa", "10 kPa", 5)})
    assert made.config.parameters.axes["F"].is_logarithmic
    assert made.points.columns_by_name["F"] == pytest.approx(np.geomspace(1.6, 160, 5), rel=1e-12)


def test_axes_that_move_several_parameters_become_a_grid_over_the_quantities():
    axes = {"length": ["10 cm", "20 cm"], "young": ["50 kPa", "100 kPa"], "pressure": ["1 kPa", "2 kPa"]}
    made = job("limit_cycle", arm=SILICONE | axes, gamma1=[0.5, 1])
    assert made.points.shape == (2, 2, 2, 2)
    assert made.layout.arm_axes == (*axes, "gamma1")
    quantities = quantities_at_points(made.quantity_variables, made.points)
    for index in range(16):
        at = {name: float(quantities[name][index]) for name in axes}
        arm = SlenderArm(radius=0.005, viscosity=1.4, **at)
        expected = {name: getattr(arm, name) for name in ("F", "k1", "k2", "gamma3")}
        expected["gamma1"] = (0.5, 1)[index % 2]
        assert made.points.parameter_values_of_point(index) == pytest.approx(expected, rel=1e-12)
        assert quantities["tau2"][index] == pytest.approx(arm.tau2, rel=1e-12)
        assert quantities["pressure_scale"][index] * expected["F"] == pytest.approx(at["pressure"], rel=1e-12)
    order = list(zip(*(quantities[name] for name in axes), strict=True))
    assert all(a <= b for a, b in pairwise(order))


def test_parameter_beside_the_arm_replaces_its_own():
    made = job("phase_diagram", **QUICK["phase_diagram"])
    assert made.config.plane_parameters == ("F", "gamma3")
    assert made.points.columns_by_name["gamma3"].tolist() == [0.002, 0.004]
    cycle = job("limit_cycle", arm=LOADED)
    assert cycle.points.columns_by_name["gamma1"][0] == SlenderArm(**LOADED).gamma1
    assert job("limit_cycle", arm=LOADED, gamma1=1).points.columns_by_name["gamma1"][0] == 1


def test_other_units_ask_for_the_same():
    keywords = [{"arm": LOADED}, {"arm": LOADED | {"length": "0.1 m", "pressure": 2000}}]
    texts = [job("spectrum", **each).resolved_config for each in keywords]
    assert texts[0] == texts[1]


@pytest.mark.parametrize(
    ("task", "arm", "beside", "sentence"),
    [
        ("spectrum", {"length": "10"}, {}, "parameters.arm.length = '10' has no unit"),
        ("spectrum", {"length": "10 kg"}, {}, "parameters.arm.length = '10 kg' is not measured in m"),
        ("spectrum", {"radius": ["6 mm", "5 mm"]}, {}, "parameters.arm.radius: .* is not sorted"),
        ("spectrum", {"radius": True}, {}, "parameters.arm.radius: True is not a number"),
        ("spectrum", {"radius": "-5 mm"}, {}, "parameters.arm.radius = -0.005 m is not above 0"),
        ("spectrum", {"radius": "2 cm"}, {}, "parameters.arm.length = 0.1 m is 5 radii, with radius = 0"),
        ("spectrum", {"width": "1 cm"}, {}, "parameters.arm.radius: give either a radius, or width and"),
        ("spectrum", {"poisson": 0.6}, {}, "parameters.arm.poisson = 0.6 is not a number above -1"),
        ("spectrum", {"youn": "1 kPa"}, {}, "unknown key parameters.arm.youn; did you mean young?"),
        ("spectrum", {"young": None}, {}, "parameters.arm.young"),
        ("spectrum", {"viscosity": ["2 Pa s", "1 Pa s"]}, {}, r"viscosity: .* is not sorted"),
        ("phase_diagram", {"viscosity": ["1 Pa s", "2 Pa s"]}, {}, "which change no parameter"),
        ("spectrum", {"pressure": "100 kPa"}, {}, "pressure = 100000 Pa crushes the arm"),
        ("spectrum", {"pressure": ["1.2 of flutter", "2 kPa"]}, {}, "has relative and absolute values"),
        ("spectrum", {"length": {"start": 5, "stop": "10 cm", "num": 4}}, {}, "in m; start has no unit, so"),
        ("spectrum", {"length": {"start": 1, "stop": 2, "num": 0}}, {}, "from 1 to [0-9]+$"),
        ("spectrum", {"force": "1 N"}, {}, "arm.pressure and parameters.arm.force are both given"),
        ("spectrum", {"poisson": [0.3, 0.5]}, {"k2": 100}, "poisson has several values but changes only k2"),
        ("spectrum", {"length": ["1 cm", "2 cm"]}, {}, "parameters.arm.length = 0.01 m is 2 radii"),
        ("spectrum", {"young": [500, 1000]}, {}, "pressure = 2000 Pa crushes the arm"),
        ("spectrum", {"young": ["90 kPa", "1 MPa"]}, {"k1": 2}, "parameters.k1 = 2 is below every F"),
        ("spectrum", {"poisson": [0.3, 0.6], "length": [0.1, 0.2]}, {}, "arm.poisson = 0.6 is not"),
        ("spectrum", {"radius": "-5 mm", "pressure": None}, {}, "arm.radius = -0.005 m is not above 0"),
        ("thresholds", {"young": 0}, {}, "parameters.arm.young = 0 Pa is not above 0"),
        ("spectrum", {"radius": 1e-300}, {}, "makes stiffnesses or the unit of force overflow"),
        ("spectrum", {}, {"F": 3}, "parameters.F and parameters.arm.pressure are both given"),
        ("spectrum", {}, {"points": "a.csv"}, "parameters.points and parameters.arm are both given"),
        ("spectrum", {"length": ["9 cm", "10 cm"]}, {"k1": [-1, 5]}, "parameters.k1 = -1 is not allowed"),
        ("spectrum", {}, {"k1": 5}, "parameters.F reaches 32 and parameters.k1 starts at 5"),
        ("thresholds", {}, {}, "solves for the load; remove it"),
        ("criticality", {}, {}, "solves for the load; remove it"),
        ("branch", {}, {}, "solves for the load; remove it"),
        ("branch", {}, {"along": "k1", "start": 10}, "branch.along: k1 is not allowed with parameters.arm"),
        ("phase_diagram", {"young": ["90 kPa", "100 kPa"]}, {}, "arm.young has several values, which change"),
        ("limit_cycle", {"length": ["9 cm", "10 cm"]}, {"start": "neighbour"}, "axis of a single parameter"),
    ],
)  # fmt: skip
def test_mistakes_are_told_in_a_sentence(task, arm, beside, sentence):
    with pytest.raises(rs.InputError, match=sentence.replace("?", r"\?")):
        job(task, arm=LOADED | arm, **beside)


def test_load_is_missing():
    with pytest.raises(rs.InputError, match=r"^parameters.arm.pressure is missing; give"):
        job("spectrum", arm=SILICONE)


def test_huge_grids_are_refused_before_they_are_made():
    axes = {"radius": rs.linspace("1 mm", "5 mm", 10**4), "pressure": rs.linspace(0, 1e3, 10**4)}
    with pytest.raises(rs.InputError, match="makes a grid of 100000000 points"):
        job("spectrum", arm=SILICONE | axes)


def yaml(task):
    """The config file that says what the keywords say."""
    return job(task, **QUICK[task]).given_config_yaml


@pytest.mark.parametrize("task", only(("spectrum", "branch", "thresholds"), QUICK))
def test_file_of_every_task_has_si_units_and_is_what_python_gives(command, task):
    command.write("a.yaml", yaml(task))
    for words in (("check", "a.yaml"), ("run", "a.yaml"), ("show", "a.h5"), ("export", "a.h5")):
        done = command(*words)
        assert done.returncode == 0, done.stderr
    file, here = rs.open(command.directory / "a.h5"), rs.sweep(task, **QUICK[task])
    assert set(file.coords) == set(here.coords)
    for name in file.variables:
        if name != "seconds":
            xr.testing.assert_identical(file[name], here[name])
    told = [name for name in file.data_vars if name.endswith("_si")]
    assert told, "nothing is told in SI units"
    for name in told:
        dimensionless = file[name.removesuffix("_si")]
        if dimensionless.units == "tau2":
            xr.testing.assert_allclose(file[name], dimensionless * file.tau2, rtol=1e-12)
        if dimensionless.units == "1/tau2":
            xr.testing.assert_allclose(file[name], dimensionless / file.tau2, rtol=1e-12)
    for name in (name for name in file.data_vars if "frequency" in name and "slope" not in name):
        if file[name].dims[-1] in ("curve_point", "fold", "hopf", "change"):
            continue  # told once
        if not name.endswith("_hz"):
            hertz = file[si_name_of(name, "Hz")]
            assert (hertz.units, file[name].units) == ("Hz", "rad/tau2")
            xr.testing.assert_allclose(2 * np.pi * hertz * file.tau2, file[name], rtol=1e-12)
    load = next((name for name in ("pressure", "force") if name in file.coords), None)
    if load:
        assert (file.F * file[f"{load}_scale"] - file[load]).values == pytest.approx(0, abs=1e-9)
    with (command.directory / "a.csv").open(newline="") as stream:
        assert {"length", "tau2"} <= set(next(csv.reader(stream)))


def test_thresholds_of_an_arm_are_those_of_its_verdict():
    data = rs.sweep("thresholds", arm=SILICONE | {"radius": ["4 mm", "5 mm"]})
    assert data.pressure_hopf.units == "Pa"
    assert data.radius.values.tolist() == [0.004, 0.005]
    arm = SlenderArm(**LOADED)
    F = rs.Rod(k1=arm.k1, k2=arm.k2, gamma3=arm.gamma3).thresholds().F_hopf
    assert data.pressure_hopf.values[1] == pytest.approx(2000 * F / arm.F, rel=1e-9)
    assert data.pressure_hopf.sel(radius=0.0051, method="nearest").item() == data.pressure_hopf.values[1]


def test_shards_and_a_stopped_run_of_an_arm_give_the_same_file(command):
    command.write("a.yaml", yaml("thresholds"))
    assert command("run", "a.yaml", "-o", "whole.h5").returncode == 0
    for shard in (1, 2):
        assert command("run", "a.yaml", "-o", f"{shard}.h5", "--shard", f"{shard}/2").returncode == 0
    assert command("merge", "merged.h5", "1.h5", "2.h5").returncode == 0
    assert command("run", "a.yaml", "-o", "1.h5").returncode == 0  # continues what the first shard began
    whole = content(command.directory / "whole.h5")
    for name in ("merged.h5", "1.h5"):
        assert same(whole, content(command.directory / name))


@pytest.mark.long
def test_figures_of_an_arm_are_drawn(command):
    command.write("a.yaml", yaml("phase_diagram"))
    assert command("run", "a.yaml").returncode == 0
    assert command.drawn("plot", "a.h5").returncode == 0


def test_axes_of_a_force_have_its_si_unit_opposite(command, drawn):
    """4 (L/a)^2 p/E: F = 80 is a pressure of 5 kPa; pi a^2 p a force of 0.39 N."""
    loads = {
        "pressure": ("5 kPa", 5.0, "pressure on the tip (kPa)"),
        "force": ("0.39269908169872414 N", 392.69908169872414, "force at the tip (mN)"),
    }
    for name, (largest, number, label) in loads.items():
        load = {name: {"start": 0, "stop": largest, "num": 9}}
        command.write(f"{name}.yaml", job("spectrum", arm=SILICONE | load, modes=2).given_config_yaml)
        assert command("run", f"{name}.yaml").returncode == 0
        draw(read_view(command.directory / f"{name}.h5"), command.directory / "f.png")
        drawn[-1].draw_without_rendering()
        (scale,) = drawn[-1].axes[0].child_axes
        assert scale.get_xlabel() == label
        assert drawn[-1].axes[0].get_xlim()[1] == pytest.approx(80)
        assert scale.get_xlim()[1] == pytest.approx(number)


def test_neighbours_follow_each_other_along_a_quantity_of_the_arm():
    arm = SILICONE | {"force": ["0.19 N", "0.2 N"]}
    made = [job("limit_cycle", arm=arm, start="neighbour", along=along) for along in ("force", "F")]
    assert made[0].config.settings_of_results == made[1].config.settings_of_results
    assert made[0].task.chains == made[1].task.chains
    with pytest.raises(rs.InputError, match=r"along is pressure but parameters\.arm\.pressure is not given"):
        job("limit_cycle", arm=arm, start="neighbour", along="pressure")


def test_configs_without_an_arm_have_no_trace_of_it():
    made = job_of_tree(config_tree("spectrum", {"F": 3, "k1": 200, "k2": 100, "gamma3": 0}))
    assert "arm" not in made.resolved_config["parameters"]
    assert made.quantity_variables == ()
    assert not any(variable.name.endswith("_si") for variable in made.layout.variables)


SILICONE_YAML = "length: 10 cm, radius: 5 mm, young: 100 kPa, viscosity: 1.4 Pa s"


@pytest.mark.parametrize(
    ("task", "load", "unit", "scale"),
    [
        ("spectrum", "pressure: {start: 1 kPa, stop: 2.5 kPa, num: 4}", "kPa", 1 / 16),
        ("spectrum", "force: {start: 80 mN, stop: 200 mN, num: 4}", "mN", 4.908738521234052),
        ("thresholds", "", "kPa", 1 / 16),
    ],
)
def test_show_tells_thresholds_as_the_load_is_given_and_frequencies_in_hertz(
    command, task, load, unit, scale
):
    """F = 1 is 1/16 kPa and 4.9 mN; a frequency is in rad/tau2, of which a Hz has 2 pi."""
    command.write("a.yaml", f"task: {task}\nparameters: {{arm: {{{SILICONE_YAML}, {load}}}}}\n")
    assert command("run", "a.yaml").returncode == 0
    lines = command("show", "a.h5").stdout.splitlines()
    without = lines.index("the same in dimensionless numbers:")
    assert any(line.startswith(("F**", "hopf ")) and "166.0" in line for line in lines[without:])
    number = r"([\d.]+)"
    told = rf"(?:flutter begins|hopf) at {number} (\w+)[:,] .*(?:begins to beat at|frequency) {number} Hz"
    found = next(filter(None, (re.fullmatch(told, line) for line in lines[:without])))
    assert not any(re.search(r"\bF\b|k1 =", line) for line in lines[:without])
    assert found[2] == unit
    assert float(found[1]) == pytest.approx(34.809000317504 * scale, rel=1e-5)
    tau2 = SlenderArm(**LOADED).tau2
    assert float(found[3]) == pytest.approx(166.085 / (2 * np.pi * tau2), rel=1e-5)
    assert (task == "thresholds") == any("pressure_onset = 1.14792 kPa" in line for line in lines)


@pytest.mark.parametrize(("task", "more"), [("thresholds", {}), ("branch", {"stop": 40}), ("spectrum", {})])
def test_an_arm_of_python_is_taken_by_sweeps(task, more):
    """Its load is left out where the task finds the load."""
    loaded = job("spectrum", arm=LOADED).points.columns_by_name
    made = job(task, arm=rs.Arm(**LOADED, density_difference="1 kg/m^3"), **more).points.columns_by_name
    assert ("F" in made) == (task == "spectrum")
    for name in loaded.keys() & made.keys():
        assert made[name] == pytest.approx(loaded[name], rel=1e-14)


def test_quantities_of_pint_keep_their_units():
    units = UnitRegistry()
    lengths, viscosity = units.Quantity([10, 11], "cm"), units.Quantity(1.4, "Pa*s")
    made = job("spectrum", arm=LOADED | {"length": lengths, "viscosity": viscosity}).points.columns_by_name
    told = job("spectrum", arm=LOADED | {"length": ["10 cm", "11 cm"]}).points.columns_by_name
    assert all(np.array_equal(made[name], told[name]) for name in told)
    assert rs.Arm(**LOADED | {"length": units.Quantity(10, "cm")}).k1 == pytest.approx(1600, rel=1e-12)
    with pytest.raises(rs.InputError, match="length = '10 kilogram' is not measured in m"):
        rs.Arm(**LOADED | {"length": units.Quantity(10, "kg")})


def test_the_curves_of_a_diagram_of_arms_are_part_of_its_cost():
    """Of uniform rods they take milliseconds."""
    cost = {}
    for taper in (1.0, 0.5):
        for curves in (False, True):
            tree = {
                "task": "phase_diagram",
                "parameters": {
                    "F": [0.0, 10.0],
                    "k1": [100.0, 200.0],
                    "k2": 1e3,
                    "gamma3": 0.1,
                    "taper": taper,
                },
                "phase_diagram": {"curves": curves},
            }
            cost[taper, curves] = job_of_tree(tree).task.cost().seconds
    assert cost[1.0, True] == cost[1.0, False]
    assert cost[0.5, True] > cost[0.5, False] + 1


@pytest.mark.parametrize(
    ("k2", "seconds"), [(1e4, (0.01, 0.1)), (1.0, (0.3, 1.5)), (0.1, (3, 15)), (np.inf, (0.01, 0.1))]
)
def test_thresholds_of_rods_soft_in_shear_are_expected_to_take_longer(k2, seconds):
    """At k1 = 1000, k2 = 1 takes 0.6 s and k2 = 0.1 takes 12 s."""
    tree = {"task": "thresholds", "parameters": {"k1": 1000.0, "k2": k2, "gamma3": 1e-3}}
    low, high = seconds
    assert low < job_of_tree(tree).task.cost().seconds < high
