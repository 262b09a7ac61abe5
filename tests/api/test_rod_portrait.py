"""`rod.portrait()` and `rodsweep portrait`: the numbers are the solver's, and what is missing is said."""

import re
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.text import Text
from pages import read_page
from surveyed import few

import rodsweep as rs
from rodsweep.post.rod_portrait.paragraph import paragraph
from rodsweep.post.rod_portrait.portrait_drawing import draw_rod_portrait
from rodsweep.results.layouts.si_variables import NEGLECTED_EFFECTS, VALIDITY_VARIABLES
from rodsweep.tasks import rod_portrait
from rodsweep.tasks.rod_portrait import forces_of_three_stable_cycles

FOLDED = rs.Rod(k1=200, k2=1e4, gamma3=1e-4)
"""Its branch of cycles passes a fold, beyond which straight rod and cycle are both stable."""
ACCURACY = 1e-4
UNDECIDED = ("unstable_multipliers", "special_unstable_after", "unstable_at_start")
"""Variables of a branch that decide what is stable."""


@pytest.fixture(scope="module")
def portrait():
    return FOLDED.portrait(accuracy=ACCURACY)


def numbers(text, before):
    """Numbers that follow the words `before` in a text."""
    return [float(found) for found in re.findall(rf"{re.escape(before)}([\d.]+\d)", text)]


@pytest.mark.long
def test_thresholds_and_criticality_are_those_of_their_tasks(portrait):
    crossings = FOLDED.thresholds().crossings
    (onset, hopf, again) = crossings["crossing_F"]
    text = portrait.paragraph
    assert numbers(text, "start to oscillate at F = ") == [pytest.approx(onset, rel=1e-5)]
    assert numbers(text, "becomes unstable at F = ") == [pytest.approx(hopf, rel=1e-5)]
    assert numbers(text, "stable again from F = ") == [pytest.approx(again, rel=1e-5)]
    assert numbers(text, "(frequency ") == pytest.approx(
        crossings["crossing_frequency"][1:].tolist(), rel=1e-5
    )
    assert portrait.thresholds.crossings.equals(crossings)
    sides = FOLDED.criticality().crossings["criticality"].tolist()
    assert re.findall(r"(supercritical|subcritical)", text) == sides == ["supercritical", "subcritical"]


SCALES = {"force_scale": 0.012, "pressure_scale": 155.0, "tau2": 3.5, "length": 0.1}
"""Units of an arm with the rod `FOLDED`, in SI units."""


@pytest.fixture(scope="module")
def of_arm(portrait):
    """The results as those of an arm whose length is typed in cm."""
    view = portrait.results.views["thresholds"]
    validity = {
        "model_applies": np.zeros(1),
        "neglected_effect": np.zeros(1),
        "neglected_excess": np.zeros(1),
    }
    quantities = {name: np.array(value) for name, value in SCALES.items()}
    as_arm = replace(
        view,
        variables={**view.variables, **validity, **quantities},
        typed_units={"length": "cm", "young": "kPa"},
    )
    rod = replace(portrait.results.rod, arm={"length": "10 cm"})
    return replace(portrait.results, rod=rod, views={**portrait.results.views, "thresholds": as_arm})


def test_the_paragraph_of_an_arm_is_in_si_units(portrait, of_arm):
    text = paragraph(of_arm)
    assert "tau2 for 3.5 s. The model applies at flutter. In the straight state" in text
    again, fold = portrait.thresholds.F_restabilization, portrait.branch.special_points["special_at"].max()
    found = re.search(r"beside the stable straight arm at a pressure of ([\d.]+) to ([\d.]+\d) kPa", text)
    assert [float(end) for end in found.groups()] == pytest.approx([0.155 * again, 0.155 * fold], rel=1e-8)
    frequency = portrait.thresholds.crossings["crossing_frequency"].iloc[1:]
    assert numbers(text, "(frequency ") == pytest.approx((frequency / (2 * np.pi * 3.5)).tolist(), rel=1e-5)
    cycle = list(portrait.cycles.values())[0]
    assert numbers(text, "the period is ")[0] == pytest.approx(3.5 * cycle.period, rel=1e-3)
    assert numbers(text, "largest y of the tip ")[0] == pytest.approx(10 * cycle.tip_y_max, rel=1e-3)
    assert "F = " not in text.replace("F = 1 stands for", "")


