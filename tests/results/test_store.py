"""The result file and its journal: what is written is read back, whatever was killed in between."""

import os

import h5py
import numpy as np
import pytest

from rodsweep.api.dataset import open_result
from rodsweep.config.document.reading import resolved_config, validated_config
from rodsweep.errors import InputError
from rodsweep.results.file import points, replacement, validation
from rodsweep.results.file.combination.config_comparison import config_difference
from rodsweep.results.file.combination.merge import merge
from rodsweep.results.file.creation import FilePlan
from rodsweep.results.file.current_state import write_snapshot
from rodsweep.results.file.provenance import FAILURE_REASONS_ATTRIBUTE
from rodsweep.results.file.result_file_writer import ResultFileWriter
from rodsweep.results.file.seal import seal
from rodsweep.results.file.validation import read_header
from rodsweep.results.file.view import read_view
from rodsweep.results.layouts import layout_of
from rodsweep.results.run import journal as pages_of
from rodsweep.results.run.journal import Journal, journal_directory, read_failure_reasons, read_journals
from rodsweep.sweep.points.points import Points

CONFIG = resolved_config(
    validated_config(
        {
            "task": "spectrum",
            "parameters": dict.fromkeys(("F", "k1", "k2", "gamma3"), 1),
            "spectrum": {"modes": 2},
        }
    )
)
LAYOUT = layout_of(CONFIG)


def plan(is_grid=True, count=5, **config):
    columns = tuple(np.arange(1.0, n + 1) for n in ((3, 2, 1, 2) if is_grid else (count,) * 4))
    return FilePlan(
        Points(LAYOUT.parameters, columns, is_grid),
        LAYOUT,
        {},
        tuple,
        CONFIG | config,
        {"title": "t"},
        ((0, "ok"), (5, "failed")),
    )


def record(index, error=1e-12):
    return {
        "growth_rate": [index + 0.25, -index],
        "frequency": [0.0, index],
        "error_estimate": [error, 2e-12],
        "unstable_count": index % 3,
        "certified": 1,
        "elements": 1,
        "order": 17,
        "seconds": 1e-3,
        "status": 0,
    }


def journal(store, indices, rank=0, error=1e-12):
    pages = Journal(store.journal_directory, rank, LAYOUT, store.plan.fingerprint)
    for index in indices:
        pages.append(index, record(index, error))
    pages.close()


@pytest.mark.parametrize("is_grid", [True, False])
def test_journalled_points_reach_their_place_in_any_order(tmp_path, is_grid):
    path = tmp_path / "a.h5"
    store = ResultFileWriter(path, plan(is_grid))
    count = 12 if is_grid else 5
    assert store.missing_ranges() == [(0, count)]
    journal(store, [4, 0, 3], rank=0)
    journal(store, [1], rank=1)
    store.add_journals({"finished": "now"})
    assert store.missing_ranges() == ([(2, 3), (5, 12)] if is_grid else [(2, 3)])
    with h5py.File(path) as file:
        growth = file["growth_rate"][...].reshape(count, 2)
        assert growth[4].tolist() == [4.25, -4]
        assert np.isnan(growth[2]).all()
        assert file["status"][...].ravel()[:5].tolist() == [0, 0, -1, 0, 0]
        assert file.attrs["finished"] == "now"
    store.close()
    assert not journal_directory(path).exists()


@pytest.mark.parametrize("is_grid", [True, False])
def test_blocks_of_any_size_give_the_same_file(tmp_path, monkeypatch, is_grid):
    """Whatever is read at once, in any order, and where a killed rank left points that were done again."""
    whole = ResultFileWriter(tmp_path / "whole.h5", plan(is_grid))
    count = whole.missing_ranges()[0][1]
    journal(whole, range(count))
    whole.add_journals({})
    monkeypatch.setattr(pages_of, "BYTES_PER_READ", 3 * (LAYOUT.record_dtype.itemsize + 4))
    monkeypatch.setattr(points, "MAX_READ_BLOCK_POINTS", 2)
    store = ResultFileWriter(tmp_path / "a.h5", plan(is_grid))
    order = np.random.default_rng(1).permutation(count).tolist()
    journal(store, order[1:], rank=0)
    journal(store, [*order[:3], order[0]], rank=1)
    assert read_view(tmp_path / "a.h5").journalled_count == count
    assert store.missing_ranges() == [(0, count)]
    store.add_journals({})
    assert store.missing_ranges() == []
    assert store.status_counts() == {"ok": count}
    with h5py.File(tmp_path / "whole.h5") as one, h5py.File(tmp_path / "a.h5") as other:
        for variable in LAYOUT.variables:
            assert np.array_equal(one[variable.name][...], other[variable.name][...])
    store.close()
    whole.close()


