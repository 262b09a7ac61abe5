"""`rodsweep export`: tables for other programs, a row an item, the numbers of the file to the last bit."""

import csv

import h5py
import numpy as np
import pytest

from rodsweep.discretization.straight.longitudinal_modes import longitudinal_eigenvalues_and_errors
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.post.tables.column import coordinate_column
from rodsweep.post.tables.table_names import TABLE_NAMES

SPECTRA = """
task: spectrum
parameters: {F: {start: 0, stop: 60, num: 7}, k1: [200, .inf], k2: 1.0e4, gamma3: 1.0e-4}
spectrum: {modes: 3, vectors: true}
"""
ROD = "k1: 200, k2: 1.0e4, gamma3: 1.0e-4"


def exported(command, config, *options):
    """(headings, rows as lists of words, what was said) of the CSV file of a config's results."""
    command.write("c.yaml", config)
    assert command("run", "c.yaml").returncode == 0
    done = command("export", "c.h5", *options)
    assert done.returncode == 0, done.stderr
    with (command.directory / "c.csv").open(newline="") as stream:
        head, *rows = csv.reader(stream)
    return head, rows, done.stdout


def table_of(head, rows):
    """Columns by heading, each a tuple of words."""
    return dict(zip(head, zip(*rows, strict=True), strict=True))


def test_numbers_of_a_grid_are_those_of_the_file_to_the_last_bit(command):
    head, rows, said = exported(command, SPECTRA)
    columns = table_of(head, rows)
    assert head == ["F", "k1", "k2", "gamma3", "status", "mode", "growth_rate", "frequency", "error_estimate"]
    with h5py.File(command.directory / "c.h5") as file:
        F, k1, mode = np.meshgrid(file["F"], file["k1"], file["mode"], indexing="ij")
        for name, values in (("F", F), ("k1", k1), ("mode", mode)):
            assert np.array_equal(np.array(columns[name], float), values.ravel())
        for name in ("growth_rate", "frequency"):
            assert np.array_equal(np.array(columns[name], float), file[name][...].ravel())
        errors = np.array(columns["error_estimate"], float)
        assert errors == pytest.approx(file["error_estimate"][...].ravel(), rel=1e-2)
    assert max(map(len, columns["error_estimate"])) <= len("1.23e-100")
    assert set(columns["status"]) == {"ok"}
    assert {"200", "inf", "0.0001"} <= {*columns["k1"], *columns["gamma3"]}  # no 200.0
    assert said == (
        "wrote c.csv: 42 rows of modes in 9 columns; --table takes points, mode_shapes or force_changes "
        "instead\n"
    )


def test_every_point_has_a_row_of_points(command):
    head, rows, _ = exported(command, SPECTRA, "--table", "points")
    columns = table_of(head, rows)
    assert len(rows) == 14
    assert set(columns["certified"]) == {"true"}
    with h5py.File(command.directory / "c.h5") as file:
        assert np.array_equal(np.array(columns["unstable_count"], int), file["unstable_count"][...].ravel())


def test_a_list_has_a_row_for_each_item_that_was_found(command):
    config = f"task: thresholds\nparameters: {{{ROD}}}\nthresholds: {{crossings: 4}}\n"
    head, rows, _ = exported(command, config, "--units", "--table", "crossings")
    columns = table_of(head, rows)
    assert columns["crossing_kind"] == ("onset", "hopf", "restabilization")
    assert columns["crossing"] == ("1", "2", "3")
    assert float(columns["crossing_F [k3/L^2]"][1]) == pytest.approx(49.7580049161915, abs=1e-12)
    assert "crossing_frequency [rad/tau2]" in head
    assert "k1 [k3/L^2]" in head


def test_what_is_not_there_is_empty(command):
    head, (row,), _ = exported(
        command, f"task: thresholds\nparameters: {{{ROD}}}\nthresholds: {{F_max: 30}}\n"
    )
    values = dict(zip(head, row, strict=True))
    assert (values["F_hopf"], values["hopf_frequency"], values["open_from"]) == ("", "", "")
    assert float(values["F_onset"]) == pytest.approx(22.470977, abs=1e-6)
    assert not {"nan", "-1", "none"} & set(row)


