"""An arm in SI units as the keys of a rod: its dimensionless parameters, and its section `material`."""

from typing import Any

from ..material.build import STANDARD
from ..material.profile import FACTORS
from ..parameters import NONLINEAR_PARAMETERS
from .arm import SlenderArm


def parameters_of(arm: SlenderArm) -> dict[str, float]:
    """Parameters of an arm as a rod, by name; without F for an arm without load.

    Raises InputError for a load relative to flutter, which needs a solve.
    """
    names = [name for name in NONLINEAR_PARAMETERS if name != "F" or arm.load is not None]
    names += ["taper"] if arm.taper != 1 else []
    return {name: arm.parameter(name) for name in names}


def material_of(arm: SlenderArm) -> dict[str, Any]:
    """The keys of `material`, law, section and profile, that differ from their defaults."""
    build = arm.build
    words = {"law": (build.law, STANDARD.law), "section": (build.section, STANDARD.section)}
    material: dict[str, Any] = {name: own for name, (own, default) in words.items() if own != default}
    if build.profile is not None:
        columns = (build.profile.u, *zip(*build.profile.rows, strict=True))
        material["profile"] = dict(zip(("u", *FACTORS), map(list, columns), strict=True))
    return material
