"""Time scheme of the integration: PETSc's TS type, tolerances, and the corresponding PETSc options."""

from collections.abc import Mapping
from dataclasses import dataclass

CYCLE_OPTIONS_PREFIX = "cycle_"
"""Prefix of PETSc options with which a user overrides the time scheme, for example -cycle_ts_type bdf."""

EXTRAPOLATION_POINTS: Mapping[str, Mapping[int, tuple[tuple[int, ...], tuple[int, ...]]]] = {
    "3": {1: ((), (0, 1, 2)), 2: ((0, 1), (0, 2)), 3: ((1,), (0, 1, 2))},
    "4": {
        1: ((), (1, 3, 4)),
        2: ((0, 1), (2, 3)),
        3: ((1,), (0, 2, 4)),
        4: ((0, 2, 3), (0, 2)),
        5: ((1, 4), (4,)),
    },
    "5": {
        1: ((), (2, 3, 4, 6)),
        2: ((), (0, 3, 4, 6)),
        3: ((0, 2), (0, 2, 3)),
        4: ((0, 1, 2), ()),
        5: ((2, 4), (2, 5, 6)),
        6: ((3, 4, 5), (6,)),
        7: ((0, 4, 6), (3,)),
    },
}
"""Extrapolation points of each stage, by ARKIMEX type: {stage: (stages of this step, stages of the last
step)}. Stage 0 is the state at the start of a step. These sets had the smallest prediction errors of all sets
of up to six points, in two dozen motions, mostly of stiff rods."""


SNES_TYPE_BY_TS_TYPE: Mapping[str, str] = {
    "rosw": "ksponly",
    **dict.fromkeys(("arkimex", "dirk", "bdf", "theta", "beuler", "cn"), "shell"),
}
"""PETSc's SNES type for each TS type; "newtonls" for TS types not in this table. "shell" selects
`stage_newton`, which requires that the unknown of a stage is the state at which the right-hand side f of the
differential equation is evaluated; the TS type alpha, for example, has a different unknown."""


@dataclass(frozen=True, slots=True)
class TimeScheme:
    """Time scheme: `ts_type` is PETSc's TS type, `ts_sub_type` its sub-type (for bdf: its order).

    tolerance: local error per time step of each component of the state z, divided by the largest component of
    the initial state. newton_tolerance_ratio: Newton's method for a stage stops at the error
    newton_tolerance_ratio * tolerance. has_equal_steps: whether the step length is constant. options_prefix:
    prefix of the PETSc options that override the scheme."""

    ts_type: str = "arkimex"
    ts_sub_type: str = "5"
    tolerance: float = 5e-6
    newton_tolerance_ratio: float = 0.1
    has_equal_steps: bool = False
    options_prefix: str = CYCLE_OPTIONS_PREFIX

    def petsc_options(self, used_type: str) -> dict[str, str]:
        """PETSc options of this scheme, without prefix. used_type: TS type in use, which a user may have set
        in place of `self.ts_type`; `ts_sub_type` is then left out."""
        name_option = {"bdf": "order"}.get(used_type, "type")
        options = {"ts_type": self.ts_type}
        if used_type == self.ts_type and self.ts_sub_type:
            options[f"ts_{used_type}_{name_option}"] = self.ts_sub_type
        if used_type == "arkimex":
            # PETSc extrapolates the stages of the types that are not in `EXTRAPOLATION_POINTS`.
            by_petsc = "false" if self.ts_sub_type in EXTRAPOLATION_POINTS else "true"
            options |= {
                "ts_arkimex_fully_implicit": "true",
                "ts_arkimex_initial_guess_extrapolate": by_petsc,
            }
        adaptivity_options = (
            {"ts_adapt_type": "none"} if self.has_equal_steps else {"ts_adapt_dsp_filter": "PI42"}
        )
        return {
            "ksp_type": "preonly",
            "pc_type": "lu",
            "ts_adapt_type": "dsp",  # rejects almost no step, while `basic` rejects a tenth
            "ts_adapt_clip": "0.2,4.0",
            "snes_type": SNES_TYPE_BY_TS_TYPE.get(used_type, "newtonls"),
            "snes_linesearch_type": "basic",
            "snes_max_it": "20" if self.has_equal_steps else "10",
            **options,
            **adaptivity_options,
        }