def test_columns_are_chosen_and_say_in_which_table_they_are(command):
    config = "task: thresholds\nparameters: {k1: [200, 300], k2: 1.0e4, gamma3: 1.0e-4}\n"
    head, rows, _ = exported(command, config, "--columns", "crossing_kind, F_hopf,k1")
    assert head == ["crossing_kind", "F_hopf", "k1"]
    assert [row[0] for row in rows if row[2] == "200"] == ["onset", "hopf", "restabilization"]
    assert len({row[1] for row in rows}) == 2  # repeated on the rows of its point
    for words, sentence in {
        ("--columns", "F_hop"): "c.h5: its tables have no column 'F_hop'; did you mean F_hopf?",
        ("--columns", "k1,k1"): "c.h5: the column k1 is named twice",
        ("--columns", ""): "c.h5: its tables have no column ''; there are status, F_onset, ",
        ("--table", "crossing"): "c.h5 has no table 'crossing'; did you mean crossings?",
        ("--table", "points", "--columns", "crossing_F"): "the table points has no column 'crossing_F'; ",
        ("-o", "c.xlsx"): "--output c.xlsx: the name must end in .csv or .tsv",
        ("-o", "c"): "--output c: the name must end in .csv or .tsv",
    }.items():
        refused = command("export", "c.h5", "--replace", *words)
        assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
        assert sentence in refused.stderr
    assert command("export", "c.h5", "-o", "c.tsv", "--columns", "k1,F_hopf").returncode == 0
    assert (command.directory / "c.tsv").read_text().startswith("k1\tF_hopf\n200\t49.75")


def test_a_diagram_has_its_grid_its_rows_and_its_curves_as_tables(command):
    config = "task: phase_diagram\nparameters: {F: [0, 60, 80], k1: [140, 150], k2: 1.0e4, gamma3: 1.0e-4}\n"
    head, rows, said = exported(command, config)
    assert head == ["F", "k1", "k2", "gamma3", "status", "class", "unstable_count"]
    assert [row[:2] for row in rows[:4]] == [["0", "140"], ["60", "140"], ["80", "140"], ["0", "150"]]
    assert rows[-1][5:] == ["flutter", "2"]
    assert "--table takes points, crossings, curves or folds instead" in said
    head, rows, _ = exported(command, config, "--table", "curves", "--replace")
    columns = table_of(head, rows)
    assert "status" not in head
    with h5py.File(command.directory / "c.h5") as file:
        assert np.array_equal(np.array(columns["curve_F"], float), file["curve_F"][...])
        assert set(columns["curve_kind"]) == {"double", "hopf"}
    head, (fold,), _ = exported(command, config, "--table", "folds", "--replace")
    values = dict(zip(head, fold, strict=True))
    assert (values["fold"], values["fold_kind"], values["fold_of"]) == ("1", "hopf", "k1")


@pytest.mark.long
def test_a_branch_is_a_table_of_cycles_with_its_special_points_marked(command):
    config = "task: branch\naccuracy: 1.0e-4\nparameters: {k1: [130, 150], k2: 1.0e4, gamma3: 1.0e-4}\n"
    config += "branch: {stop: 100}\n"
    head, rows, said = exported(command, config)
    columns = table_of(head, rows)
    marks = [word for word in columns["special_kind"] if word]
    assert marks == ["hopf", "fold", "hopf"]
    assert (columns["special_kind"][0], columns["special_kind"][-1]) == ("hopf", "hopf")
    assert set(columns["k1"]) == {"150"}
    assert "1 of 2 points without a row" in said
    F, fold = np.array(columns["branch_F"], float), columns["special_kind"].index("fold")
    assert F[fold] == F.max() == pytest.approx(85.6055765, abs=1e-6)
    places = [int(text) for text in columns["branch_point"] if text]
    assert places == list(range(1, len(rows) - 2))
    chosen = command("export", "c.h5", "--columns", "branch_F,special_kind", "--replace")
    assert f"{len(rows)} rows of branches in 2 columns" in chosen.stdout


