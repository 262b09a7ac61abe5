"""The state of the page of `explore`: addresses, configs, Python lines, configs and files that it opens."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

import rodsweep as rs
from rodsweep.errors import InputError
from rodsweep.explore.export_panel import state_from_config_text
from rodsweep.explore.page_state import (
    DEFAULT_ARM,
    DEFAULT_ROD,
    MATERIAL_SECTION_BY_LAW,
    SECOND_PARAMETERS,
    TAB_DEFAULTS,
    PageState,
    from_address,
)

TEXT = st.text(st.characters(exclude_categories=("Cs",)), max_size=12)
RODS = st.builds(
    lambda texts, law, across, F_max: PageState(
        rod=dict(zip(DEFAULT_ROD, texts, strict=True)), law=law, across=across, F_max=F_max
    ),
    st.lists(TEXT, min_size=len(DEFAULT_ROD), max_size=len(DEFAULT_ROD)),
    st.sampled_from(list(MATERIAL_SECTION_BY_LAW)),
    st.sampled_from(SECOND_PARAMETERS["rod"]),
    TEXT,
)
OTHER = {"F": "31.5", "k1": "inf", "k2": "2e3", "gamma3": "1e-3", "gamma1": "0.5", "taper": "0.8"}
"""A rod of which no value is the default."""


@given(RODS)
def test_an_address_gives_the_same_state_whatever_was_typed(state):
    assert from_address(state.address()) == state


def test_the_address_of_an_arm_gives_the_same_arm():
    state = PageState(
        tab="arm", arm=DEFAULT_ARM | {"length": "12.5 cm"}, law="swelling", across="young", F_max="90"
    )
    assert from_address("?" + state.address()) == state


@pytest.mark.parametrize(
    ("query", "named"),
    [
        ("f=3", "f"),
        ("law=rubber", "law"),
        ("tab=wrist", "tab"),
        ("across=gamma1", "across"),
        ("F=3&length=2", "length"),
    ],
)
def test_an_address_with_an_unknown_key_or_choice_is_refused(query, named):
    with pytest.raises(InputError, match=named):
        from_address(query)


@pytest.mark.parametrize("law", MATERIAL_SECTION_BY_LAW)
def test_a_loaded_config_is_the_state_that_saved_it(law):
    state = PageState(rod=OTHER, law=law)
    assert state_from_config_text(state.yaml("limit_cycle")).rod_or_arm() == state.rod_or_arm()


def test_a_loaded_config_of_an_arm_is_the_arm_that_saved_it():
    state = PageState(tab="arm", arm=DEFAULT_ARM | {"pressure": "3.25 kPa", "radius": "4 mm"})
    loaded = state_from_config_text(state.yaml("limit_cycle"))
    assert (loaded.tab, loaded.arm) == ("arm", state.arm)


def test_a_saved_config_keeps_every_digit():
    rod = PageState(rod=OTHER | {"F": "49.7580049161915", "k1": "1234567.5"})
    assert state_from_config_text(rod.yaml("limit_cycle")).rod_or_arm() == rod.rod_or_arm()
    arm = PageState(tab="arm", arm=DEFAULT_ARM | {"pressure": "3.2731121 kPa"})
    assert state_from_config_text(arm.yaml("limit_cycle")).arm["pressure"] == "3.2731121 kPa"


@pytest.mark.parametrize("tab", TAB_DEFAULTS)
@pytest.mark.parametrize("task", ["thresholds", "branch"])
def test_a_saved_config_has_the_largest_force_of_the_page(task, tab):
    state = PageState(tab=tab, F_max="72.5")
    assert state_from_config_text(state.yaml(task)).F_max == "72.5"
    assert state_from_config_text(state.yaml("limit_cycle"), "60").F_max == "60"


def test_a_diagram_with_crushed_points_opens_with_a_rod_that_is_not_crushed():
    plane = "{F: {start: 0, stop: 100, num: 101}, k1: [20, 30, 40], k2: 1.0e4, gamma3: 1.0e-4}"
    state = state_from_config_text(f"task: phase_diagram\nparameters: {plane}\n")
    assert (state.rod["F"], state.rod["k1"], state.F_max) == ("15", "30", "100")
    state.rod_or_arm()


@pytest.mark.parametrize("text", ["", "- 1", "task: spectrum", "task: [", "parameters: {F: 3}"])
def test_text_that_is_no_config_is_refused_in_a_sentence(text):
    with pytest.raises(InputError):
        state_from_config_text(text)


def test_a_config_of_an_arm_that_varies_along_its_length_is_refused():
    profile = "material: {profile: {u: [0, 1], k1: [1, 2], k2: [1, 2], k3: [1, 2], gamma3: [1, 1]}}"
    with pytest.raises(InputError, match="profile"):
        state_from_config_text(
            f"task: spectrum\nparameters: {{F: 3, k1: 1e4, k2: 1e4, gamma3: 0.1}}\n{profile}"
        )


@pytest.mark.parametrize(
    ("task", "load", "given"),
    [
        ("thresholds", "", "k2: 20"),
        ("limit_cycle", ", pressure: 2 kPa", "gamma1: 2"),
        ("spectrum", "", "F: 3"),
    ],
)
def test_a_config_of_an_arm_with_parameters_of_its_own_is_refused(task, load, given):
    arm = f"{{length: 10 cm, radius: 4 mm, young: 100 kPa, viscosity: 30 Pa s{load}}}"
    text = f"task: {task}\nparameters: {{arm: {arm}%s}}\n"
    if task != "spectrum":
        assert state_from_config_text(text % "").tab == "arm"
    with pytest.raises(InputError, match=f"with {given.partition(':')[0]} of its own"):
        state_from_config_text(text % f", {given}")


def test_a_branch_along_another_parameter_opens_with_the_middle_of_its_range():
    text = (
        "task: branch\nparameters: {F: 60, k2: 1e4, gamma3: 1e-4}\nbranch: {along: k1, start: 100, stop: 300}"
    )
    state = state_from_config_text(text)
    assert (state.rod["k1"], state.rod["F"]) == ("200", "60")


@pytest.mark.parametrize("tab", ["rod", "arm"])
def test_the_python_lines_make_the_subject_of_the_state(tab):
    state = PageState(tab=tab, rod=OTHER, law="fixed")
    line = next(line for line in state.python().splitlines() if line.startswith(tab))
    assert eval(line.partition(" = ")[2], {"rs": rs, "inf": float("inf")}) == state.rod_or_arm()


@pytest.mark.parametrize(
    ("name", "text"),
    [("F", "abc"), ("k1", "-5"), ("gamma3", "nan"), ("k2", ""), ("taper", "0"), ("F", "1e5")],
)
def test_a_bad_value_has_the_sentence_of_the_command_line(name, text):
    state = PageState().with_values(**{name: text})
    with pytest.raises(InputError) as refusal:
        state.rod_or_arm()
    assert name in str(refusal.value)
    with pytest.raises(InputError) as same:
        rs.Rod(**state.parameters())
    assert str(refusal.value) == str(same.value)


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("F", "abc"), ("F", "1e5"), ("F", "nan"), ("F", "1e400"), ("k1", "-1"), ("k1", "0"), ("k1", "40"),
        ("k2", "1,5"), ("k2", "<b>x</b>"), ("k2", "NaN"), ("gamma3", "-0.1"), ("gamma3", "inf"),
        ("gamma1", "0"), ("taper", "0"), ("taper", "1e9"),
    ],
)  # fmt: skip
def test_the_page_and_the_command_refuse_with_one_sentence(command, name, text):
    command.write("rod.yaml", "task: limit_cycle\nparameters: {F: 50, k1: 1.0e4, k2: 100, gamma3: 0.01}\n")
    done = command("check", "rod.yaml", "--set", f"parameters.{name}={text}")
    assert done.returncode == 2
    with pytest.raises(InputError) as refusal:
        PageState().with_values(**{name: text}).rod_or_arm()
    sentence = str(refusal.value).partition(": ")[2] or str(refusal.value)
    assert done.stderr.rstrip().endswith(sentence)


@pytest.mark.parametrize("F_max", ["0", "-3", "inf", "nan", "x", ""])
def test_a_largest_force_that_is_no_finite_number_above_0_is_refused(F_max):
    with pytest.raises(InputError, match="F_max"):
        replace(PageState(), F_max=F_max).largest_force()
