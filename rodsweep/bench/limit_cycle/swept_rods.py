"""Rods whose cycles are solved in the benchmark of sweeps, and their labels."""

from ...model.material.profile import Profile
from ...model.material.rod_material import DEFAULT_MATERIAL, RodMaterial
from ...model.rod import Rod
from ..spectrum.arm_spectra import FIVE_SEGMENT_PROFILE

TWO_SEGMENT_PROFILE = Profile(
    (0.0, 0.4, 0.4, 1.0), tuple((r**2, r**2, r**4, 1.0, 1.0, r**2) for r in (1.0, 1.0, 0.6, 0.6))
)
"""Profile of an arm of two segments: the outer 60 % of the length have 0.6 times the radius at the clamp."""
RODS = (
    Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0),
    Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=0.5),
    Rod(F=30.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0),
    Rod(F=100.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0),
    Rod(F=40.0, k1=1e4, k2=1e4, gamma3=1e-4, gamma1=1.0),
    Rod(F=60.0, k1=200.0, k2=1e4, gamma3=1e-4, gamma1=1.0),
    Rod(F=100.0, k1=200.0, k2=1e4, gamma3=1e-4, gamma1=1.0),
    Rod(F=20.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0, taper=0.5),
    Rod(F=50.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0, material=RodMaterial("neo_hookean", "swelling")),
    Rod(F=14.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0, material=RodMaterial(profile=TWO_SEGMENT_PROFILE)),
    Rod(F=12.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0, material=RodMaterial(profile=FIVE_SEGMENT_PROFILE)),
)
"""Rods whose cycles are solved: near and far from Hopf points, stiff, shortened to half by the force, a cone
as far from its Hopf point as the first rod, the first rod made of rubber, and arms of two and of five
segments."""
QUICK_RODS = (RODS[2],)  # for a quick run


def rod_label(rod: Rod) -> str:
    """Label of a rod in the tables: F, k1, k2, gamma3, gamma1; taper, number of segments, law and section if
    not the default."""
    texts = [] if rod.taper == 1 else [f"taper {rod.taper:g}"]
    segment_count = len(rod.material.breaks) - 1
    texts += [] if segment_count == 1 else [f"{segment_count} segments"]
    is_linear = (rod.material.law, rod.material.section) == (DEFAULT_MATERIAL.law, DEFAULT_MATERIAL.section)
    texts += [] if is_linear else [rod.material.law, rod.material.section]
    values = (rod.F, rod.k1, rod.k2, rod.gamma3, rod.gamma1)
    return ", ".join([*(f"{value:g}" for value in values), *texts])
