"""Answers in Python: lists hold what was found and nothing else, words are words, and all of it prints."""

import re

import numpy as np
import pandas as pd
import pytest

import rodsweep as rs
from rodsweep.api.keyword_arguments import config_tree, job_of_tree
from rodsweep.api.task_results import DatasetResult
from rodsweep.config.tasks import CONFIG_CLASSES_BY_TASK
from rodsweep.post.tables.table_names import TABLE_NAMES

ROD = {"F": 50, "k1": 1e4, "k2": 1e2, "gamma3": 1e-2}
FOLDED = {"k1": 150, "k2": 1e4, "gamma3": 1e-4}
"""Its branch leads from a Hopf point through a fold to another."""
FILLER = re.compile(r"\bnan\b|<NA>|(?<![\w.])-1(?![\w.])|\.\.\.|\bNone\b")
"""What no text of an answer has."""


@pytest.fixture(scope="module")
def branch():
    return rs.Rod(**FOLDED).branch(stop=100, accuracy=1e-4)


@pytest.mark.parametrize("modes", [1, 4, 5, 12])
def test_all_modes_that_are_asked_for_are_given_and_printed(modes):
    answer = rs.Rod(**ROD).spectrum(modes=modes)
    assert len(answer.modes) == len(answer.growth_rate) == len(answer.eigenvalues) == modes
    assert answer.modes.index.tolist() == answer.mode.tolist() == list(range(1, modes + 1))
    assert np.array_equal(answer.eigenvalues, answer.growth_rate + 1j * answer.frequency)
    lines = repr(answer.table()).splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith(f"modes: {modes}"))
    start = next(i for i in range(start, len(lines)) if lines[i].startswith("mode "))
    assert [line.split()[0] for line in lines[start + 2 : start + 2 + modes]] == [
        str(i) for i in range(1, modes + 1)
    ]
    assert answer.table()._repr_html_().count("<tr>") == 1 + 4 + 2 + modes


def test_crossings_are_those_that_were_found():
    rod = rs.Rod(**ROD)
    answer = rod.thresholds()
    assert answer.crossing_count == len(answer.crossings) == len(answer.crossing_F) == 4
    assert answer.crossings.crossing_kind.tolist() == ["onset", "hopf", "hopf", "hopf"]
    assert answer.crossing_kind.tolist() == ["onset", "hopf", "hopf", "hopf"]
    assert answer.crossings.crossing_F[2] == answer.F_hopf  # the second, by its number
    assert answer.data.sizes["crossing"] == 16
    full = rod.thresholds(crossings=2)
    assert (full.status, len(full.crossings), full.crossing_count) == ("list_full", 2, 4)
    assert "crossings: 2 of 4, " in repr(full.table())
    none = rod.thresholds(F_max=10)
    assert (none.status, len(none.crossings), none.crossing_F.shape) == ("ok", 0, (0,))
    assert repr(none).startswith("no threshold up to F = 10 k3/L^2\n")
    assert "crossings: none" in repr(none.table())
    assert "none: F_onset, onset_growth_rate, F_hopf, " in repr(none.table())


def test_a_branch_tells_its_special_points_in_words(branch):
    assert branch.special_points.special_kind.tolist() == ["hopf", "fold", "hopf"]
    assert branch.special_kind.tolist() == ["hopf", "fold", "hopf"]
    assert branch.special_points.special_reason.isna().all()
    assert branch.special_points.special_unstable_after.tolist() == [2, pd.NA, 0]
    assert np.array_equal(branch.special_unstable_after, [2, np.nan, 0], equal_nan=True)
    assert len(branch.cycles) == len(branch.branch_F) == branch.point_count
    known = branch.cycles.drop(columns="unstable_multipliers")  # undecided where one is on the circle
    assert known.notna().all(axis=None)
    for word in ("hopf", "fold", "special_points: 3", f"cycles: {branch.point_count} rows"):
        assert word in repr(branch.table())
    largest_y = branch.tip_y_max.max()
    cycles_clause = f"{branch.point_count} cycles, largest tip y {largest_y:.5g} L"
    headline = f"1 branch of cycles from 2 Hopf points: {cycles_clause}"
    assert repr(branch).startswith(headline)


