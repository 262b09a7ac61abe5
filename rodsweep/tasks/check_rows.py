"""Rows and sentences of the output of `rodsweep check` that several tasks share: on points, rods and arms."""

from collections.abc import Callable, Mapping

import numpy as np

from ..config.base_config import Config
from ..discretization.elements.elements import Elements
from ..model.material.profile import Profile
from ..model.parameters import PARAMETERS, Parameter
from ..sweep.points.points import Points
from ..wording import counted
from .protocol import CheckRow


def search_end_below_crushing_clause(config: Config) -> str:
    """Clause stating that a search along F ends below the crushing force (zero stretch); empty if no force
    crushes the arm."""
    if config.is_uniform_and_linear:
        return ", or to just below k1"
    can_be_crushed = np.isfinite(config.rod_material.constitutive_law.crushing_load)
    return ", or to just below the force that crushes the weakest section" * bool(can_be_crushed)


def point_count_text(points: Points) -> str:
    """Text with the number of points and the shape of their grid: "50 points (a grid of 5 x 10)"."""
    if points.axes and points.count == 1:
        return "1 point"
    points_kind = (
        f"a grid of {' x '.join(str(length) for length in points.shape)}" if points.axes else "a list"
    )
    if points.arm_axes:
        points_kind = f"{points_kind}: {' x '.join(points.arm_axes)}"
    return f"{counted(points.count, 'point')} ({points_kind})"


def point_count_text_with_clause(points: Points, clause: str) -> str:
    """Text with the number of points and what `clause` says about each of them: "50 points (a list), each
    searched from ..."."""
    return f"{point_count_text(points)}, {'each ' * (points.count > 1)}{clause}"


def stretch_shear_and_drag_rows(columns: Mapping[str, np.ndarray]) -> list[CheckRow]:
    """Rows of `check` on stretch, shear and rotational drag.

    columns: values of the rods' parameters by name, arrays of any shape.
    """
    has_rotational_drag = bool((columns["gamma3"] > 0).any())
    return [
        *(
            _deformation_row(parameter, columns[parameter.name])
            for parameter in PARAMETERS.values()
            if parameter.rigid_adjective
        ),
        ("rotational drag", has_rotational_drag, "gamma3 > 0" if has_rotational_drag else "gamma3 = 0"),
    ]


def varying_arm_and_law_rows(config: Config, columns: Mapping[str, np.ndarray]) -> list[CheckRow]:
    """Rows of the table of `rodsweep check` on quantities that vary along the arm, and on the constitutive
    law.

    Empty for uniform arms of linear material. columns: values of the rods' parameters by name, arrays of any
    shape.
    """
    if config.is_uniform_and_linear:
        return []
    shape_texts = _taper_and_profile_texts(config, columns)
    return [
        ("variation along the arm", bool(shape_texts), " with ".join(shape_texts) or "uniform"),
        ("law", True, _law_and_section_text(config)),
    ]


def arms_line(
    config: Config, columns: Mapping[str, np.ndarray], first_mesh: Callable[[], Elements | None]
) -> str:
    """Line of `check` on the shape, the law and the initial mesh of arms that are not uniform or not of
    linear material.

    Empty for all other arms. columns: values of the rods' parameters by name, arrays of any shape.
    first_mesh: function that returns the finest initial mesh, or None.
    """
    if config.is_uniform_and_linear:
        return ""
    shape_texts = _taper_and_profile_texts(config, columns) or ["a uniform arm"]
    if len(shape_texts) == 1 and shape_texts[0].startswith(("a profile", "a smooth profile")):
        shape_texts = ["an arm", *shape_texts]
    arms_text = f"{' with '.join(shape_texts)} of {_law_and_section_text(config)}"
    mesh = first_mesh()
    if mesh is None:
        return arms_text
    elements_text = counted(mesh.element_count, "element")
    has_several_arms = any(len(np.unique(column)) > 1 for column in columns.values())
    mesh_text = f"the first mesh{' of the hardest arm' * has_several_arms}"
    return f"{arms_text}; {mesh_text} has {elements_text} of order {mesh.order}"


def _taper_and_profile_texts(config: Config, columns: Mapping[str, np.ndarray]) -> list[str]:
    """Texts on the tapers and the profile of the arms; empty for uniform arms. columns: values of the rods'
    parameters by name, arrays of any shape."""
    tapers = columns.get("taper", np.ones(1))
    cone_text = "a cone of radius ratio" if len(np.unique(tapers)) == 1 else "cones of radius ratios"
    tapers_text = " to ".join(f"{end:g}" for end in np.unique([tapers.min(), tapers.max()]))
    shape_texts = [] if (tapers == 1).all() else [f"{cone_text} {tapers_text}"]
    profile = config.rod_material.profile
    if profile is not None:
        shape_texts.append(_profile_text(config, profile))
    return shape_texts


def _profile_text(config: Config, profile: Profile) -> str:
    """Text describing a profile. For a cone in SI units, whose profile rodsweep computes, the text names only
    the drag of each local radius."""
    arm = config.parameters.arm
    if config.stated_rod_material is None and arm is not None and arm.cone_parameter_names:
        return "the drag of each local radius"
    jumps = len(profile.u) - len(profile.breaks)
    profile_text = f"a profile of {counted(len(profile.u), 'row')}"
    return f"{profile_text} with {counted(jumps, 'jump')}" if jumps else profile_text


def _law_and_section_text(config: Config) -> str:
    """Text describing the constitutive law and the cross-section."""
    law = "linear material" if config.rod_material.law == "linear" else "neo-Hookean rubber"
    return f"{law} with a swelling section" if config.rod_material.section == "swelling" else law


def _deformation_row(parameter: Parameter, values: np.ndarray) -> CheckRow:
    parameter_name = parameter.name
    deformation = parameter.meaning.removesuffix(" stiffness")
    is_rigid = np.isinf(values)
    if is_rigid.all():
        return deformation, False, f"{parameter_name} = inf: the rod is {parameter.rigid_adjective}"
    exceptions_text = f" at all but {counted(int(is_rigid.sum()), 'value')}" if is_rigid.any() else ""
    return deformation, True, f"{parameter_name} is finite{exceptions_text}"
