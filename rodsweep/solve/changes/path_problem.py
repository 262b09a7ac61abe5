"""Eigenvalue problem of the straight rods along a path of one parameter: the interface, and uniform rods."""

from abc import ABC, abstractmethod

from ...determinant.certificate.first_boxes import path_intervals
from ...determinant.certificate.winding_number import EigenvalueCount, count_right_of
from ...determinant.parameter_path import Path, coefficients_at
from ...determinant.roots.newton import LocatedZero, double_newton, eigenvalue_newton
from ..spectrum.search import Spectrum, SpectrumRequest, solve_spectrum


class PathProblem(ABC):
    """Eigenvalues of the straight rods along a path, as functions of the path variable p."""

    def __init__(self, path: Path):
        self.path = path
        self.solves = 0
        """Number of eigenvalue problems solved so far."""
        self._spectra: dict[tuple[float, SpectrumRequest], Spectrum] = {}

    def spectrum(self, p: float, request: SpectrumRequest) -> Spectrum:
        """The leading eigenvalues of the rod at p, as `request` says; equal requests are solved once."""
        key = p, request
        if key not in self._spectra:
            self._spectra[key] = solve_spectrum(self.path.at(p), request)
            self.solves += 1
        return self._spectra[key]

    @abstractmethod
    def edges(self, low: float, high: float) -> list[float]:
        """Path variables from `low` to `high`, dense enough that neighbouring rods differ little."""

    @abstractmethod
    def eigenvalue(self, guess: complex, p: float) -> tuple[complex, complex, float]:
        """(eigenvalue w near `guess`, dw/dp, error of w) of the rod at p."""

    @abstractmethod
    def double(self, x: float, p: float, reach: float) -> LocatedZero:
        """The double real eigenvalue near w = x and path variable p, whose path variable differs from p by at
        most `reach`; nan if not found."""

    @abstractmethod
    def count(self, line: float, p: float) -> EigenvalueCount:
        """Number of eigenvalues with Re w > `line` of the rod at p."""

    def counted_amid(self, low: float, high: float) -> int | None:
        """Number of unstable modes already proved for some path variable between `low` and `high`; None if it
        is not.
        """
        return None

    @abstractmethod
    def relaxation(self, p: float) -> tuple[float, float]:
        """(a relaxation time of the rod at p that is smooth in p, the derivative of the time by p)."""


class UniformPath(PathProblem):
    """Eigenvalue problem along a path of uniform rods of linear material, whose D has a closed form."""

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
