"""Arguments of Python calls that are refused in one sentence."""

import re
from dataclasses import fields

import numpy as np
import pytest

import rodsweep as rs
from rodsweep.api.argument_hints import UNKNOWN_ARM_ARGUMENT_HINTS, UNKNOWN_ROD_ARGUMENT_HINTS
from rodsweep.explore.page_state import PageState
from rodsweep.model.parameters import PARAMETERS

ROD = {"k1": 200, "k2": 1e4, "gamma3": 1e-4}
ARM = {"length": "14 cm", "radius": "4 mm", "young": "100 kPa", "viscosity": "20 Pa s"}


@pytest.fixture(scope="module")
def line():
    return rs.sweep("spectrum", F=[1, 2], **ROD)


@pytest.mark.parametrize(
    "given, sentence",
    [
        ({**ROD, "parameters": ROD}, "k1 is given twice, as an argument and in a mapping; give it once"),
        ({**ROD, "thresholds": {"F_max": 100}, "F_max": 50}, "F_max is given twice, "),
        ({**ROD, "strict": "yes"}, "strict = 'yes' is not allowed; it should be True or False"),
        ({**ROD, "ranks": 10**6}, "ranks = 1000000 is not allowed for 1 point; ranks would be idle; "),
    ],
)
def test_a_sweep_refuses(given, sentence):
    with pytest.raises(rs.InputError) as refused:
        rs.sweep("thresholds", **given)
    assert str(refused.value).startswith(sentence)


def test_two_drags_of_one_name_are_refused():
    with pytest.raises(rs.InputError, match="names a drag twice; list each name once"):
        rs.sweep("thresholds", arm=ARM | {"drag": ["most", "most"]})


@pytest.mark.parametrize("title", ["Hello", 5, [1]])
def test_the_title_of_a_figure_is_that_of_the_config(line, title):
    with pytest.raises(rs.InputError, match="it should be True, to draw the title of the config, or False"):
        rs.plot(line, title=title)


def test_figures_of_different_tasks_share_no_figure(line):
    thresholds = rs.sweep("thresholds", k1=[200, 300], k2=1e4, gamma3=1e-4)
    for pair in ([line, thresholds], [thresholds, line]):
        with pytest.raises(rs.InputError, match="is of the task (spectrum|thresholds)"):
            rs.plot(pair)


@pytest.mark.parametrize(
    "call",
    [
        lambda line: rs.Arm(**ARM).report(5),
        lambda line: rs.Arm(**ARM).report(x=1),
        lambda line: rs.Rod(F=3, **ROD).spectrum().table(5),
        lambda line: rs.plot(line).save(),
        lambda line: rs.plot(line).save("x.png", dpi=30),
        lambda line: rs.plot(line).figure(1),
    ],
)
def test_methods_refuse_surplus_and_missing_arguments(line, call):
    with pytest.raises(rs.InputError):
        call(line)


@pytest.mark.parametrize(
    ("name", "value", "advice"),
    [
        ("load_kind", "weight", "the load is given as pressure or force"),
        ("load_kind", None, "the load is given as pressure or force"),
        ("taper", 0.5, "a cone has tip_radius"),
        ("profile", "a.csv", "an arm of several materials has segments"),
        ("F", 3.0, "the load of an arm is pressure or force"),
        ("k1", 3.0, r"k1 follows from the quantities of the arm; rs.Rod\(arm=arm, k1=...\)"),
        ("accuracy", 1e-6, r"accuracy is an option of tasks, as in arm.spectrum\(accuracy=...\)"),
        ("lenght", "5 cm", "did you mean length"),
    ],
)
def test_what_an_arm_does_not_have_is_refused_with_what_to_write(name, value, advice):
    arm = {"length": "10 cm", "radius": "5 mm", "young": "100 kPa", "viscosity": "40 Pa s"}
    with pytest.raises(rs.InputError, match=f"^unknown key {name}; {advice}"):
        rs.Arm(**arm | {name: value})


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("k3", "k3 is the unit of stiffness"),
        ("gamma2", "gamma2 is the unit of drag"),
        ("young", r"young belongs to an arm: rs.Rod\(arm=rs.Arm\(young=..., ...\)\)"),
        ("segments", "segments belongs to an arm"),
        ("F_max", r"F_max is an option of tasks, as in rod.thresholds\(F_max=...\)"),
        ("lwa", "did you mean law"),
        ("secton", "did you mean section"),
    ],
)
def test_what_a_rod_does_not_have_is_refused_with_what_to_write(name, advice):
    with pytest.raises(rs.InputError, match=f"^a rod has no parameter {name}; {advice}"):
        rs.Rod(k1=1e4, k2=1e4, gamma3=1e-4, **{name: 1.0})


@pytest.mark.parametrize("word", sorted({*UNKNOWN_ARM_ARGUMENT_HINTS, *UNKNOWN_ROD_ARGUMENT_HINTS}))
def test_advice_is_for_what_is_no_argument(word):
    known = (
        {field.name for field in fields(rs.Arm)} if word in UNKNOWN_ARM_ARGUMENT_HINTS else set(PARAMETERS)
    )
    assert word not in known