def test_the_paragraph_of_an_arm_judges_each_cycle_at_its_own_load(of_arm):
    """The model may apply at flutter and not at a cycle far above flutter."""
    effect = NEGLECTED_EFFECTS.index("Reynolds_number")
    verdicts = [(0, -1, 0.05), (1, effect, 0.4), (2, effect, 1.4)]
    names = [variable.name for variable in VALIDITY_VARIABLES]

    def judged(view, verdict):
        one = {
            name: np.full(view.variables["status"].shape, x) for name, x in zip(names, verdict, strict=True)
        }
        return replace(view, variables={**view.variables, **one})

    cycles = [(F, judged(view, each)) for (F, view), each in zip(of_arm.cycles, verdicts, strict=True)]
    worst = judged(of_arm.views["branch"], verdicts[-1])
    text = paragraph(replace(of_arm, cycles=cycles, views={**of_arm.views, "branch": worst}))
    outside = "the model does not apply: Reynolds number is 1.4 times its limit"
    assert f"The model applies at flutter. Somewhere on its branches of cycles {outside}. " in text
    first, second, third = text.partition("Cycles: ")[2].split("; ")
    assert "the model" not in first + second
    assert third.rstrip(".").endswith(f" cm ({outside})")


def test_the_picture_of_an_arm_is_drawn_in_si_units(portrait, of_arm):
    of_rod = portrait.figure().axes
    bar, upper, lower, *small = draw_rod_portrait(of_arm).axes
    assert (lower.get_xlabel(), upper.get_ylabel()) == ("pressure (kPa)", "largest $y$ of the tip (cm)")
    for axes, before, y in ((upper, of_rod[1], 10.0), (lower, of_rod[2], 3.5)):
        for line, own in zip(axes.lines, before.lines, strict=True):
            assert line.get_xdata() == pytest.approx(0.155 * np.asarray(own.get_xdata()))
            assert line.get_ydata() == pytest.approx(y * np.asarray(own.get_ydata()))
    (band,), (own,) = upper.patches, of_rod[1].patches
    assert (band.get_x(), band.get_width()) == pytest.approx((0.155 * own.get_x(), 0.155 * own.get_width()))
    assert lower.get_xlim() == pytest.approx(0.155 * np.array(of_rod[2].get_xlim()))
    assert small[-1].get_xlim()[1] > 10  # cm


def test_an_arm_that_bends_first_in_the_other_plane_is_warned():
    arm = rs.Arm(length="10 cm", width="8 mm", height="9 mm", young="100 kPa", viscosity="12 Pa s")
    portrait = arm.portrait(F_max=5)
    assert "the arm flutters first in the other plane, at a lower load" in portrait.paragraph
    assert "has no threshold up to a pressure of " in portrait.paragraph
    assert portrait.thresholds.pressure_end == pytest.approx(5 * arm.pressure_scale)
    with_force = arm.replace(force="1 mN").portrait(F_max=5)
    assert with_force.paragraph.startswith(
        "The arm with length 10 cm, width 8 mm, height 9 mm, young 100 kPa, viscosity 12 Pa s was searched "
        f"up to a force of {5 * arm.force_scale:.6g} N. "
    )


def test_ranges_with_two_states_are_those_of_the_branch(portrait):
    special = FOLDED.branch(accuracy=ACCURACY).special_points
    fold = float(special["special_at"][special["special_kind"] == "fold"].iloc[0])
    again = float(FOLDED.thresholds().F_restabilization)
    found = re.search(r"beside the stable straight rod at F = ([\d.]+) to ([\d.]+\d)", portrait.paragraph)
    assert [float(end) for end in found.groups()] == pytest.approx([again, fold], rel=1e-8)


