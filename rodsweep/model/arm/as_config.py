"""An arm in SI units as values of a config: the parameters of the rod, and the section `material`.

The dimensionless parameters F, k1, k2, gamma1 and gamma3 of an arm are properties of `SlenderArm`.
"""

from typing import Any

from ..material.profile import FACTOR_NAMES
from ..material.rod_material import DEFAULT_MATERIAL
from ..parameters import NONLINEAR_ROD_PARAMETER_NAMES
from .arm import SlenderArm


def rod_parameters_of(arm: SlenderArm) -> dict[str, float]:
    """Dimensionless parameters of the rod that represents `arm`, by name; without F for an arm without load.
    Raises InputError for a load relative to flutter, because the flutter threshold must be solved first."""
    names = [name for name in NONLINEAR_ROD_PARAMETER_NAMES if name != "F" or arm.load_name is not None]
    names += ["taper"] if arm.taper != 1 else []
    return {name: arm.parameter(name) for name in names}


def material_config_of(arm: SlenderArm) -> dict[str, Any]:
    """Keys and values of the config section `material` for `arm`; keys with default values are left out.
    Possible keys are law, section and profile."""
    rod_material = arm.material
    values_and_defaults = {
        "law": (rod_material.law, DEFAULT_MATERIAL.law),
        "section": (rod_material.section, DEFAULT_MATERIAL.section),
    }
    material: dict[str, Any] = {
        name: value for name, (value, default) in values_and_defaults.items() if value != default
    }
    if rod_material.profile is not None:
        columns = (rod_material.profile.u, *zip(*rod_material.profile.rows, strict=True))
        material["profile"] = dict(zip(("u", *FACTOR_NAMES), map(list, columns), strict=True))
    return material
