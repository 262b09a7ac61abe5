"""A time scheme as data: which of PETSc's, how accurate, and the options that make it so."""

from dataclasses import dataclass

CYCLE_PREFIX = "cycle_"
"""Prefix of the PETSc options that override the scheme, as in -cycle_ts_type bdf."""


@dataclass(frozen=True, slots=True)
class TimeScheme:
    """PETSc's TS type and sub-type (for bdf: its order) and what it is to reach.

    tolerance: local error per step of each component of z, absolute, in units of the motion's size.
    newton: error of a stage in units of the tolerance. equal_steps: no step control, each step as given.
    prefix: of the PETSc options that override.
    """

    family: str = "arkimex"
    variant: str = "5"
    tolerance: float = 5e-6
    newton: float = 0.1
    equal_steps: bool = False
    prefix: str = CYCLE_PREFIX

    def petsc_options(self, family: str) -> dict[str, str]:
        """The options, without prefix, of this scheme where the TS type is `family`."""
        kind = {"bdf": "order"}.get(family, "type")
        own = {"ts_type": self.family}
        if family == self.family and self.variant:
            own[f"ts_{family}_{kind}"] = self.variant
        if family == "arkimex":
            own |= {"ts_arkimex_fully_implicit": "true", "ts_arkimex_initial_guess_extrapolate": "true"}
        adapt = {"ts_adapt_type": "none"} if self.equal_steps else {"ts_adapt_dsp_filter": "PI42"}
        return {
            "ksp_type": "preonly",
            "pc_type": "lu",
            "ts_adapt_type": "dsp",  # rejects next to nothing, where `basic` rejects a tenth
            "ts_adapt_clip": "0.2,4.0",
            "snes_type": "ksponly" if family == "rosw" else "newtonls",
            "snes_linesearch_type": "basic",
            "snes_max_it": "20" if self.equal_steps else "10",
            **own,
            **adapt,
        }