def test_what_is_not_decided_is_not_denied(portrait):
    view = portrait.results.views["branch"]
    unknown = {name: np.full_like(view.variables[name], -1) for name in UNDECIDED}
    views = {**portrait.results.views, "branch": replace(view, variables={**view.variables, **unknown})}
    text = paragraph(replace(portrait.results, views=views))
    assert "Stable cycles: none is known." in text
    assert "It is not known whether a stable cycle exists beside the stable straight rod." in text


def test_branches_without_all_special_points_are_counted(portrait):
    view = portrait.results.views["branch"]
    more = {"special_count": view.variables["special_count"] + 1}
    views = {**portrait.results.views, "branch": replace(view, variables={**view.variables, **more})}
    text = paragraph(replace(portrait.results, views=views))
    assert "1 of its branches of cycles is not drawn: the list of special points" in text


def test_a_search_that_ended_early_is_not_said_to_end_where_the_rod_is_crushed(portrait):
    view = portrait.results.views["thresholds"]
    early = next(value for value, word in view.status_flags.items() if word == "ended_early")
    ended = {name: np.full_like(view.variables[name], x) for name, x in (("status", early), ("F_end", 60.0))}
    views = {**portrait.results.views, "thresholds": replace(view, variables={**view.variables, **ended})}
    text = paragraph(replace(portrait.results, views=views))
    assert "searched up to F = 60, not to F = 200: the search ended early" in text
    assert "crushed" not in text.split(".")[0]


def test_cycles_are_those_of_the_limit_cycle_task(portrait):
    assert len(portrait.cycles) == 3
    for F, cycle in portrait.cycles.items():
        alone = FOLDED.replace(F=F).cycle(start="hopf", accuracy=ACCURACY)
        assert cycle.status == "cycle"
        assert cycle.period == alone.period
        assert f"at F = {F:.6g} the period is " in portrait.paragraph
    periods = numbers(portrait.paragraph, "the period is ")
    assert periods == pytest.approx([cycle.period for cycle in portrait.cycles.values()], rel=1e-3)


def test_modes_are_drawn_at_the_thresholds(portrait):
    assert list(portrait.modes) == ["onset", "hopf"]
    w = portrait.modes["hopf"].eigenvalues[0]
    assert abs(w.real) < 1e-9 * abs(w.imag)
    assert abs(w.imag) == pytest.approx(334.321465738, rel=1e-9)


def test_the_picture_has_the_curves_of_the_branch(portrait):
    bar, upper, lower, *small = portrait.figure().axes
    assert len(small) == 5
    branch = portrait.branch.cycles
    drawn = np.concatenate([line.get_ydata() for line in upper.lines])
    for y in branch["tip_y_max"]:
        assert np.abs(drawn - y).min() < 1e-12
    styles = {line.get_linestyle() for line in upper.lines if len(line.get_xdata()) > 2}
    assert styles - {"None"} == {"-", "--"}  # stable up to the fold, unstable beyond
    stars = [line for line in lower.lines if line.get_marker() == "*"]
    assert stars[0].get_ydata() == pytest.approx([cycle.period for cycle in portrait.cycles.values()])


@pytest.mark.long
@pytest.mark.parametrize("suffix", few(["png", "html", "svg", "pdf"], 1))
def test_a_portrait_is_written_in_every_format(portrait, tmp_path, suffix):
    path = tmp_path / f"p.{suffix}"
    assert portrait.save(path).startswith(f"wrote {path}: ")
    assert path.stat().st_size > 10_000