def test_a_branch_is_one_table_of_cycles_with_special_points_marked(branch):
    table = branch.branches
    marked = table[table.special_kind.notna()]
    assert len(table) == len(branch.cycles) + 3
    assert marked.special_kind.tolist() == ["hopf", "fold", "hopf"]
    assert marked.branch_F.tolist() == branch.special_at.tolist()
    assert marked.period.tolist() == branch.special_period.tolist()
    assert table.branch_point.dropna().tolist() == list(range(1, branch.point_count + 1))
    assert [marked.index[0], marked.index[-1]] == [0, len(table) - 1]
    fold = marked.index[1]
    assert table.branch_point[fold - 1] == branch.special_point[1]  # counted from 1, as everything
    assert table.branch_F[:fold].is_monotonic_increasing
    assert table.branch_F.max() == table.branch_F[fold]


def test_statuses_and_other_words_are_words():
    rod = rs.Rod(**ROD)
    answer = rod.spectrum()
    assert (answer.status, str(answer.status), answer.status.name) == ("ok", "ok", "ok")
    assert "not_certified" in list(type(answer.status))
    assert answer.certified is True
    assert rod.replace(F=20).cycle(accuracy=1e-3).second_state == "none_known"
    born = rs.Rod(k1=200, k2=1e4, gamma3=1e-4).criticality(F_max=180)
    assert born.criticality.tolist() == ["supercritical", "subcritical"]
    assert born.crossing_kind.tolist() == ["hopf", "restabilization"]


def test_what_a_rod_has_not_is_nan_or_none_and_not_printed():
    rod = rs.Rod(**ROD).replace(F=5)
    answer = rod.cycle(accuracy=1e-3)
    assert answer.status == "straight"
    assert np.isnan(answer.period)
    assert (len(answer.multipliers), len(answer.harmonics), answer.harmonic_amplitude.shape) == (0, 0, (0,))
    table = answer.table()
    for told in (repr(answer), answer._repr_html_(), repr(table), table._repr_html_()):
        assert "nan" not in told
        assert answer.sentence in " ".join(told.split())
        assert "linear_growth_rate" in told
        assert "tip_y_max" not in told


def test_a_count_that_is_not_known_is_none_and_named_below():
    whole = rs.Rod(**ROD).spectrum().whole.copy(deep=True)
    whole["unstable_count"][...] = -1
    answer = rs.Answer("rod", DatasetResult(whole), "")
    assert answer.unstable_count is None
    assert repr(answer).startswith("number of unstable modes not known: ")
    assert repr(answer.table()).endswith("\n\nnone: unstable_count")


def test_an_unknown_attribute_is_told_with_those_that_there_are():
    answer = rs.Rod(**ROD).spectrum()
    with pytest.raises(
        AttributeError, match="no 'growth'; it has growth_rate, frequency, .*modes, eigenvalues"
    ):
        _ = answer.growth
    assert {"modes", "eigenvalues", "growth_rate", "mode"} <= set(dir(answer))


def test_an_answer_prints_its_numbers_with_their_units():
    answer = rs.Rod(**ROD).thresholds(crossings=2)
    text, html = repr(answer.table()), answer.table()._repr_html_()
    assert text.splitlines()[1].startswith("Rod(F=50, k1=10000, k2=100, gamma3=0.01, gamma1=1), thresholds: ")
    for part in ("F_hopf", "27.427194", "k3/L^2", "smallest F at which a pair becomes unstable", "onset"):
        assert part in " ".join(text.split())
        assert part in html
    told = [line.split()[0] for line in text.split("\n\n")[1].splitlines()[1:] if line[0] != " "]
    assert told == [name for name in answer.data if name in told]  # in the order of the file
    assert set(told) & {"F_restabilization", "open_from", "status", "seconds"} == set()


def test_no_variable_hides_behind_an_attribute_of_answers():
    for task, config in CONFIG_CLASSES_BY_TASK.items():
        if config.needs_several_rods:
            continue
        tree = config_tree(task, {name: ROD[name] for name in config.rod_parameters_used({}) if name in ROD})
        layout = job_of_tree(tree).layout
        names = {variable.name for variable in layout.variables}
        assert names & set(dir(rs.Answer)) == {"status"}
        assert not (names | set(layout.extents)) & {*TABLE_NAMES.values(), "eigenvalues", "branches"}


