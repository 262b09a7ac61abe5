"""Random arms: cones, stepped and smooth profiles, and both, of every law, pushed or pulled."""

import numpy as np

from rodsweep.model.material.laws import LAWS
from rodsweep.model.material.profile import Profile
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Crushed, Rod


def random_profile(rng, factor=10.0):
    """One to four pieces, each constant or not, whose factors are up to `factor` and down to its inverse."""
    cuts = np.sort(rng.uniform(0.05, 0.95, rng.integers(0, 4)))
    edges = [0.0, *cuts.tolist(), 1.0]
    u, rows = [], []
    for a, b in zip(edges[:-1], edges[1:], strict=True):
        u += [a, b]
        first = factor ** rng.uniform(-1, 1, 6)
        last = first * (1.0 if rng.random() < 0.5 else 2 ** rng.uniform(-1, 1, 6))
        rows += [tuple(first.tolist()), tuple((np.ones(6) * last).tolist())]
    return Profile(tuple(u), tuple(rows))


def random_arm(rng, pulled=0.1):
    """An arm; `pulled`: the share of arms under a pull."""
    while True:
        law, section = list(LAWS)[rng.integers(len(LAWS))]
        kind = rng.integers(3)
        taper = 1.0 if kind == 1 else float(10 ** rng.uniform(-1, 0.48))
        profile = None if kind == 0 else random_profile(rng)
        weakest = min(1.0, taper**4) * (1.0 if profile is None else min(row[2] for row in profile.rows))
        values = {
            "F": 10 ** rng.uniform(0, 2.2) * weakest * (-1 if rng.random() < pulled else 1),
            "k1": 10 ** rng.uniform(1.5, 5),
            "k2": 10 ** rng.uniform(1, 5),
            "gamma3": 10 ** rng.uniform(-5, 0),
        }
        numbers = {name: float(value) for name, value in values.items()}
        try:
            return Rod(**numbers, taper=taper, material=RodMaterial(law, section, profile))
        except Crushed:
            continue
