"""Peers of `rodsweep bench`: codes that a user might choose instead of rodsweep, timed if they are installed.

Every study with peers has a subpackage of its name. `rodsweep.bench.peers` documents the functions that a
subpackage offers. The peers do not belong to the package rodsweep: only the command `rodsweep bench` imports
them.
"""

import shutil
import subprocess
from importlib.metadata import PackageNotFoundError, version

PACKAGES = ("scipy", "pycont-lite", "scikit-sundae")
"""Python packages of the peers, by their names on PyPI."""


def versions() -> dict[str, str]:
    """Version of every installed peer, by name. AUTO-07p does not state its version: Debian's is reported."""
    found = {}
    for name in PACKAGES:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    if query := shutil.which("dpkg-query"):
        words = [query, "-W", "-f", "${Version}", "auto-07p"]
        auto = subprocess.run(words, capture_output=True, text=True, check=False).stdout
        found |= {"auto-07p": auto} if auto else {}
    return found