@pytest.mark.parametrize(
    ("task", "asked"),
    [
        ("spectrum", {"modes": 3, "vectors": True, "nodes": 5}),
        ("thresholds", {"F_max": 60}),
        ("modes", {"nodes": 5}),
        ("limit_cycle", {"accuracy": 1e-3, "samples": 4, "shapes": 2, "nodes": 5, "transient": 9}),
        ("criticality", {"F_max": 40}),
        ("branch", {"stop": 32, "accuracy": 1e-3}),
    ],
)
def test_no_answer_has_filler(task, asked):
    for F in (20, 50):
        rod = rs.Rod(**ROD | {"F": F})
        answer = getattr(rod, task)(**asked)
        whole = answer.table()
        for text in (repr(answer), answer._repr_html_(), repr(whole), whole._repr_html_()):
            assert not FILLER.search(re.sub(r"<[^>]*>", " ", text)), text
        for name in answer.lists:
            if name == "branches":
                continue
            frame = getattr(answer, name)
            for column, values in frame.items():
                assert not values.isna().all() or not len(frame) or "special" in column, (name, column)
            if len(frame):
                assert frame.notna().any(axis=1).all()


def test_variables_have_the_same_order_in_a_file_and_in_python(command, monkeypatch):
    monkeypatch.chdir(command.directory)
    command.write("p.csv", "gamma3,k1,k2\n0.01,1600,480\n0.02,inf,480\n")
    here = rs.sweep("thresholds", points="p.csv", F_max=60, crossings=3)
    command.write("c.yaml", here.attrs["config"])
    assert command("run", "c.yaml").returncode == 0
    file = rs.open("c.h5")
    assert list(file.variables) == list(here.variables)
    assert list(file.data_vars)[:2] == ["F_onset", "onset_growth_rate"]
    assert here.point.values.tolist() == file.point.values.tolist() == [1, 2]
    here.to_netcdf("c.nc")
    assert list(rs.open("c.nc").variables) == list(here.variables)


def test_table_of_a_sweep_is_that_of_the_file(command, monkeypatch):
    data = rs.sweep("thresholds", k1=[200, 1e4], k2=1e4, gamma3=1e-4, F_max=60, crossings=4)
    monkeypatch.chdir(command.directory)
    command.write("c.yaml", data.attrs["config"])
    assert command("run", "c.yaml").returncode == 0
    assert command("export", "c.h5", "--table", "crossings").returncode == 0
    here, file = rs.table(data, "crossings"), rs.table("c.h5", "crossings")
    pd.testing.assert_frame_equal(here, file)
    read = pd.read_csv("c.csv", float_precision="round_trip")
    assert list(read) == list(here)
    exact = [name for name in here if "error" not in name]
    pd.testing.assert_frame_equal(read[exact], here[exact], check_dtype=False, check_exact=True)
    assert here.attrs["units"]["crossing_F"] == "k3/L^2"
    assert here.attrs["meanings"]["crossing_kind"] == "kind of the crossing"
    assert rs.table(data, columns=["k1", "F_hopf"]).shape == (2, 2)
    assert set(rs.table(data, columns=["F_hopf", "crossing_F"]).F_hopf) == set(data.F_hopf.values.ravel())


@pytest.mark.parametrize(
    ("asked", "sentence"),
    [
        ({"name": "crossing"}, "has no table 'crossing'; did you mean crossings?"),
        ({"name": 3}, "name = 3 is not the name of a table"),
        ({"columns": ["F_hop"]}, "its tables have no column 'F_hop'; did you mean F_hopf?"),
        ({"name": "points", "columns": ["crossing_F"]}, "the table points has no column 'crossing_F'; "),
        ({"columns": ["F_hopf", "F_hopf"]}, "the column F_hopf is named twice"),
        ({"columns": 3}, "columns = 3 is not a list of names"),
        ({"column": "F"}, "unknown key column; did you mean columns?"),
    ],
)
def test_a_table_or_column_that_there_is_not_is_refused(asked, sentence):
    data = rs.sweep("thresholds", k1=200, k2=1e4, gamma3=1e-4, F_max=60)
    with pytest.raises(rs.InputError) as refusal:
        rs.table(data, **asked)
    assert sentence in str(refusal.value)
    with pytest.raises(rs.InputError, match="3 is not a result; give a Dataset, an answer or a file"):
        rs.table(3)


def test_points_of_warnings_are_counted_from_1(monkeypatch):
    def broken(*_):
        raise ZeroDivisionError

    monkeypatch.setattr("rodsweep.solve.changes.thresholds.solve_thresholds", broken)
    monkeypatch.setattr("rodsweep.solve.changes.thresholds.warm_up", lambda: None)
    with pytest.warns(RuntimeWarning) as noted:
        rs.sweep("thresholds", k1=[200, 300], k2=1e4, gamma3=1e-4)
    firsts = [str(warning.message).split(":")[0] for warning in noted]
    assert firsts == ["point 1", "point 2"]
