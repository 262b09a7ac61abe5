"""Arguments of Python calls that are refused in one sentence."""

import pytest

import rodsweep as rs

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
