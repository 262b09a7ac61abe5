"""The closed form of D against independent evaluations in multiple precision, and exact limits."""

import shutil

import mpmath as mp
import numpy as np
import pytest
from reference import determinant as reference

from rodsweep.model import compilation
from rodsweep.model.determinant import newton_correction, scaled_determinant
from rodsweep.model.rod import Rod


def cases():
    """Random rods and random w, far beyond where eigenvalues lie."""
    random = np.random.default_rng(7)
    for i in range(60):
        k1, k2 = (
            float(10 ** random.uniform(1.3, 12)) if random.random() > 0.15 else np.inf for _ in range(2)
        )
        gamma3 = float(random.choice([0.0, 10 ** random.uniform(-8, 0.5)]))
        F = float(random.uniform(-0.5, 0.999) * min(k1, 300.0))
        w = complex(*(random.normal(size=2) * 10 ** random.uniform(-3, 5)))
        yield pytest.param(w, Rod(F, k1, k2, gamma3), id=str(i))


@pytest.mark.parametrize(("w", "rod"), list(cases()))
@pytest.mark.parametrize("evaluation", [reference.D, reference.D_wedge])
def test_determinant_is_right_to_rounding(w, rod, evaluation):
    value, slope, scale, noise = scaled_determinant(w, rod.coefficients)
    parameters = (rod.F, rod.k1, rod.k2, rod.gamma3)
    exact = evaluation(w, *parameters) * mp.exp(-mp.mpf(scale))
    assert abs(mp.mpc(value) - exact) < noise
    with mp.workdps(40):
        h = mp.mpf(10) ** -12 * abs(w)
        exact = (evaluation(w + h, *parameters) - evaluation(w - h, *parameters)) / (2 * h)
        assert abs(mp.mpc(slope) - exact * mp.exp(-mp.mpf(scale))) < 1e-11 * abs(slope) + 1e3 * noise / abs(w)


def test_determinant_is_one_at_rest():
    """D(0) = 1 for every rod: there is no static instability (a follower force never buckles a rod)."""
    for rod in (Rod(30, 1e4, 1e4, 1e-4), Rod(-50, 100, 20, 0.0), Rod(30, np.inf, np.inf, 0.0)):
        assert scaled_determinant(0j, rod.coefficients)[0] == pytest.approx(
            np.exp(-scaled_determinant(0j, rod.coefficients)[2]), rel=1e-12
        )


def test_filament_roots_are_those_of_the_cantilever():
    """F = 0, rigid in stretch and shear: w = -b^4 with cosh b cos b = -1, the clamped-free beam."""
    rod = Rod(0.0, np.inf, np.inf, 0.0)
    for n in range(1, 5):
        b = mp.findroot(lambda b: mp.cosh(b) * mp.cos(b) + 1, (n - 0.5) * mp.pi)
        w = float(-(b**4))
        assert newton_correction(complex(w), rod.coefficients)[0] < 1e-13 * abs(w)


def test_newton_correction_is_the_distance_to_the_root():
    rod = Rod(30.0, 1e4, 1e4, 1e-4)
    root = complex(reference.refine(mp.mpc(-54.3, 145.7), 30, 1e4, 1e4, 1e-4))
    for distance in (1e-3, 1e-6j, 1e-9 - 1e-9j):
        found = newton_correction(root + distance, rod.coefficients)[0]
        assert found == pytest.approx(abs(distance), rel=1e-2)


def test_compiled_code_is_kept_for_one_content_of_the_sources(tmp_path, monkeypatch):
    """A change in a module whose formulas are inlined elsewhere must not meet old compiled code."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    copy = tmp_path / "rodsweep"
    for name in compilation.COMPILED_IN:
        shutil.copytree(compilation.PACKAGE / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(compilation, "PACKAGE", copy)
    before = compilation.cache_directory()
    assert before == compilation.cache_directory()
    assert copy in before.parents
    discs = copy / "solve" / "discs.py"
    discs.write_text(discs.read_text() + "# changed\n")
    assert compilation.cache_directory() != before
    monkeypatch.setenv("NUMBA_CACHE_DIR", "/elsewhere")
    assert str(compilation.cache_directory()).startswith("/elsewhere/compiled-")
