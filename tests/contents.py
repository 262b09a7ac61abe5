"""Reads the contents of result files, to compare two files."""

from pathlib import Path

import h5py
import numpy as np


def content(path: Path) -> dict[str, np.ndarray]:
    """All variables of a file but the time they took."""
    with h5py.File(path) as file:
        return {name: file[name][...] for name in file if name != "seconds"}


def same(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> bool:
    """Whether two files contain the same, to the last bit."""
    return set(a) == set(b) and all(np.array_equal(a[n], b[n], equal_nan=a[n].dtype.kind == "f") for n in a)


def same_spectra(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> bool:
    """Whether two files of spectra agree as those of two BLAS kernels must.

    An eigenvalue is at most ten error estimates from the true one, so two are no farther from each other;
    what is counted or proved does not depend on rounding.
    """
    exact = ("status", "unstable_count", "certified")
    w = [c["growth_rate"] + 1j * c["frequency"] for c in (a, b)]
    bound = 10 * (a["error_estimate"] + b["error_estimate"])
    return all(np.array_equal(a[n], b[n]) for n in exact) and bool((np.abs(w[0] - w[1]) <= bound).all())