@pytest.mark.parametrize("along", ["pressure", "length", "k1", "fo", ["F"], None])
def test_advice_on_the_parameter_of_an_arms_branches_works(along):
    """A load was asked for first; with a load, the same parameter was refused again."""
    with pytest.raises(rs.InputError) as refused:
        rs.Arm(**ARM).branch(along=along)
    sentence = str(refused.value)
    if along == "k1":
        assert sentence.startswith("branch.along: k1 is not allowed with parameters.arm, which gives k1; ")
        assert rs.Arm(**ARM).branch(along="F", stop=30).status == "ok"
        return
    assert sentence == (
        f"branch.along = {along!r} is not allowed for an arm; leave along out, and the branches follow the "
        "load of the arm, as F, from start to stop"
    )
    assert rs.Arm(**ARM).branch(start=0, stop=30).status == "ok"


NUMBERS = {"nines": "9" * 5000, "negative": "-" + "9" * 400, "integer": 10**5000, "power": -(10**400)}


@pytest.mark.parametrize("number", NUMBERS.values(), ids=NUMBERS)
def test_a_number_too_large_for_a_float_is_refused_in_one_short_sentence(number):
    """The page said "F = inf", and an integer of thousands of digits ended with a traceback."""
    state = PageState().with_values(F=number if isinstance(number, str) else "1e400")
    calls = [
        lambda: rs.Rod(F=number, **ROD),
        lambda: rs.Arm(**ARM | {"length": number}),
        lambda: rs.sweep("spectrum", F=[1, number], **ROD),
        state.rod_or_arm,
    ]
    sentences = []
    for call in calls:
        with pytest.raises(rs.InputError) as refused:
            call()
        sentences.append(str(refused.value))
        assert len(sentences[-1]) < 200 and "\n" not in sentences[-1] and "inf" not in sentences[-1]
    assert sentences[-1].startswith("parameters.F: ")
    assert sentences[-1].endswith(" is too large for a floating-point number")


HUGE = 10**5000
"""An integer whose digits Python refuses to print."""
PAIR = np.array([1, 2])
"""An array, whose comparison with a text is no single truth value."""


@pytest.mark.parametrize("value", [HUGE, [HUGE], {"a": HUGE}, PAIR], ids=["int", "list", "dict", "array"])
@pytest.mark.parametrize(
    ("name", "call"),
    [
        ("drag", lambda value, line: rs.Arm(**ARM, drag=value)),
        ("law", lambda value, line: rs.Arm(**ARM, law=value)),
        ("section", lambda value, line: rs.Arm(**ARM, section=value)),
        ("segments", lambda value, line: rs.Arm(young="1 kPa", viscosity="1 Pa s", segments=[value])),
        ("branch.along", lambda value, line: rs.Rod(**ROD).branch(along=value)),
        ("branch.along", lambda value, line: rs.Arm(**ARM).branch(along=value)),
        ("ranks", lambda value, line: rs.sweep("spectrum", F=1, **ROD, ranks=value)),
        ("strict", lambda value, line: rs.sweep("spectrum", F=1, **ROD, strict=value)),
        ("roots", lambda value, line: rs.plot(line, roots=value)),
        ("what", lambda value, line: rs.plot(line, what=value)),
        ("width", lambda value, line: rs.plot(line, width=value)),
        ("at", lambda value, line: rs.plot(line, at={"k1": value})),
    ],
)
def test_values_of_any_type_are_refused_with_the_name_of_the_argument(line, name, call, value):
    with pytest.raises(rs.InputError, match=rf"^{re.escape(name)}\b") as refused:
        call(value, line)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("name", ["\ud800", "9" * 300, "\0", ""], ids=["surrogate", "long", "nul", "empty"])
@pytest.mark.parametrize(
    "call",
    [
        lambda name, line: rs.open(name),
        lambda name, line: rs.table(name),
        lambda name, line: rs.plot(name),
        lambda name, line: rs.plot(line, f"{name}.png" if name else name),
        lambda name, line: rs.plot(line).save(f"{name}.png" if name else name),
    ],
    ids=["open", "table", "plot", "output", "save"],
)
def test_a_text_that_is_no_name_of_a_file_is_refused(line, call, name):
    with pytest.raises(rs.InputError, match="is not the name of a file"):
        call(name, line)


@pytest.mark.parametrize("points", [HUGE, [HUGE], 0, True, [1.0], "1"], ids=list("abcdef"))
def test_points_of_a_figure_are_whole_numbers_from_1(line, points):
    with pytest.raises(rs.InputError, match="^points = .* is not allowed; give whole numbers, from 1$"):
        rs.plot(line, points=points)


def test_points_of_a_figure_may_be_an_array(line):
    with pytest.raises(rs.InputError, match="points is for results of limit_cycle"):
        rs.plot(line, points=PAIR)


