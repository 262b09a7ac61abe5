"""Which BLAS kernels computed a file: recorded, kept over runs and merges, told where they are several."""

import kernels
import pytest
from contents import content, same_spectra
from kernels import other_kernels

from rodsweep.results.file.provenance import (
    BLAS_KERNELS_ATTRIBUTE,
    blas_kernels_in,
    merged_blas_kernels,
    several_blas_kernels_warning,
)
from rodsweep.results.file.view import read_view
from rodsweep.solve.backend import petsc as blas_module
from rodsweep.solve.backend.petsc import blas_description

SPECTRA = """
task: spectrum
parameters:
  F: {start: 0, stop: 60, num: 11}
  k1: [100, 1.0e4, .inf]
  k2: 1.0e4
  gamma3: [0, 1.0e-4]
"""


def library(path, api="openblas", version="0.3.21", architecture="Haswell"):
    known = {"user_api": "blas", "internal_api": api, "version": version, "filepath": path}
    return known | ({"architecture": architecture} if architecture else {})


OPENMP = {
    "user_api": "openmp",
    "internal_api": "openmp",
    "version": None,
    "filepath": "/usr/lib/libgomp.so.1",
}
SYSTEM, WHEEL, SCIPY = "/usr/lib/libopenblas.so.0", "/v/site-packages/numpy.libs/a.so", "/v/scipy.libs/b.so"


@pytest.mark.parametrize(
    ("loaded", "said"),
    [
        ([OPENMP, library(SYSTEM), library(WHEEL)], "openblas 0.3.21 Haswell"),
        (
            [library(WHEEL, version="0.3.23"), library(SYSTEM)],
            "PETSc openblas 0.3.21 Haswell, NumPy openblas 0.3.23 Haswell",
        ),
        ([library(SYSTEM)], "openblas 0.3.21 Haswell"),  # NumPy uses the system's
        ([library("/opt/libmkl_rt.so.2", "mkl", "2024.1", None)], "mkl 2024.1"),
        ([library(WHEEL)], "PETSc unknown, NumPy openblas 0.3.21 Haswell"),
        ([library(SYSTEM), library(SCIPY, version="0.3.27")], "openblas 0.3.21 Haswell"),
        (
            [library(SYSTEM), library("/usr/lib/libblis.so.4", "blis", "0.9.0", "zen3")],
            "blis 0.9.0 zen3 and openblas 0.3.21 Haswell",
        ),
        ([OPENMP], "unknown"),
    ],
)
def test_libraries_are_named_by_who_uses_them(monkeypatch, loaded, said):
    monkeypatch.setattr(blas_module, "threadpool_info", lambda: loaded)
    assert blas_description() == said


def test_kernels_of_several_runs_are_kept_once_each():
    assert merged_blas_kernels(["b", "a"], ["a"]) == "a\nb"
    assert blas_kernels_in({BLAS_KERNELS_ATTRIBUTE: "a\nb"}) == ["a", "b"]
    assert blas_kernels_in({}) == ["unknown"], "an earlier version did not ask"
    assert several_blas_kernels_warning("a") == ""
    assert "2 BLAS kernels (a; b)" in several_blas_kernels_warning("a\nb")


@pytest.fixture(scope="module")
def others():
    """Another kernel than the one in use, and how its BLAS calls it."""
    found = other_kernels(most=1)
    if not found:
        pytest.skip("this BLAS has no other kernel to choose here")
    return found


@pytest.mark.long
def test_one_kernel_is_recorded_and_nothing_said(command):
    command.write("c.yaml", SPECTRA)
    run = command("run", "c.yaml", "--shard", "1/2", "-o", "c.h5")
    again = command("run", "c.yaml", "-o", "c.h5", ranks=2)
    assert "BLAS" not in run.stdout + again.stdout
    assert blas_kernels_in(read_view(command.directory / "c.h5").attributes) == [blas_description()]
    assert blas_description() in command("show", "c.h5").stdout


@pytest.mark.long
def test_other_kernel_is_told_on_resume_and_merge_and_gives_the_same_numbers(command, others, monkeypatch):
    command.write("c.yaml", SPECTRA)
    assert command("run", "c.yaml", "-o", "plain.h5").returncode == 0
    assert command("run", "c.yaml", "--shard", "1/2", "-o", "resumed.h5").returncode == 0
    assert command("run", "c.yaml", "--shard", "1/2", "-o", "part.h5").returncode == 0
    monkeypatch.setenv("OPENBLAS_CORETYPE", next(iter(others)))
    resumed = command.afresh("run", "c.yaml", "-o", "resumed.h5")
    assert command.afresh("run", "c.yaml", "--shard", "2/2", "-o", "other.h5").returncode == 0
    merged = command("merge", "merged.h5", "part.h5", "other.h5")
    plain = content(command.directory / "plain.h5")
    for name, run in (("resumed.h5", resumed), ("merged.h5", merged)):
        assert run.returncode == 0, run.stderr
        assert run.stdout.count(f"{name}: computed in parts by 2 BLAS kernels") == 1
        attributes = read_view(command.directory / name).attributes
        assert set(blas_kernels_in(attributes)) == {blas_description(), next(iter(others.values()))}
        assert same_spectra(content(command.directory / name), plain)
    # Later runs that compute nothing, or nothing else, change nothing of it.
    assert "BLAS" not in command("run", "c.yaml", "-o", "merged.h5").stdout


@pytest.mark.parametrize(("words", "fails"), [((), False), (("another",), True), (("Haswell",), True)])
def test_where_no_other_kernel_runs_those_who_want_one_fail(monkeypatch, words, fails):
    monkeypatch.setattr(kernels, "blas_under", lambda _, **variables: "" if variables else "reference BLAS")
    assert bool(kernels.main(*words)) is fails
