"""Wave number of the eigenfunctions of any rod."""

from ..model.rod import Rod
from .arm.determinant import arm_determinant
from .value import newton_correction


def wave_number(rod: Rod, w: complex) -> float:
    """Largest |q| of the exponents exp(+-q u) of the mode with eigenvalue w, in 1/L; its mean for an arm."""
    return newton_correction(w, rod.coefficients)[2] if rod.standard else arm_determinant(rod).wave_number(w)