@pytest.mark.parametrize(
    "call",
    [
        lambda line: rs.open("a\n\x1b[31mb.h5"),
        lambda line: rs.plot("a\n\x1b[31mb.h5"),
        lambda line: rs.plot(line).save("a\n\x1b[31mb/x.png"),
        lambda line: rs.sweep("spectrum", points="a\n\x1b[31mb.csv"),
    ],
    ids=["open", "plot", "save", "points"],
)
def test_names_of_files_are_shown_on_one_line_without_control_characters(line, call):
    with pytest.raises((rs.InputError, rs.EnvironmentIncomplete), match=r"a\\n\\x1b\[31mb") as refused:
        call(line)
    assert str(refused.value).isprintable()


@pytest.fixture(scope="module")
def cycles():
    return rs.sweep("limit_cycle", F=[1, 2], **ROD, accuracy=1e-3)


DIAGRAM = {"F": rs.linspace(1, 50, 5), "k1": [100, 200], "k2": 1e4, "gamma3": 1e-4}


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (
            lambda line, cycles: rs.table(line, "crossings"),
            "spectrum has no table 'crossings'; there are points, ",
        ),
        (lambda line, cycles: rs.table(line, 5), "name = 5 is not the name of a table; write it as in "),
        (
            lambda line, cycles: rs.table(line, columns=5),
            "columns = 5 is not a list of names, such as ['F', ",
        ),
        (lambda line, cycles: rs.table(line, columns=["k9"]), "spectrum: its tables have no column 'k9'; "),
        (
            lambda line, cycles: rs.table(cycles, columns=["harmonic_amplitude", "multiplier_real"]),
            "harmonic_amplitude and multiplier_real are in two tables, harmonics and multipliers; ",
        ),
        (
            lambda line, cycles: rs.plot(line, at={"F": 3}),
            'at={"F": 3}: spectrum has no point there; it has F = ',
        ),
        (
            lambda line, cycles: rs.plot(line, at={"k7": 3}),
            'at={"k7": 3}: spectrum has no such axis; the points ',
        ),
        (
            lambda line, cycles: rs.plot(line, at={"F": "x"}),
            'at={"F": "x"} must be a parameter with a number, ',
        ),
        (
            lambda line, cycles: rs.plot(line, width="1 mm"),
            "width = '1 mm' is not allowed; choose single, double, ",
        ),
        (
            lambda line, cycles: rs.plot(line, style="no"),
            "no is neither a style of matplotlib nor a style file",
        ),
        (
            lambda line, cycles: rs.plot(cycles, roots="all"),
            "limit_cycle: roots is for results of spectrum, and ",
        ),
        (lambda line, cycles: rs.plot([line] * 30), "30 files are given, "),
        (
            lambda line, cycles: rs.plot([cycles, cycles], what="energy"),
            'what="energy" draws a single file; only ',
        ),
        (
            lambda line, cycles: rs.plot(cycles, what="animation", width="single"),
            "width is for printed figures, ",
        ),
        (
            lambda line, cycles: rs.sweep(
                "phase_diagram", **DIAGRAM, criticality=True, bautin_along={"k2": [1, 2], "gamma3": [1, 2]}
            ),
            "phase_diagram: bautin_along has 2 parameters; give one, with at least two values",
        ),
        (
            lambda line, cycles: rs.sweep("spectrum", arm=ARM | {"poisson": [0.3, 0.5], "pressure": 1}, k2=1),
            "parameters.arm.poisson has several values but changes only k2, and parameters.k2 is given too; ",
        ),
        (
            lambda line, cycles: rs.Arm(**ARM | {"length": "3 cm 4 mm"}),
            "length = '3 cm 4 mm' has the unit 'cm 4 mm', which is not understood; ",
        ),
        (
            lambda line, cycles: rs.Rod(k1=float("inf"), k2=1, gamma3=1, F=1).spectrum(longitudinal=True),
            "spectrum.longitudinal: true needs finite parameters.k1, because a rod with k1 = inf cannot ",
        ),
    ],
)
def test_what_cannot_be_done_is_refused_in_one_sentence(line, cycles, call, sentence):
    with pytest.raises(rs.InputError) as refused:
        call(line, cycles)
    assert str(refused.value).startswith(sentence)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda answer: answer.nothing, "this answer has no 'nothing'; it has growth_rate, frequency, "),
        (
            lambda answer: rs.Rod(F=1, **ROD).F,
            "a rod has no attribute 'F'; rod.parameters['F'] is its value, and ",
        ),
        (
            lambda answer: rs.Rod(F=1, **ROD).nothing,
            "a rod has no 'nothing'; its tasks are spectrum, thresholds, ",
        ),
    ],
)
def test_an_attribute_that_is_not_there_is_named_with_those_that_are(call, sentence):
    with pytest.raises(AttributeError) as refused:
        call(rs.Rod(F=1, **ROD).spectrum())
    assert str(refused.value).startswith(sentence)
