"""Converts an arm in SI units to config keys of a dimensionless rod: the sections `parameters` and
`material`."""

from typing import Any

from ..material.build import STANDARD
from ..material.profile import FACTORS
from ..parameters import NONLINEAR_PARAMETERS
from .arm import SlenderArm


def parameters_of(arm: SlenderArm) -> dict[str, float]:
    """Dimensionless parameters of the rod that describes an arm, by name; without F if the arm has no load.

    Raises InputError for a load relative to flutter, which needs a solve.
    """
    names = [name for name in NONLINEAR_PARAMETERS if name != "F" or arm.load is not None]
    names += ["taper"] if arm.taper != 1 else []
    return {name: arm.parameter(name) for name in names}


def material_of(arm: SlenderArm) -> dict[str, Any]:
    """Keys law, section and profile of the config section `material`; omits keys with default values."""
    build = arm.build
    words = {"law": (build.law, STANDARD.law), "section": (build.section, STANDARD.section)}
    material: dict[str, Any] = {name: own for name, (own, default) in words.items() if own != default}
    if build.profile is not None:
        columns = (build.profile.u, *zip(*build.profile.rows, strict=True))
        material["profile"] = dict(zip(("u", *FACTORS), map(list, columns), strict=True))
    return material
