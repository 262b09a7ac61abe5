"""The hard rods, (F, k1, k2, gamma3), by what makes them hard."""

import json
from functools import cache
from math import inf

import mpmath as mp
from conftest import ROOT
from reference import determinant as reference

STORED = json.loads((ROOT / "tests" / "reference" / "thresholds.json").read_text())
DOUBLE = ("onset", "real_again")
CROSSING = ("hopf", "hopf_reverse")


def stored_rods(*names):
    """(k1, k2, gamma3, events) of rods in `thresholds.json`."""
    rods = {tuple(float(rod[n]) for n in ("k1", "k2", "gamma3")): rod["events"] for rod in STORED[::-1]}
    return [(*name, rods[name]) for name in names]


def at_force(F, offset, k1, k2, gamma3):
    """The rod at F (1 + offset), F in 30 digits."""
    with mp.workdps(40):
        return float(mp.mpf(F) * (1 + mp.mpf(offset))), k1, k2, gamma3


BESIDE = [sign * size for size in (1e-10, 1e-8, 1e-6, 1e-4) for sign in (1, -1)]
EXCEPTIONAL = [
    (k1, k2, gamma3, event)
    for k1, k2, gamma3, events in stored_rods(
        (1e4, 1e4, 1e-4),
        (1e4, 1e2, 1e-2),
        (200.0, 1e4, 1e-4),
        (100.0, 1e4, 1e-4),
        (inf, inf, 0.0),
        (150.0, inf, 0.0),
        (147.5, 1e4, 1e-4),
        (80.0, 50.0, 0.1),
        (1e4, 1e4, 10.0),
        (1e4, 5.0, 0.01),
    )
    for event in events
    if event["kind"] in DOUBLE
]
"""(k1, k2, gamma3, event), the event an onset or its reverse: two real eigenvalues coincide."""

CRUSHED = [
    (200.0, 1e4, 1e-4),
    (20.0, 1e2, 1e-2),
    (1e4, 1e4, 1e-4),
    (1e4, 1e4, 1.0),
    (1.0, 1.0, 1.0),
    (200.0, 10.0, 1e-3),
    (1e4, 1e8, 1e-8),
    (30.0, 3.0, 10.0),
    (1e4, inf, 0.1),
    (50.0, 30.0, 0.0),
]
PARTIAL_BEAMS = [5.0, 100.0, 200.0]
"""k1 of rods with k2 = inf and gamma3 = 0."""


def crushed(k1, k2, gamma3, most=9):
    """F = k1 (1 - 10^-j), j = 1 to `most`."""
    return [(k1 * (1 - 10.0**-j), k1, k2, gamma3) for j in range(1, most + 1)]


CROWDED = {
    (2000.0, 1e4, 1e4, 1e-4): 12,
    (2000.0, 1e4, inf, 0.0): 10,
    (2000.0, inf, 4e5, 2.0): 14,
    (2000.0, 1e4, 1e4, 30.0): 14,
    (1000.0, inf, inf, 12.0): 10,
    (20.0, 1e4, 0.1, 0.0): 20,
    (100.0, 1e4, 1.0, 1e-3): 30,
    (300.0, 1e4, 9.0, 30.0): 32,
    (50.0, 1e4, 3.0, 100.0): 8,
    (9.0, 1e4, 0.5, 10.0): 4,
    (9.0, 10.0, 0.5, 100.0): 4,
    (40.0, 60.0, 5.0, 2.0): 6,
}
"""Many unstable modes, soft shear (k2 below 10), strong rotational drag (gamma3 of 10 and more)."""

COINCIDENT = [
    ((5.0, 1e4, 10.0), 0.0540375656, 2),
    ((0.0, 1e4, 10.0), 0.3585840775, 1),
    ((15.0, 100.0, 30.0), 0.1762093651, 2),
    ((-5.0, inf, 5.5), 0.0438525867, 0),
    ((8.0, 10.0, 5.0), 0.0075508001, 2),
    ((3.0, inf, 2.0), 0.0563053027, 2),
    ((30.0, 1e4, 100.0), 0.0814719379, 4),
    ((-5.0, 50.0, 20.0), 0.4114242901, 1),
]
"""((F, k1, k2), gamma3 in few digits, index): the eigenvalue of that index is w = -g nu/(c2 gamma3)."""


@cache
def coincident(F, k1, k2, guess):
    """gamma3 to 30 digits at which w = -g nu/(c2 gamma3), where P = 0, is an eigenvalue."""
    with mp.workdps(30):
        c2, nu = 1 / mp.mpf(k2), 1 - mp.mpf(F) / mp.mpf(k1)
        scale = -(nu + F * c2) * nu / c2

        def D(gamma3):
            return mp.re(reference.D(scale / gamma3, F, k1, k2, gamma3, 30))

        return mp.findroot(D, (mp.mpf(guess), mp.mpf(guess) * (1 + mp.mpf(10) ** -8)))
