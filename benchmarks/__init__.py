"""The peers of `rodsweep bench`: what one would otherwise use, timed beside rodsweep where it is installed.

A module of the name of each study that has peers; what they offer is said in `rodsweep.bench.peers`. They are
no part of the package: nothing in it imports from here but the command `rodsweep bench`.
"""

import shutil
import subprocess
from importlib.metadata import PackageNotFoundError, version

PACKAGES = ("scipy", "pycont-lite", "scikit-sundae")


def versions() -> dict[str, str]:
    """Of the peers that are installed; AUTO-07p does not tell its own, but Debian's package does."""
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