def test_longitudinal_rates_stand_beside_the_modes(command):
    config = "task: spectrum\nparameters: {F: [1, 2], k1: [200, 300], k2: 1.0e4, gamma3: 1.0e-4, gamma1: 2}\n"
    columns = table_of(*exported(command, config + "spectrum: {longitudinal: true, modes: 2}\n")[:2])
    k1, mode = (np.array(columns[name], float) for name in ("k1", "mode"))
    expected = -k1 / 2 * (np.pi * (mode - 0.5)) ** 2
    assert np.array(columns["longitudinal_rate"], float) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("more", "law", "closed"), [(", taper: 1", "linear", True), ("", "neo_hookean", False)]
)
def test_longitudinal_rates_of_uniform_arms_stand_beside_the_modes(command, more, law, closed):
    axes = f"F: [1, 20], k1: [200, 300], k2: 1.0e4, gamma3: 1.0e-4, gamma1: 2{more}"
    options = f"material: {{law: {law}}}\nspectrum: {{longitudinal: true, modes: 2}}\n"
    columns = table_of(*exported(command, f"task: spectrum\nparameters: {{{axes}}}\n{options}")[:2])
    F, k1, mode, rate = (np.array(columns[name], float) for name in ("F", "k1", "mode", "longitudinal_rate"))
    assert ("longitudinal_error" in columns) != closed
    nu = np.array([1.0 if closed else stretch_of_rubber(x) for x in F / k1])
    expected = -k1 * (1 + 2 / nu**3) / 3 / 2 * (np.pi * (mode - 0.5)) ** 2
    assert rate == pytest.approx(expected, rel=1e-12)


def stretch_of_rubber(x):
    """nu with nu^3 + 3 x nu^2 = 1."""
    (nu,) = (root.real for root in np.roots([1, 3 * x, 0, -1]) if root.real > 0)
    return nu


def test_longitudinal_rates_of_rubber_cones_stand_beside_the_modes_with_their_error(command):
    axes = "F: [1, 20], k1: [200, 300], k2: 1.0e4, gamma3: 1.0e-4, taper: [0.5, 0.8], gamma1: 2"
    options = "material: {law: neo_hookean}\nspectrum: {longitudinal: true, modes: 2}\n"
    columns = table_of(*exported(command, f"task: spectrum\nparameters: {{{axes}}}\n{options}")[:2])
    names = ("F", "k1", "taper", "longitudinal_rate", "longitudinal_error")
    rows = np.transpose([np.array(columns[name], float) for name in names])[::2]
    assert len(rows) == 8
    for F, k1, taper, rate, error in rows:
        material = RodMaterial(law="neo_hookean")
        alone = longitudinal_eigenvalues_and_errors(
            Rod(F=F, k1=k1, k2=1e4, gamma3=0.0, gamma1=2, taper=taper, material=material), 1
        )
        assert (rate, error < 1e-12) == (pytest.approx(alone[0][0], rel=1e-12), True)


def test_typed_coordinates_keep_all_digits_and_computed_ones_lose_their_rounding_error():
    typed = [24.101412761256988, 0.1234567, 54.48730018140099]
    computed = [2500.0000000000005, 0.30000000000000004]
    texts = coordinate_column("F", "k3/L^2", "force", np.array(typed + computed)).csv_texts()
    assert texts == [*map(repr, typed), "2500", "0.3"]


def test_an_arm_has_its_quantities_as_they_were_typed_and_results_in_si(command):
    arm = "arm: {length: 10 cm, radius: [4 mm, 5 mm], young: 100 kPa, viscosity: 1.4 Pa s}"
    head, rows, _ = exported(command, f"task: thresholds\nparameters: {{{arm}}}\n", "--units")
    columns = table_of(head, rows)
    assert columns["radius [m]"] == ("0.004", "0.005")
    assert columns["k1 [k3/L^2]"] == ("2500", "1600")  # no 2500.0000000000005
    assert columns["pressure_scale [Pa]"] == ("40", "62.5")
    assert "frequency_hopf_hz [Hz]" in head
    assert not any("rad/s" in name for name in head)


