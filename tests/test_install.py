"""Agreement of the different ways to install rodsweep: clone, wheel, conda, images."""

import ast
import re
import sys
import tomllib
from importlib import import_module
from pathlib import Path

import h5py
import pytest
from conftest import ROOT
from ruamel.yaml import YAML

import rodsweep
from rodsweep.solve.backend.availability import add_debian_modules

SETTINGS = tomllib.loads((ROOT / "pyproject.toml").read_text())
PROJECT = SETTINGS["project"]
IMPORTED_AS = {"ruamel.yaml": "ruamel", "scikit-sundae": "sksundae", "pycont-lite": "pycont"}
"""Packages whose module has another name."""
OF_ANOTHER = {"llvmlite": "numba", "tornado": "bokeh", "markupsafe": "jinja2"}
"""Modules that are imported and come with a package that is required, with its name."""
COMPILED_FOR_NUMPY_1 = """
import sys


class Refusing:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            raise ValueError("numpy.dtype size changed, may indicate binary incompatibility")


sys.meta_path.insert(0, Refusing())
"""
"""What import of a module of Debian 12 raises under NumPy 2."""


def name(requirement: str) -> str:
    return re.split(r"[<>=~ ]", requirement)[0]


@pytest.mark.parametrize("extra", [None, "solvers", "test"])
def test_conda_environment_has_what_the_package_needs(extra):
    needed = PROJECT["optional-dependencies"][extra] if extra else PROJECT["dependencies"]
    environment = YAML(typ="safe").load(ROOT / "install" / "environment.yml")
    assert set(map(name, needed)) <= set(map(name, environment["dependencies"]))


@pytest.mark.parametrize("file", ["Containerfile", "apptainer.def"])
def test_images_copy_what_make_install_reads(file):
    text = (ROOT / "install" / file).read_text()
    for path in ("Makefile", "pyproject.toml", PROJECT["readme"], "LICENSE", "rodsweep"):
        assert re.search(rf"(COPY|^   ).* ?{path} ", text, re.MULTILINE), path


def test_make_install_compiles_what_the_package_has():
    modules = re.findall(r"^\twarm_up ([\w.]+)", (ROOT / "Makefile").read_text(), re.MULTILINE)
    assert len(modules) == 3
    for module in modules:
        assert callable(import_module(f"rodsweep.solve.{module}").warm_up)


def test_a_wheel_has_every_file_of_the_package():
    """Files beside the modules are in a wheel only if a pattern of the package data names them."""
    patterns = SETTINGS["tool"]["setuptools"]["package-data"]["rodsweep"]
    package = ROOT / "rodsweep"
    named = {path for pattern in patterns for path in package.glob(pattern)}
    there = {path for path in package.rglob("*") if path.is_file() and "__pycache__" not in path.parts}
    assert {path for path in there if path.suffix != ".py"} == named


def test_a_wheel_builds_no_petsc_unasked():
    solvers = {"petsc4py", "slepc4py", "mpi4py", "h5py"}
    assert not solvers & set(map(name, PROJECT["dependencies"]))
    assert set(map(name, PROJECT["optional-dependencies"]["solvers"])) == solvers


def imported() -> set[str]:
    """Modules from outside that the package imports, by their first name."""
    found = set()
    for path in (ROOT / "rodsweep").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                found |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
                found.add(node.module.split(".")[0])
    return found - set(sys.stdlib_module_names) - {"rodsweep", "benchmarks"}


def test_every_import_is_a_requirement_and_every_requirement_is_imported():
    """xarray imports h5netcdf by its name as an engine."""
    extras = PROJECT["optional-dependencies"]
    always, beside = (
        {IMPORTED_AS.get(each, each) for each in map(name, asked)}
        for asked in (PROJECT["dependencies"], extras["solvers"] + extras["explore"] + extras["bench"])
    )
    found = {OF_ANOTHER.get(module, module) for module in imported()}
    assert found <= always | beside
    assert always <= found | {"h5netcdf"}


def test_the_version_is_the_same_everywhere(command):
    version = rodsweep.__version__
    assert PROJECT["dynamic"] == ["version"]
    assert SETTINGS["tool"]["setuptools"]["dynamic"]["version"] == {"attr": "rodsweep.__version__"}
    assert command.afresh("--version").stdout == f"rodsweep, version {version}\n"
    command.write("c.yaml", "task: thresholds\nparameters: {k1: 200, k2: 1.0e+4, gamma3: 1.0e-4}\n")
    with h5py.File(command.solved("c.yaml")) as file:
        assert file.attrs["rodsweep_version"] == version
    assert f"; rodsweep {version}, PETSc" in command("show", "c.h5").stdout
    assert YAML(typ="safe").load(ROOT / "CITATION.cff")["version"] == version
    headings = re.findall(r"^## (.*)$", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert headings[0] == version


def debian(directory: Path, release: str, name: str = "petsc") -> Path:
    """A directory of Debian with a module of PETSc or SLEPc."""
    modules = directory / f"{name}dir" / release / "lib" / "python3" / "dist-packages"
    (modules / f"{name}4py").mkdir(parents=True)
    (modules / f"{name}4py" / "__init__.py").write_text("")
    return modules


def test_debians_newest_real_petsc_is_found(tmp_path, monkeypatch):
    """Not PETSc for complex numbers or long indices, nor an earlier release that sorts later as text."""
    monkeypatch.setattr(sys, "path", [])
    monkeypatch.setattr(sys, "path_importer_cache", {})
    monkeypatch.setattr(sys, "meta_path", [each for each in sys.meta_path if "Editable" not in str(each)])
    for each in ("petsc4py", "slepc4py"):
        monkeypatch.delitem(sys.modules, each, raising=False)
    monkeypatch.delenv("PETSC_DIR", raising=False)
    monkeypatch.delenv("SLEPC_DIR", raising=False)
    wanted = debian(tmp_path, "petsc3.18/x86_64-linux-gnu-real")
    for other in ("petsc3.9/x86_64-linux-gnu-real", "petsc3.18/x86_64-linux-gnu-complex"):
        debian(tmp_path, other)
    debian(tmp_path, "petsc64-3.18/x86_64-linux-gnu-real")
    slepc = debian(tmp_path, "slepc3.18/x86_64-linux-gnu-real", "slepc")
    add_debian_modules(tmp_path)
    assert sys.path == [str(wanted), str(slepc)]
    add_debian_modules(tmp_path)  # found by now
    assert sys.path == [str(wanted), str(slepc)]


def test_petsc_dir_is_respected(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "path", [])
    monkeypatch.delitem(sys.modules, "petsc4py", raising=False)
    monkeypatch.setenv("PETSC_DIR", "/opt/petsc")
    monkeypatch.setenv("SLEPC_DIR", "/opt/slepc")
    debian(tmp_path, "petsc3.18/x86_64-linux-gnu-real")
    add_debian_modules(tmp_path)
    assert sys.path == []


@pytest.mark.long
@pytest.mark.parametrize("module", ["petsc4py.lib", "h5py"])
def test_modules_compiled_for_another_numpy_are_refused_in_a_sentence(command, module):
    command.write("c.yaml", "task: thresholds\nparameters: {k1: 200, k2: 1.0e+4, gamma3: 1.0e-4}\n")
    done = command.afresh("run", "c.yaml", patch=COMPILED_FOR_NUMPY_1.format(module=module))
    assert (done.returncode, done.stderr.count("\n")) == (3, 1)
    assert "cannot be imported (numpy.dtype size changed" in done.stderr
    assert "on Debian 12 pip install 'rodsweep[debian12]'" in done.stderr
