"""Runs the tests marked `kernel` under OpenBLAS kernels different from the default.

    python tests/kernels.py [KERNEL...|another]

OpenBLAS uses the kernel named by OPENBLAS_CORETYPE, even if the processor cannot run it; therefore each
kernel is tried first in a process of its own. The default kernel cannot be inferred from the processor,
because an old OpenBLAS falls back to Prescott on a newer processor. `another` selects the first kernel that
is not the default.
"""

import os
import platform
import subprocess
import sys
from collections.abc import Mapping
from itertools import islice

ROUNDING_APART = {
    "x86_64": ("Prescott", "Haswell", "SkylakeX"),  # SSE3 without fused multiply-add, AVX2 with it, AVX-512
    "aarch64": ("ARMV8", "NEOVERSEN1"),
}
"""Kernels that add in different orders, by architecture; nearly every other one is a copy of one of these."""
ANOTHER = "another"
TRY = """
import numpy as np
from rodsweep.model.rod import Rod
from rodsweep.solve.backend.petsc import blas_description
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum

found = solve_spectrum(Rod(F=2000.0, k1=1e4, k2=1e4, gamma3=1e-4), SpectrumRequest(4, 1e-10, True))
assert abs(found.eigenvalues[0].real - 965025.548182) < 1e-6
assert np.allclose(np.linalg.inv(np.eye(200) + np.ones((200, 200))) @ np.full(200, 201.0), 1.0)
print(blas_description())
"""
"""Says which BLAS and kernel are in use, after they have given the right numbers."""


def blas_under(environment: Mapping[str, str], **variables: str) -> str:
    """What BLAS says of itself in an environment with further variables; empty where it does not run."""
    words = [sys.executable, "-c", TRY]
    tried = subprocess.run(
        words, env=dict(environment) | variables, capture_output=True, text=True, check=False
    )
    return "" if tried.returncode else tried.stdout.strip()


def other_kernels(
    wanted: tuple[str, ...] = (), environment: Mapping[str, str] = os.environ, most: int | None = None
) -> dict[str, str]:
    """What BLAS says of itself, by kernel, of those that run here and are not the one in use.

    most: number of kernels after which no further one is tried, in a process of its own.
    """
    names = wanted or ROUNDING_APART.get(platform.machine(), ())
    used = blas_under(environment)
    tried = ((name, blas_under(environment, OPENBLAS_CORETYPE=name)) for name in names)
    return dict(islice(((name, said) for name, said in tried if said not in ("", used)), most))


def main(*wanted: str) -> int:
    """Runs the tests; returns the worst exit status."""
    names, most = ((), 1) if wanted == (ANOTHER,) else (wanted, None)
    used, others = blas_under(os.environ), other_kernels(names, most=most)
    if not used:
        print("the BLAS in use gives wrong numbers or none: the tests say more")
        return 1
    print(f"in use: {used}")
    for name in names:
        if name not in others:
            print(f"{name} is no other kernel that runs here")
    if not others:
        print("no other kernel to choose: this BLAS is not OpenBLAS, or was built with one kernel only")
        return bool(wanted)
    worst = 0
    for name, said in others.items():
        print(f"under OPENBLAS_CORETYPE={name}: {said}", flush=True)
        words = [sys.executable, "-m", "pytest", "-q", "-m", "kernel"]
        run = subprocess.run(words, env=os.environ | {"OPENBLAS_CORETYPE": name}, check=False)
        worst = max(worst, run.returncode)
    return worst


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
