"""Config of the task spectrum: leading eigenvalues of the straight rod at every point."""

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

from pydantic import model_validator

from ...model.parameters import NON_OPTIONAL_LINEAR_PARAMETER_NAMES
from ..base_config import LinearConfig, ModeCount, NodeCount
from ..values import StrictConfigSection


class SpectrumOptions(StrictConfigSection):
    """Options of the task spectrum: number of eigenvalues at each point, method, and stored eigenvectors."""

    modes: ModeCount = 4
    """Number of leading eigenvalues at each point."""
    method: Literal["determinant", "krylov_schur"] = "determinant"
    """Method: roots of D, or Krylov-Schur on two meshes, which does not prove that no eigenvalue is
    missing."""
    certify: bool = True
    """Prove by the winding number of D that no eigenvalue is missing."""
    vectors: bool = False
    """Store the eigenvectors (Y, Theta), scaled to Y(1) = 1, with an error of about `accuracy`."""
    nodes: NodeCount = 33
    """Number of Lobatto nodes of (Y, Theta); used if `vectors` is true."""
    follow: bool = True
    """Follow eigenvalues along the longest axis of a grid; needs `certify: true` and `vectors: false`."""
    longitudinal: bool = False
    """Add the longitudinal modes: -(k1/gamma1) (pi (n - 1/2))^2 for a uniform rod of linear material."""


class SpectrumConfig(LinearConfig):
    """The task spectrum computes the leading eigenvalues of the straight rod at every point."""

    task: Literal["spectrum"]
    spectrum: SpectrumOptions = SpectrumOptions()

    nonlinear_parameters_used: ClassVar[tuple[str, ...]] = ("gamma1",)
    """gamma1, on which the longitudinal eigenvalues depend."""

    @classmethod
    def rod_parameters_used(cls, options: Mapping[str, Any]) -> tuple[str, ...]:
        return (
            (*NON_OPTIONAL_LINEAR_PARAMETER_NAMES, *cls.nonlinear_parameters_used)
            if options.get("longitudinal")
            else NON_OPTIONAL_LINEAR_PARAMETER_NAMES
        )

    @property
    def remedies_of_options_without_effect(self) -> dict[str, str]:
        required_settings = {} if self.spectrum.vectors else {"nodes": "vectors: true"}
        if self.spectrum.method == "krylov_schur":
            required_settings |= dict.fromkeys(("certify", "follow"), "method: determinant")
        return required_settings

    @property
    def certifies(self) -> bool:
        """Whether the task must prove by the winding number of D that no leading eigenvalue is missing."""
        return self.spectrum.certify and self.spectrum.method == "determinant"

    @property
    def follows_eigenvalues(self) -> bool:
        """Whether eigenvalues are followed along an axis: only on grids, with certified spectra and without
        eigenvectors."""
        return self.spectrum.follow and self._could_follow

    @property
    def _could_follow(self) -> bool:
        return self.certifies and not (self.spectrum.vectors or self.parameters.is_list)

    @property
    def settings_of_results(self) -> dict[str, Any]:
        settings = super().settings_of_results
        if "follow" in settings["spectrum"] and not self._could_follow:  # `follow` then has no effect
            settings["spectrum"]["follow"] = True
        return settings

    @model_validator(mode="after")
    def _refuse_unused_keys(self) -> "SpectrumConfig":
        self.parameters.require_one_definition_of_points(self.parameter_names)
        if "gamma1" in self.parameters.constant_parameters and not self.spectrum.longitudinal:
            raise ValueError(
                "parameters.gamma1 is given but not used: the transverse spectrum does not depend on gamma1; "
                "remove it or set spectrum.longitudinal: true"
            )
        if self.spectrum.longitudinal and "gamma1" not in self.parameters.constant_parameters:
            raise ValueError("parameters.gamma1 is missing; spectrum.longitudinal: true needs it")
        self.refuse_options_without_effect()
        return self