@pytest.mark.long
def test_the_page_has_the_paragraph_and_the_numbers_of_the_solver(portrait, tmp_path):
    portrait.save(tmp_path / "p.html")
    page = read_page(tmp_path / "p.html")
    assert portrait.paragraph in page.texts("p")
    assert page.asked_for() == []
    forces = [float(row["special_at"]) for row in page.table("special points")]
    assert forces == portrait.branch.special_points["special_at"].tolist()
    hover = [lines for lines in page.values() if lines[0].startswith("cycle drawn below")]
    read = sorted(float(lines[-1].rpartition(" = ")[2]) for lines in hover)
    cycles = portrait.cycles.values()
    stored = sorted([*(c.tip_y_max for c in cycles), *(c.period for c in cycles)])
    assert read == pytest.approx(stored, rel=1e-7)


def test_a_notebook_shows_the_picture_and_a_terminal_the_paragraph(portrait):
    bundle = portrait._repr_mimebundle_()
    assert bundle["image/png"].startswith(b"\x89PNG")
    assert bundle["text/plain"] == repr(portrait)
    assert repr(portrait).split()[: len(portrait.paragraph.split())] == portrait.paragraph.split()
    assert max(map(len, repr(portrait).splitlines())) <= 80


def test_a_rod_that_never_beats_has_the_reasons_in_the_places_of_the_drawings():
    portrait = rs.Rod(k1=100, k2=1e4, gamma3=1e-4).portrait(accuracy=ACCURACY)
    assert "No branch of cycles begins at a Hopf point in this range." in portrait.paragraph
    end = portrait.thresholds.F_end
    assert end < 200
    assert f"gamma1 = 1 was searched up to F = {end:.6g}, not to F = 200:" in portrait.paragraph
    assert portrait.cycles == {}
    said = " ".join(
        " ".join(text.get_text().split()) for axes in portrait.figure().axes for text in axes.findobj(Text)
    )
    assert "No branch of cycles begins in this range." in said
    assert f"No cycle: {portrait.missing['limit_cycle']}." in said


def test_segments_of_rubber_have_cycles():
    profile = {"u": [0, 0.5, 0.5, 1], "k3": [1, 1, 0.8, 0.8]}
    rod = rs.Rod(k1=500, k2=1e4, gamma3=1e-4, law="neo_hookean", profile=profile)
    portrait = rod.portrait(F_max=50, accuracy=ACCURACY)
    assert portrait.branch is not None
    assert portrait.cycles
    assert not portrait.missing
    words = "The rod with k1 = 500, k2 = 10000, gamma3 = 0.0001, gamma1 = 1, law neo_hookean, a profile along"
    assert portrait.paragraph.startswith(f"{words} its length was searched up to F = 50. ")


def test_bad_choices_are_refused():
    with pytest.raises(rs.InputError, match=r"F_max = -3 is not allowed"):
        FOLDED.portrait(F_max=-3)
    with pytest.raises(rs.InputError, match="did you mean F_max"):
        FOLDED.portrait(F_mx=3)


def test_three_forces_are_spread_over_all_ranges():
    assert forces_of_three_stable_cycles([(10.0, 20.0), (50.0, 80.0)]) == [14.0, 60.0, 76.0]
    assert forces_of_three_stable_cycles([]) == []
    for force in forces_of_three_stable_cycles([(42.7219713, 42.7219719)]):
        assert 42.7219713 < force < 42.7219719


def test_branches_that_use_up_the_work_of_a_portrait_are_named(monkeypatch):
    monkeypatch.setattr(rod_portrait, "MAX_PORTRAIT_BRANCH_WORK", 0.2)
    found = rs.Rod(k1=1e4, k2=1e4, gamma3=1e-3).portrait(F_max=60)
    end = found.branch.special_points.iloc[-1]
    assert end["special_reason"] == "list_full"
    text = found.paragraph
    assert numbers(text, "1 of them is drawn only to F = ") == [pytest.approx(end["special_at"], rel=1e-3)]
    assert "solved to 1e-05" in text
