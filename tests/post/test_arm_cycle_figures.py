"""Figures of the cycles of arms: in cm, s and W, under the arm's quantities as they were typed."""

import re
from dataclasses import replace

import numpy as np
import pytest
from known_cycles import make_view

import rodsweep as rs
from rodsweep.api.dataset import view_of_dataset
from rodsweep.model.arm.arm import SlenderArm
from rodsweep.post.figures.cycle.animation import prepared_animation
from rodsweep.post.figures.cycle.energy import draw_energy
from rodsweep.post.figures.cycle.selection import chosen_cycles
from rodsweep.post.figures.cycle.shapes_and_tip_motion import draw_shapes_and_tip_motion
from rodsweep.tasks.cycle_shapes import with_shapes

ARM = {"length": 0.15, "radius": 5e-3, "young": 6e4, "viscosity": 30.0, "pressure": 726.0}
TYPED = {"length": "cm", "radius": "mm", "young": "kPa", "viscosity": "Pa s", "pressure": "kPa"}


def arms(lengths=(0.15,), gamma1=None):
    """A list of cycles, of the arms of these lengths; gamma1 replaces the arm's own."""
    made = [SlenderArm(**(ARM | {"length": length})) for length in lengths]
    names = ("F", "k1", "k2", "gamma3", "gamma1")
    columns = [[getattr(arm, name) for arm in made] for name in names]
    if gamma1:
        columns[-1] = [gamma1] * len(made)
    view = make_view(columns, [0] * len(made), as_list=True)
    units = {name: [getattr(arm, name) for arm in made] for name in ("tau2", "force_scale", "pressure_scale")}
    quantities = {name: np.array(value) for name, value in (ARM | units | {"length": list(lengths)}).items()}
    return replace(view, variables=view.variables | quantities, typed_units=TYPED), made


def test_an_arm_beats_in_cm_and_s_under_its_quantities():
    view, (arm,) = arms()
    figure = draw_shapes_and_tip_motion(view, ())[0]
    shapes, upper, lower = figure.axes[:3]
    assert (shapes.get_xlabel(), shapes.get_ylabel()) == ("$x$ (cm)", "$y$ (cm)")
    assert (upper.get_ylabel(), lower.get_ylabel()) == ("tip $x$ (cm)", "tip $y$ (cm)")
    assert lower.get_xlabel() == "time $t$ (s)"
    period = float(view.variables["period"][0]) * arm.tau2
    assert shapes.get_title().replace("\xa0", " ") == f"$T$ = {period:.4g} s"
    assert lower.lines[0].get_xdata()[-1] == pytest.approx(2 * period)
    largest = 15 * np.abs(view.variables["tip_y"]).max()
    assert np.abs(lower.lines[0].get_ydata()).max() == pytest.approx(largest, rel=1e-2)
    assert "viscosity\xa030\xa0Pa\xa0s," in figure.get_suptitle()
    assert figure.get_suptitle().replace("\xa0", " ").splitlines()[-1] == (
        "length 15 cm, radius 5 mm, Young's modulus 60 kPa, viscosity 30 Pa s, pressure 0.726 kPa"
    )


def test_arms_of_two_lengths_are_drawn_in_their_sizes_and_told_apart_by_them():
    view, _ = arms((0.1, 0.2))
    short, long = draw_shapes_and_tip_motion(view, ())[0].axes[:2]
    assert short.get_title().replace("\xa0", " ").startswith("length 10 cm\n")
    assert long.get_title().replace("\xa0", " ").startswith("length 20 cm\n")
    reach = [max(line.get_xdata().max() for line in axes.lines[2:]) for axes in (short, long)]
    assert 8 < reach[0] <= 10
    assert 16 < reach[1] <= 20


def test_a_parameter_beside_the_arm_is_told_and_the_arms_own_are_not():
    assert "gamma" not in chosen_cycles(arms()[0], (), ()).title
    assert chosen_cycles(arms(gamma1=1.25)[0], (), ()).title.endswith(r"$\tilde\gamma_1 = 1.25$")


def test_energy_of_an_arm_is_in_joule_and_its_rate_in_watt():
    view, (arm,) = arms()
    figure = draw_energy(view, ())[0]
    top, middle, bottom = figure.axes
    energy, power = (label.split("(")[1][:-1] for label in (top.get_ylabel(), middle.get_ylabel()))
    prefix = {"µ": 1e-6, "m": 1e-3, "": 1.0}
    largest = view.variables["energy"].max() * arm.force_scale * 0.15 / prefix[energy[:-1]]
    assert energy.endswith("J")
    assert top.lines[0].get_ydata().max() == pytest.approx(largest, rel=1e-2)
    mean = 2000 * arm.force_scale * 0.15 / arm.tau2 / prefix[power[:-1]]
    assert power.endswith("W")
    assert middle.lines[0].get_ydata()[0] == pytest.approx(mean)
    _, line, marks = bottom.lines
    at = np.interp(marks.get_xdata(), line.get_xdata(), line.get_ydata())
    assert np.abs(marks.get_ydata() - at).max() < 1e-2 * np.abs(line.get_ydata()).max()


def test_a_film_of_an_arm_counts_seconds():
    view, (arm,) = arms()
    _, (moving,) = prepared_animation(chosen_cycles(view, (), ()))
    moving.show_frame(4)
    seconds = float(view.variables["period"][0]) * arm.tau2 * 4 / moving.frames
    shown = re.match(r"\$t\$ = ([\d.]+) s = ", moving.text.get_text())
    assert float(shown[1]) == pytest.approx(seconds, rel=1e-2)


@pytest.mark.parametrize(
    "arms",
    [
        {"F": 60.0, "k1": 200.0, "k2": 1e4, "gamma3": 1e-4, "law": "neo_hookean"},
        {"F": 40.0, "k1": 1e4, "k2": 1e4, "gamma3": 1e-3, "profile": {"u": [0, 1], "k3": [1, 0.5]}},
        {
            "arm": {
                "segments": ["5 cm: radius 6 mm, young 80 kPa", "7 cm: radius 5 mm"],
                "young": "100 kPa",
                "viscosity": "50 Pa s",
                "drag": ["likeliest", "most"],
                "pressure": "1.3 of flutter",
            },
            "gamma1": 0.6,
        },
    ],
)
def test_a_cycle_without_shapes_is_solved_again_as_that_of_its_own_arm(tmp_path, arms):
    """With law, profile, segments and drag of the file; without them the cycle was refused as another one."""
    data = rs.sweep("limit_cycle", accuracy=1e-3, progress=False, **arms)
    view = view_of_dataset(data, tmp_path / "c.h5")
    number = view.variables["status"].size
    shown = with_shapes(view, [number])
    tip = shown.variables["tip_y"].reshape(number, -1)[-1]
    assert tip.max() == pytest.approx(view.variables["tip_y_max"].ravel()[-1], rel=2e-3)
