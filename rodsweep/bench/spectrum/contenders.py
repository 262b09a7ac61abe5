"""The methods of the spectrum benchmark and their sizes, each from the cheapest."""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

from ..lapack import Eigenvalues
from ..study import Contender
from .other_discretizations import chebyshev_first_order, chebyshev_qz, displacement_elements
from .same_pencil import dense_inverse, dense_qz, krylov_schur, lapack_on_d, own_spectrum, scipy_eigs

ORDERS = (8, 10, 12, 14, 16, 18, 20, 24, 28, 32, 40, 56, 80)
INTERVALS = (10, 12, 14, 16, 18, 20, 22, 24, 28, 32, 40, 56, 80)
START_ORDERS = (8, 10, 11, 12, 14, 18, 24, 32, 40)
"""Of meshes whose eigenvalues are refined on D."""
PLAIN, PROVED = "rodsweep, certificate off", "rodsweep, certificate on"
THIS_TOOL, PENCIL, OTHER_MESH, ROOTS_OF_D = (
    "this tool",
    "the same pencil",
    "other discretisations",
    "roots of D",
)


class Peer(NamedTuple):
    """What a user would write instead, and the group it belongs to in a figure."""

    name: str
    group: str
    solve: Callable[..., Eigenvalues]
    sizes: tuple[int, ...]


PEERS = (
    Peer("Krylov-Schur alone, same pencil", PENCIL, krylov_schur, ORDERS),
    Peer("dense LAPACK QZ, same pencil", PENCIL, dense_qz, ORDERS),
    Peer("dense LAPACK LU and geev, same pencil", PENCIL, dense_inverse, ORDERS),
    Peer("SciPy eigs (ARPACK), same pencil", PENCIL, scipy_eigs, ORDERS),
    Peer("displacement spectral elements, geev", OTHER_MESH, displacement_elements, ORDERS),
    Peer("Chebyshev collocation, QZ", OTHER_MESH, chebyshev_qz, INTERVALS),
    Peer("Chebyshev, first-order system, QZ", OTHER_MESH, chebyshev_first_order, INTERVALS),
    Peer("LAPACK on a coarse mesh, Newton on D", ROOTS_OF_D, lapack_on_d, START_ORDERS),
)


def contenders(stride: int = 1) -> list[Contender]:
    """This tool, and the peers at each stride-th of their sizes."""
    return [
        Contender(PLAIN, "", THIS_TOOL, partial(own_spectrum, certify=False)),
        Contender(PROVED, "", THIS_TOOL, partial(own_spectrum, certify=True)),
        *(
            Contender(peer.name, str(size), peer.group, partial(peer.solve, size=size))
            for peer in PEERS
            for size in peer.sizes[::stride]
        ),
    ]
