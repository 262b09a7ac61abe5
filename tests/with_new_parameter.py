"""Run by `test_new_parameter`: rodsweep with an invented factor of the rotational drag in its table."""

# ruff: noqa: E402 - the table is changed before anything is imported that reads it

import sys
from importlib.util import find_spec, module_from_spec
from pathlib import Path

ENTRY = """
        Parameter(
            name="roughness",
            symbol=r"r",
            unit="1",
            meaning="factor of rotational drag",
            allowed_range=Range(
                lambda value: 0 < value < inf, "a finite number above 0", {"exclusiveMinimum": 0}
            ),
            default=1.0,
            scaled_coefficient_names=("gamma3",),
        ),
"""
END = '    )\n}\n"""All parameters of the rod by name'


def add_to_table() -> None:
    """Makes the table of parameters that of a source with one entry more."""
    spec = find_spec("rodsweep.model.parameters")
    source = Path(spec.origin).read_text(encoding="utf-8")
    assert source.count(END) == 1
    module = sys.modules[spec.name] = module_from_spec(spec)
    exec(compile(source.replace(END, ENTRY.strip("\n") + "\n" + END), spec.origin, "exec"), vars(module))


add_to_table()

import numpy as np

import rodsweep as rs
from rodsweep.cli import commands
from rodsweep.config.json_schema import json_schema
from rodsweep.model.rod import Rod

ROD = {"k1": 1e3, "k2": 1e2}
ROUGH = [1.0, 1.5, 2.0, 2.5]


def agree(one, other, rel=1e-11):
    np.testing.assert_allclose(one, other, rtol=rel)


def command(*words) -> None:
    try:
        commands([*map(str, words)], standalone_mode=False)
    except SystemExit as end:
        assert not end.code


def spectra() -> None:
    """The parameter as an axis of a config: followed and by single points, in a file, shown, as xarray."""
    for follow in ("true", "false"):
        Path("c.yaml").write_text(
            "task: spectrum\nparameters: {F: [10, 40], k1: 1.0e+3, k2: 1.0e+2, gamma3: 1.0e-2,"
            " roughness: {start: 1, stop: 2.5, num: 16}}\n"
            f"spectrum: {{follow: {follow}}}\n"
        )
        command("check", "c.yaml")
        command("run", "c.yaml", "-o", f"{follow}.h5")
        command("show", f"{follow}.h5")
        data = rs.open(f"{follow}.h5").load()
        assert data.growth_rate.dims == ("F", "k1", "k2", "gamma3", "roughness", "mode")
        assert data.roughness.attrs["long_name"] == "factor of rotational drag"
        same = rs.sweep("spectrum", F=[10, 40], gamma3=1e-2 * data.roughness.values, **ROD)
        for name in ("growth_rate", "frequency", "unstable_count"):
            agree(data[name].values.squeeze(), same[name].values.squeeze(), 1e-9)


def thresholds() -> None:
    """At a value that is given, and along the parameter as the line of a diagram."""
    one = rs.Rod(gamma3=5e-3, roughness=2.0, **ROD).thresholds()
    agree(one.F_hopf, rs.Rod(gamma3=1e-2, **ROD).thresholds().F_hopf)
    axes = {"F": [28.0, 40.0], "roughness": np.linspace(1.0, 3.0, 5)}
    diagram = rs.sweep("phase_diagram", gamma3=1e-2, curves=False, **axes, **ROD)
    same = rs.sweep("phase_diagram", F=axes["F"], gamma3=1e-2 * axes["roughness"], curves=False, **ROD)
    assert (diagram["class"].values.squeeze() == same["class"].values.squeeze()).all()


def cycles() -> None:
    """Alone, as a chain along the parameter, and as a branch followed in it."""
    chain = rs.sweep(
        "limit_cycle",
        F=40.0,
        gamma3=1e-2,
        roughness=ROUGH,
        start="neighbour",
        along="roughness",
        accuracy=1e-7,
        **ROD,
    )
    for rough, period, y in zip(
        ROUGH, chain.period.values.ravel(), chain.tip_y_max.values.ravel(), strict=True
    ):
        alone = rs.Rod(F=40.0, gamma3=1e-2 * rough, **ROD).cycle(accuracy=1e-7)
        agree((period, y), (alone.period, alone.tip_y_max), 3e-7)
    rod = rs.Rod(F=45.0, k1=200.0, k2=1e4, gamma3=1e-3)
    one = rod.branch(along="roughness", start=1.0, stop=20.0, accuracy=1e-5)
    other = rod.branch(along="gamma3", start=1e-3, stop=2e-2, accuracy=1e-5)
    assert one.special_count == other.special_count >= 2
    agree(one.special_at, 1e3 * other.special_at, 1e-6)


def derivatives() -> None:
    """By the coordinate, and the rod elsewhere along it."""
    rod = Rod(F=30.0, gamma3=1e-2, roughness=3.0, **ROD)
    assert rod.coordinate("roughness") == 3.0
    there = rod.with_coordinate("roughness", 4.0)
    agree(
        there.balance_coefficients.drag,
        rod.balance_coefficients.drag + rod.balance_coefficient_derivative("roughness").drag,
    )
    assert rod.coefficient_derivative("gamma3").gamma3 == 3.0
    assert repr(rs.Rod(F=30, gamma3=1e-2, roughness=3, **ROD)).endswith("roughness=3)")


def keys() -> None:
    """In the schema and in the refusal of a value."""
    assert "roughness" in str(json_schema())
    try:
        rs.Rod(gamma3=1.0, roughness=0, **ROD)
    except rs.InputError as error:
        assert "parameters.roughness = 0 is not allowed; it must be a finite number above 0" in str(error)
    else:
        raise AssertionError("0 is taken")


derivatives()
keys()
spectra()
thresholds()
cycles()
print("agreed")