def test_a_merge_reaches_every_point_of_files_larger_than_what_is_read_at_once(tmp_path):
    """The first file keeps what both have; what neither has is missing."""
    paths = [tmp_path / "a.h5", tmp_path / "b.h5"]
    whole = 65_536  # points that are read together
    shares = [1, whole - 1, whole + 1], [0, 1, whole - 1, whole, whole + 1, whole + 4]
    for path, indices, error in zip(paths, shares, (1e-12, 1e-11), strict=True):
        store = ResultFileWriter(path, plan(False, count=whole + 5))
        journal(store, indices, error=error)
        store.add_journals({})
        store.close()
    merged = merge(tmp_path / "m.h5", paths, lambda config, points: plan(False, count=points.count))
    assert (merged.computed_point_count, merged.missing_point_count, merged.is_finished) == (
        6,
        whole - 1,
        False,
    )
    with h5py.File(tmp_path / "m.h5") as file:
        done = np.flatnonzero(file["status"][...] == 0)
        assert done.tolist() == shares[1]
        assert file["growth_rate"][done, 0].tolist() == [index + 0.25 for index in shares[1]]
        assert file["error_estimate"][done, 0].tolist() == [1e-11, 1e-12, 1e-12, 1e-11, 1e-12, 1e-11]


def test_variables_are_read_when_they_are_asked_for(tmp_path):
    ResultFileWriter(tmp_path / "a.h5", plan()).close()
    variables = read_view(tmp_path / "a.h5").variables
    assert not variables.values_read
    assert "growth_rate" in variables
    assert "Y_real" not in variables
    assert variables["growth_rate"].shape == (3, 2, 1, 2, 2)
    assert set(variables.values_read) == {"growth_rate"}
    assert len(dict(variables)) == len(variables)


def test_points_journalled_before_a_kill_are_folded_at_the_next_start(tmp_path):
    path = tmp_path / "a.h5"
    store = ResultFileWriter(path, plan())
    journal(store, range(7))
    assert read_view(path).journalled_count == 7
    store.close()
    again = ResultFileWriter(path, plan())
    assert again.missing_ranges() == [(7, 12)]
    assert again.status_counts() == {"missing": 5, "ok": 7}
    again.close()


