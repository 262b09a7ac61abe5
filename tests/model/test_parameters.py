"""The table of parameters: every place that lists them has what the table says, in its order."""

from dataclasses import fields
from math import inf, nan
from pathlib import Path

import pytest

import rodsweep
from rodsweep.config.tasks import CONFIG_CLASSES_BY_TASK
from rodsweep.model.parameters import (
    FORCE_AND_STRETCH_STIFFNESS,
    NON_OPTIONAL_LINEAR_PARAMETER_NAMES,
    NONLINEAR_ROD_PARAMETER_NAMES,
    OPTIONAL_PARAMETER_NAMES,
    PARAMETERS,
    parameter_names_except,
)
from rodsweep.model.rod import Rod
from rodsweep.results.layouts.dimensions import UNIT_AND_LONG_NAME_OF_DIMENSION


def test_the_rod_has_all_parameters():
    assert tuple(field.name for field in fields(Rod) if field.init) == (*PARAMETERS, "material")
    assert NONLINEAR_ROD_PARAMETER_NAMES[:4] == NON_OPTIONAL_LINEAR_PARAMETER_NAMES
    assert OPTIONAL_PARAMETER_NAMES == ("taper",)
    assert parameter_names_except("F") == NON_OPTIONAL_LINEAR_PARAMETER_NAMES[1:]
    assert set(FORCE_AND_STRETCH_STIFFNESS) <= set(NON_OPTIONAL_LINEAR_PARAMETER_NAMES)


def test_every_config_has_every_parameter_as_a_key_and_every_file_as_a_dimension():
    for config in CONFIG_CLASSES_BY_TASK.values():
        keys = config.model_fields["parameters"].annotation.model_fields
        assert {*PARAMETERS, "points", "columns", "arm"} == set(keys)
    assert {UNIT_AND_LONG_NAME_OF_DIMENSION[name] for name in PARAMETERS} == {
        (p.unit, p.long_name) for p in PARAMETERS.values()
    }


@pytest.mark.parametrize(
    ("name", "good", "bad"),
    [
        ("F", (-1e300, 0, 3.0), (inf, -inf)),
        ("k1", (1e-300, 1, inf), (0, -1.0, 1e-320, -inf)),
        ("k2", (1e-300, 1, inf), (0, -1.0, 1e-320, -inf)),
        ("gamma3", (0, 1e-320, 1e300), (-1e-320, inf)),
        ("gamma1", (1e-320, 1e300), (0, -1.0, inf)),
        ("taper", (0.01, 100.0), (0, 0.009, -1.0, inf)),
    ],
)
def test_ranges(name, good, bad):
    for value in good:
        PARAMETERS[name].require_in_range(value)
    for value in (*bad, nan):
        with pytest.raises(ValueError, match=f"{name} = .* is not a .*number"):
            PARAMETERS[name].require_in_range(value)


@pytest.mark.parametrize("name", ["k1", "k2"])
def test_a_tiny_stiffness_is_refused_because_its_inverse_overflows(name):
    why = f", or inf for an .* rod \\(1/{name} overflows\\)$"
    with pytest.raises(ValueError, match=f"{name} = 1e-320 is not a number above 0{why}"):
        PARAMETERS[name].require_in_range(1e-320)
    with pytest.raises(rodsweep.InputError, match=f"{name} = .*e-321 is not allowed; .* above 0{why}"):
        rodsweep.Rod(**{"k1": 1e4, "k2": 1e4, "gamma3": 0.0} | {name: 1e-320})
    for value in (0.0, -1.0, nan):
        with pytest.raises(ValueError, match=r"is not a number above 0, or inf for an \w+ rod$"):
            PARAMETERS[name].require_in_range(value)


def test_the_sequence_of_parameters_stands_once():
    package = Path(rodsweep.__file__).parent
    written = [path for path in package.rglob("*.py") if '"F", "k1"' in path.read_text()]
    assert written == [package / "model" / "parameters.py"]