def test_tables_of_an_arm_are_in_si_too_where_the_file_tells_them_once(command):
    """F = 1 is 62.5 Pa; the curves, rows and grid of a diagram are stored without units only."""
    arm = "length: 10 cm, radius: 5 mm, young: 100 kPa, viscosity: 1.4 Pa s"
    load = "pressure: [0 kPa, 2.5 kPa, 5 kPa]"
    config = f"task: phase_diagram\nparameters: {{arm: {{{arm}, {load}}}, gamma3: [0.001, 0.01]}}\n"
    tables = {
        name: table_of(*exported(command, config, "--table", name, "--replace")[:2])
        for name in ("grid", "crossings", "curves")
    }
    assert tables["grid"]["pressure"] == ("0", "2500", "5000") * 2
    for name, force, load in (
        ("crossings", "crossing_at", "crossing_pressure"),
        ("curves", "curve_F", "curve_pressure"),
    ):
        columns = {key: np.array(tables[name][key], float) for key in (force, load)}
        assert columns[load] == pytest.approx(62.5 * columns[force], rel=1e-12)
    tau2 = float(tables["grid"]["tau2"][0])
    angular, cycles = (np.array(tables["curves"][f"curve_frequency{end}"], float) for end in ("", "_hz"))
    assert 2 * np.pi * cycles * tau2 == pytest.approx(angular, rel=1e-12)


def test_a_branch_of_an_arm_has_loads_of_special_points_in_si(command):
    arm = "arm: {length: 10 cm, radius: 5 mm, young: 100 kPa, viscosity: 1.4 Pa s}"
    config = f"task: branch\naccuracy: 1.0e-3\nparameters: {{{arm}}}\nbranch: {{stop: 40}}\n"
    columns = table_of(*exported(command, config)[:2])
    assert columns["special_kind"][0] == "hopf"
    F, pressure = (np.array(columns[name], float) for name in ("branch_F", "branch_pressure"))
    assert pressure == pytest.approx(62.5 * F, rel=1e-12)


@pytest.mark.long
@pytest.mark.parametrize("task", ["modes", "limit_cycle", "list"])
def test_results_of_every_task_are_exported(command, task):
    configs = {
        "modes": f"task: modes\nparameters: {{F: 30, {ROD}}}\n",
        "limit_cycle": "task: limit_cycle\naccuracy: 1.0e-4\n"
        "parameters: {F: 20, k1: 1.0e4, k2: 100, gamma3: 0.01}\n",
        "list": "task: spectrum\nparameters: {points: points.csv}\n",
    }
    command.write("points.csv", "F,k1,k2,gamma3\n30,200,1e4,1e-4\n40,inf,1e4,0\n")
    head, rows, said = exported(command, configs[task])
    assert len(rows) == {"modes": 2, "list": 8, "limit_cycle": 1}[task]
    assert all(len(row) == len(head) for row in rows)
    if task == "limit_cycle":
        assert table_of(head, rows)["status"] == ("straight",)
        refused = command("export", "c.h5", "--table", "harmonics", "--replace")
        assert "0 rows of harmonics in " in refused.stdout
        assert "1 of 1 point without a row" in refused.stdout
    for table in [name for name in TABLE_NAMES.values() if name in said.replace(",", "").split()]:
        done = command("export", "c.h5", "--table", table, "--replace")
        assert done.returncode == 0, done.stderr


def test_a_file_that_is_there_is_written_over_only_on_request(command):
    exported(command, SPECTRA)
    before = command.write("c.csv", "mine").read_text()
    refused = command("export", "c.h5")
    assert (refused.returncode, (command.directory / "c.csv").read_text()) == (2, before)
    assert "c.csv exists already; --replace overwrites it" in refused.stderr
    assert command("export", "c.h5", "-o", "c.h5", "--replace").returncode == 2
    assert command("export", "c.h5", "--replace").returncode == 0
    assert (command.directory / "c.csv").read_text().startswith("F,k1,k2")
    assert sorted(path.name for path in command.directory.iterdir()) == ["c.csv", "c.h5", "c.yaml"]


def test_missing_points_have_a_row_of_points_and_no_items(command):
    command.write("c.yaml", SPECTRA)
    command("run", "c.yaml", "--shard", "1/2", "-o", "c.h5")
    done = command("export", "c.h5")
    assert "21 rows of modes in 9 columns; 7 of 14 points without a row; " in done.stdout
    assert command("export", "c.h5", "--table", "points", "--replace").returncode == 0
    lines = (command.directory / "c.csv").read_text().splitlines()
    assert sum(line.endswith(",missing,,,,,") for line in lines) == 7
    assert len(lines) == 15