@pytest.mark.parametrize("lost", range(1, 140, 13))
def test_torn_tail_of_a_journal_is_dropped(tmp_path, lost):
    store = ResultFileWriter(tmp_path / "a.h5", plan())
    journal(store, range(7))
    (page,) = store.journal_directory.glob("rank-*")
    page.write_bytes(page.read_bytes()[:-lost])
    records = np.concatenate(list(read_journals(store.journal_directory, LAYOUT, store.plan.fingerprint)))
    whole = 7 - -(-lost // (LAYOUT.record_dtype.itemsize + 4))
    assert records["index"].tolist() == list(range(whole))
    store.close()


def test_a_killed_run_keeps_the_reasons_of_the_points_that_it_stored(tmp_path):
    """In sight before the next run folds them in, and beside those of earlier runs, the newest first."""
    path, long = (
        tmp_path / "a.h5",
        "F=3.0: failed " + "w\N{GREEK SMALL LETTER OMEGA}" * LAYOUT.record_dtype.itemsize,
    )
    one, other = "F=1.0: failed a", "F=2.0: failed b"
    store = ResultFileWriter(path, plan())
    pages = Journal(store.journal_directory, 0, LAYOUT, store.plan.fingerprint)
    pages.append(0, record(0), [one])
    pages.append(1, record(1))
    store.add_journals({})
    pages = Journal(store.journal_directory, 0, LAYOUT, store.plan.fingerprint)
    several = {name: np.array([value, value]) for name, value in record(2).items()}
    pages.append_all(np.array([2, 3]), several, [other, long])
    store.close()  # the journal stays, as after SIGKILL
    told = f"{other}\n{long}\n{one}"
    view = read_view(path)
    assert (view.journalled_count, view.attributes[FAILURE_REASONS_ATTRIBUTE]) == (2, told)
    assert open_result(path).attrs[FAILURE_REASONS_ATTRIBUTE] == told
    write_snapshot(path, tmp_path / "s.h5")
    assert read_view(tmp_path / "s.h5").attributes[FAILURE_REASONS_ATTRIBUTE] == told
    again = ResultFileWriter(path, plan())
    assert again.missing_ranges() == [(4, 12)]
    assert again.attributes()[FAILURE_REASONS_ATTRIBUTE] == told
    again.close()


@pytest.mark.parametrize("lost", [1, LAYOUT.record_dtype.itemsize + 4])
def test_a_torn_line_of_reasons_is_dropped_and_only_it(tmp_path, lost):
    store = ResultFileWriter(tmp_path / "a.h5", plan())
    pages = Journal(store.journal_directory, 0, LAYOUT, store.plan.fingerprint)
    pages.append(0, record(0), ["F=1.0: failed a"])
    nothing = np.zeros(0, LAYOUT.record_dtype)
    pages.append_all(nothing["index"], {name: nothing[name] for name in record(0)}, ["x" * 300])
    pages.close()
    (page,) = store.journal_directory.glob("rank-*")
    page.write_bytes(page.read_bytes()[:-lost])
    assert read_failure_reasons(store.journal_directory, LAYOUT, store.plan.fingerprint) == [
        "F=1.0: failed a"
    ]
    store.close()


@pytest.mark.parametrize("byte", [0, 7, 20], ids=["number", "sign", "text"])
@pytest.mark.parametrize("damaged", range(4), ids=["first", "middle", "end", "point"])
def test_a_line_of_reasons_with_a_damaged_record_is_dropped_whole(tmp_path, damaged, byte):
    """No end of a line stands as a reason, and no half of a letter ends the reading."""
    store = ResultFileWriter(tmp_path / "a.h5", plan())
    pages = Journal(store.journal_directory, 0, LAYOUT, store.plan.fingerprint)
    size = LAYOUT.record_dtype.itemsize
    first, long, last = "F=1.0: failed a", "\N{GREEK SMALL LETTER OMEGA}" * size, "F=3.0: failed b"
    for index, line in enumerate((first, long, last)):
        pages.append(index, record(index), [line])
    pages.close()
    (page,) = store.journal_directory.glob("rank-*")
    data = bytearray(page.read_bytes())
    # Before the long line are the first line and its point; the long line takes three records.
    data[pages.header_size + (2 + damaged) * (size + 4) + byte] ^= 1
    page.write_bytes(data)
    # A line that follows the damage at once may be the end of a damaged line.
    kept = [first, last] if damaged < 3 else [first, long]
    assert read_failure_reasons(store.journal_directory, LAYOUT, store.plan.fingerprint) == kept
    store.close()


def test_damaged_record_is_dropped_and_only_it(tmp_path):
    store = ResultFileWriter(tmp_path / "a.h5", plan())
    journal(store, range(7))
    (page,) = store.journal_directory.glob("rank-*")
    data = bytearray(page.read_bytes())
    data[-3 * (LAYOUT.record_dtype.itemsize + 4) + 20] ^= 1
    page.write_bytes(data)
    records = np.concatenate(list(read_journals(store.journal_directory, LAYOUT, store.plan.fingerprint)))
    assert records["index"].tolist() == [0, 1, 2, 3, 5, 6]
    store.close()


def test_journal_of_another_config_is_not_folded(tmp_path):
    store = ResultFileWriter(tmp_path / "a.h5", plan())
    pages = Journal(store.journal_directory, 0, LAYOUT, "another")
    pages.append(0, record(0))
    pages.close()
    store.add_journals({})
    assert store.missing_ranges() == [(0, 12)]
    store.close()


def test_file_of_another_config_is_refused_naming_the_difference(tmp_path):
    path = tmp_path / "a.h5"
    ResultFileWriter(path, plan(accuracy=1e-8)).close()
    before = path.read_bytes()
    with pytest.raises(InputError, match="accuracy is 1e-08 in the file and 1e-10 in the config"):
        ResultFileWriter(path, plan(accuracy=1e-10))
    assert path.read_bytes() == before
    ResultFileWriter(path, plan(accuracy=1e-10), replaces=True).close()


def test_foreign_file_is_refused_and_left_alone(tmp_path):
    path = tmp_path / "a.h5"
    for content in (b"", b"not HDF5", b"\x89HDF\r\n\x1a\n" + b"\0" * 100):
        path.write_bytes(content)
        with pytest.raises(InputError, match="cannot be read as a result of rodsweep"):
            ResultFileWriter(path, plan())
        assert path.read_bytes() == content
        # --fresh, which replaces no file of another program, is advice for damaged results only.
        with pytest.raises(
            InputError, match="--fresh" if content.startswith(b"\x89") else "or move this file away"
        ):
            ResultFileWriter(path, plan())
        with pytest.raises(InputError, match="cannot be read as a result of rodsweep"):
            read_view(path)


@pytest.mark.parametrize(
    "other",
    [np.zeros((3, 2, 1, 2), "i4"), np.zeros((3, 2, 1, 3), "f8")],  # as another version might have it
    ids=["type", "shape"],
)
def test_a_sealed_file_whose_variables_do_not_fit_its_config_is_refused(tmp_path, other):
    path = tmp_path / "a.h5"
    ResultFileWriter(path, plan()).close()
    with h5py.File(path, "r+") as file:
        del file["seconds"]
        file["seconds"] = other
    seal(path)
    with pytest.raises(InputError, match="its variable seconds does not have the type and shape"):
        read_header(path)


def test_two_runs_on_one_file_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(replacement, "LOCK_TIMEOUT", 0.3)
    store = ResultFileWriter(tmp_path / "a.h5", plan())
    with pytest.raises(InputError, match="another run"):
        ResultFileWriter(tmp_path / "a.h5", plan())
    store.close()
    ResultFileWriter(tmp_path / "a.h5", plan()).close()


def test_difference_names_the_first_key_that_differs():
    assert config_difference({"a": {"b": 1}}, {"a": {"b": 1}}) == ""
    assert config_difference({"a": {"b": 1}}, {"a": {"b": 2}}) == "a.b is 1 in the file and 2 in the config"
    assert config_difference({"a": 1, "c": 2}, {"a": 1}) == "c is 2 in the file and not given in the config"
    assert (
        config_difference({"a": [1, 2]}, {"a": [1, 3]}) == "a is [1, 2] in the file and [1, 3] in the config"
    )


def test_difference_in_a_long_list_is_named():
    long = [i / 8 for i in range(300)]
    changed = [*long[:123], 15.4, *long[124:]]
    assert config_difference({"F": {"values": long}}, {"F": {"values": changed}}) == (
        "F.values has 300 values in the file and 300 in the config; "
        "value 124 is 15.375 in the file and 15.4 in the config"
    )
    assert config_difference({"F": long}, {"F": [*long, 50.0]}).endswith(
        "300 values in the file and 301 in the config; "
        "value 301 is missing in the file and 50.0 in the config"
    )
    assert config_difference({"F": long}, {"F": long[:299]}).endswith(
        "value 300 is 37.375 in the file and missing in the config"
    )


def test_a_view_is_of_one_file_though_a_run_exchanges_it_meanwhile(tmp_path, monkeypatch):
    """What is checked, described and read is what was opened first; the other has fewer points."""
    path, other = tmp_path / "a.h5", tmp_path / "b.h5"
    for place, is_grid in ((path, True), (other, False)):
        ResultFileWriter(place, plan(is_grid)).close()
    real = validation.header_of

    def exchanged_before(place, file, **asked):
        if other.exists():
            os.replace(other, path)
        return real(place, file, **asked)

    monkeypatch.setattr(validation, "header_of", exchanged_before)
    shown = read_view(path)
    assert shown.is_grid
    assert shown.variables["status"].size == 12
    assert read_header(path).point_count == 5
