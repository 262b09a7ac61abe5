"""Agreement of the different ways to install rodsweep."""

import re
import tomllib

import pytest
from conftest import ROOT
from ruamel.yaml import YAML

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


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
