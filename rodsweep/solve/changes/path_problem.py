"""The transverse eigenvalue problem along a path of one parameter, for uniform rods."""

from abc import ABC, abstractmethod

from ...determinant.certificate.first_boxes import path_intervals
from ...determinant.certificate.winding_number import EigenvalueCount, count_right_of
from ...determinant.parameter_path import Path, coefficients_at
from ...determinant.roots.newton import LocatedZero, double_newton, eigenvalue_newton
from ..spectrum.search import Spectrum, SpectrumRequest, solve_spectrum


class PathProblem(ABC):
    """Eigenvalues of the rods along a path; p is the path variable."""

    def __init__(self, path: Path):
        self.path = path
        self.solves = 0
        """Number of solved eigenproblems."""
        self._spectra: dict[tuple[float, SpectrumRequest], Spectrum] = {}

    def spectrum(self, p: float, request: SpectrumRequest) -> Spectrum:
        """The leading eigenvalues at p; each request is solved once."""
        key = p, request
        if key not in self._spectra:
            self._spectra[key] = solve_spectrum(self.path.at(p), request)
            self.solves += 1
        return self._spectra[key]

    @abstractmethod
    def edges(self, low: float, high: float) -> list[float]:
        """Places from low to high, with little change of the rods between neighbours."""

    @abstractmethod
    def eigenvalue(self, guess: complex, p: float) -> tuple[complex, complex, float]:
        """(eigenvalue near the guess, its slope by p, its error) at p."""

    @abstractmethod
    def double(self, x: float, p: float, reach: float) -> LocatedZero:
        """The double real eigenvalue near (x, p) with p at most `reach` away; nan if not found."""

    @abstractmethod
    def count(self, line: float, p: float) -> EigenvalueCount:
        """Number of eigenvalues with Re w > line at p."""

    def counted_amid(self, low: float, high: float) -> int | None:
        """Number of unstable modes already proved at some place between low and high; None without such a
        place.
        """
        return None

    @abstractmethod
    def relaxation(self, p: float) -> tuple[float, float]:
        """(a relaxation time of the rod, smooth along the path, its slope by p)."""


class UniformPath(PathProblem):
    """Path of uniform rods of linear material, with D in closed form."""

    def edges(self, low: float, high: float) -> list[float]:
        return [a for a, _ in path_intervals(self.path, low, high)] + [high]

    def eigenvalue(self, guess: complex, p: float) -> tuple[complex, complex, float]:
        coefficients = coefficients_at(p, self.path.origin, self.path.direction)
        return eigenvalue_newton(guess, coefficients, self.path.direction)

    def double(self, x: float, p: float, reach: float) -> LocatedZero:
        return double_newton(x, p, self.path.origin, self.path.direction, reach)

    def count(self, line: float, p: float) -> EigenvalueCount:
        return count_right_of(line, self.path.at(p))

    def relaxation(self, p: float) -> tuple[float, float]:
        here = coefficients_at(p, self.path.origin, self.path.direction)
        rate = self.path.direction
        # Along a path the eigenvalues may grow without bound; in units of such a time they stay moderate.
        time = here.nu * here.nu + here.c2 + here.gamma3  # never zero
        return time, 2 * here.nu * rate.nu + rate.c2 + rate.gamma3
