"""The peers: other codes that are timed together with rodsweep, from the folder `benchmarks` of a checkout.

The folder is a Python package that is not installed with rodsweep. The package has the function

    versions() -> dict[str, str]

which returns the versions of the installed peers by name. For each study with peers, it has a module with the
name of the study and the function

    peers(quick: bool, folder: Path) -> PeerContribution

where `folder` is an empty directory for the programs that peers compile.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

from ..errors import InputError
from .study import Measurement, TimedMethod

PEERS_PACKAGE_NAME = "benchmarks"
"""Name of the folder of peers in a checkout, and name under which its package is imported from any folder."""
RODSWEEP_CHECKOUT_FOLDER = Path(__file__).parents[2]
"""Root folder of the checkout from which rodsweep runs. If rodsweep is installed without a checkout, the
folder that contains the package."""
PEER_PHRASES_BY_STUDY = {
    "spectrum": "LAPACK, ARPACK and Chebyshev collocation",
    "thresholds": "grids and root finding with SciPy, AUTO-07p and PyCont-Lite",
    "limit_cycle": "further integrators of PETSc, those of SciPy, CVODE and AUTO-07p",
}
"""Phrase that names the peers of each study, for a report without peers."""
MakePeerSection = Callable[[int], tuple[list[str], list[Measurement]]]
"""Comparison with separate tables: a function (number of rounds) -> (blocks of text, measurements)."""


@dataclass(frozen=True, slots=True)
class PeerContribution:
    """Contribution of the peers to one study."""

    contenders_by_race: Mapping[str, Sequence[TimedMethod]] = field(default_factory=dict)
    """Methods of the peers that take part in each race of the study, by name of the race; the same method
    with several settings, such as tolerances, from the coarsest to the finest."""
    section_functions: Sequence[MakePeerSection] = ()
    """Functions that make further comparisons, in addition to the races of the study."""
    contender_notes: Sequence[str] = ()
    """Sentences on the contenders, for the introduction of the report."""
    skipped_peer_sentences: Sequence[str] = ()
    """A sentence for each peer that is not installed."""

    def contenders_of_race(self, race: str) -> list[TimedMethod]:
        """Contenders of the race with the name `race`; empty if no peer takes part."""
        return list(self.contenders_by_race.get(race, ()))


NO_PEERS = PeerContribution()
"""Empty contribution, for a study without peers."""


def peer_package(directory: Path | None) -> ModuleType | None:
    """The Python package of the peers in the folder `directory`; raises InputError if the folder is not such
    a package.

    directory: None means the folder in the checkout from which rodsweep runs; the result is None if there is
    no checkout.
    """
    if directory is not None:
        return _import_directory(directory)
    package_path = RODSWEEP_CHECKOUT_FOLDER / PEERS_PACKAGE_NAME
    is_checkout = (RODSWEEP_CHECKOUT_FOLDER / "pyproject.toml").is_file() and (
        package_path / "__init__.py"
    ).is_file()
    return _import_directory(package_path) if is_checkout else None


def _import_directory(directory: Path) -> ModuleType:
    error = InputError(
        f"--peers {directory} must be the folder `{PEERS_PACKAGE_NAME}` of a checkout of rodsweep"
    )
    start = directory.resolve() / "__init__.py"
    imported = sys.modules.get(PEERS_PACKAGE_NAME)
    if imported is not None and imported.__file__ and Path(imported.__file__).resolve() == start:
        return imported
    spec = spec_from_file_location(PEERS_PACKAGE_NAME, start, submodule_search_locations=[str(start.parent)])
    if not start.is_file() or spec is None or spec.loader is None:
        raise error
    package = module_from_spec(spec)
    sys.modules[PEERS_PACKAGE_NAME] = package  # needed by imports in its modules
    spec.loader.exec_module(package)
    if not hasattr(package, "versions"):
        raise error
    return package


def peers_of_study(package: ModuleType | None, study: str, quick: bool, folder: Path) -> PeerContribution:
    """Contribution of the installed peers to the study with the name `study`. quick: whether the study uses
    fewer points and rounds. folder: empty directory in which programs are compiled. Returns NO_PEERS without
    a package, or if the package has no such study."""
    module = f"{PEERS_PACKAGE_NAME}.{study}"
    if package is None or find_spec(module) is None:
        return NO_PEERS
    peers: PeerContribution = import_module(module).peers(quick, folder)
    return peers


def left_out_peers_sentence(studies: Sequence[str]) -> str:
    """Sentence that names the missing peers of `studies`, for a run without the folder of peers; "" if these
    studies have no peers."""
    missing = "; ".join(
        f"{name}: {PEER_PHRASES_BY_STUDY[name]}" for name in studies if name in PEER_PHRASES_BY_STUDY
    )
    return missing and (
        f"The peers are left out ({missing}): give their folder, `{PEERS_PACKAGE_NAME}` of a checkout of "
        f"rodsweep, as `--peers CHECKOUT/{PEERS_PACKAGE_NAME}`."
    )
