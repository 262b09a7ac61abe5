"""Eigenvalue problem of the straight rods along a path of one parameter: the interface, and uniform rods."""

from abc import ABC, abstractmethod

from ...determinant.certificate.first_crossing_boxes import path_intervals_of_bounded_change
from ...determinant.certificate.winding_number import EigenvalueCount, count_right_of
from ...determinant.parameter_path import ParameterPath, coefficients_at
from ...determinant.roots.newton import (
    LocatedEigenvalue,
    double_eigenvalue_by_newton,
    eigenvalue_with_slope_and_error,
)
from ..spectrum.search import Spectrum, SpectrumRequest, solve_spectrum


class PathEigenproblem(ABC):
    """Eigenvalues of the straight rods along a path, as functions of the path variable p."""

    def __init__(self, path: ParameterPath):
        self.path = path
        self.solve_count = 0
        """Number of eigenvalue problems solved so far."""
        self._spectra: dict[tuple[float, SpectrumRequest], Spectrum] = {}

    def spectrum(self, p: float, request: SpectrumRequest) -> Spectrum:
        """The spectrum of the rod at path variable p for `request`, solved once and stored."""
        key = p, request
        if key not in self._spectra:
            self._spectra[key] = solve_spectrum(self.path.rod_at(p), request)
            self.solve_count += 1
        return self._spectra[key]

    @abstractmethod
    def interval_edges(self, low: float, high: float) -> list[float]:
        """Path variables from `low` to `high`, both included, so close that the spectra of neighbours differ
        little."""

    @abstractmethod
    def eigenvalue_with_slope_and_error(self, guess: complex, p: float) -> tuple[complex, complex, float]:
        """Returns (eigenvalue w near `guess`, dw/dp, error of w) of the rod at p."""

    @abstractmethod
    def double_eigenvalue(self, x: float, p: float, expected_distance: float) -> LocatedEigenvalue:
        """The double real eigenvalue near w = x at a path variable within `expected_distance` of p; its path
        variable is nan if no double eigenvalue is found."""

    @abstractmethod
    def count_right_of(self, line: float, p: float) -> EigenvalueCount:
        """Number of eigenvalues with Re w > `line` of the rod at p."""

    def known_unstable_count_near_middle(self, low: float, high: float) -> int | None:
        """Number of unstable modes already proved at a path variable near the middle between `low` and
        `high`; None if no such number is known."""
        return None

    def relaxation_time_and_slope(self, p: float) -> tuple[float, float]:
        """Returns (T, dT/dp): unit of time T at p, smooth in p, by which eigenvalues are multiplied so that
        they stay moderate along the path. Here T = 1, which leaves the eigenvalues unchanged."""
        return 1.0, 0.0


class UniformPath(PathEigenproblem):
    """Eigenvalue problem along a path of uniform rods of linear material, whose D has a closed form."""

    def interval_edges(self, low: float, high: float) -> list[float]:
        return [a for a, _ in path_intervals_of_bounded_change(self.path, low, high)] + [high]

    def eigenvalue_with_slope_and_error(self, guess: complex, p: float) -> tuple[complex, complex, float]:
        coefficients = coefficients_at(p, self.path.origin, self.path.direction)
        return eigenvalue_with_slope_and_error(guess, coefficients, self.path.direction)

    def double_eigenvalue(self, x: float, p: float, expected_distance: float) -> LocatedEigenvalue:
        return double_eigenvalue_by_newton(x, p, self.path.origin, self.path.direction, expected_distance)

    def count_right_of(self, line: float, p: float) -> EigenvalueCount:
        return count_right_of(line, self.path.rod_at(p))

    def relaxation_time_and_slope(self, p: float) -> tuple[float, float]:
        coefficients = coefficients_at(p, self.path.origin, self.path.direction)
        direction = self.path.direction
        # Along a path the eigenvalues may grow without bound; multiplied by the time they stay moderate.
        time = coefficients.nu * coefficients.nu + coefficients.c2 + coefficients.gamma3  # never zero
        return time, 2 * coefficients.nu * direction.nu + direction.c2 + direction.gamma3
