"""Conversion of a call's keywords into the job of a config file with the same keys."""

import os
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, TypedDict, TypeVar

import numpy as np

from ..config.arm.section import ArmSection
from ..config.document.call_arguments import in_sentences, unknown
from ..config.document.reading import validated, with_files_read
from ..config.document.refusals import nearest
from ..config.material import MaterialSection
from ..config.schema import Config
from ..config.tasks import CONFIGS
from ..errors import InputError
from ..model.arm.arm import SlenderArm
from ..model.arm.drag import DRAGS
from ..model.arm.quantities import LOADS, RELATIVE
from ..model.material.build import STANDARD
from ..solve.exclusive import signals_held
from ..tasks.running.job import Job, job_of, memory

ArmKind = TypeVar("ArmKind", bound=SlenderArm)
DEFAULT_VALUES = {"drag": DRAGS[0], "law": STANDARD.law, "section": STANDARD.section}
"""Default values of an arm's keys, which a config omits."""
Tree = dict[str, Any]
"""Keys and values as YAML would read them."""


def tree_of(task: str, keywords: Mapping[str, Any]) -> Tree:
    """Config tree from keywords: each key is put into the section that knows it, or knows the nearest name.

    A whole section may be given as a mapping, as read from YAML. Raises InputError for a masked value, and
    for a name without a near key.
    """
    tree: Tree = {"task": plain_keyword("task", task)}
    if not isinstance(task, str) or task not in CONFIGS:
        return tree
    sections = _sections(task)
    for name, value in keywords.items():
        if name in sections and isinstance(value, Mapping):
            tree.setdefault(name, {}).update(plain_keyword(name, dict(value)))
            continue
        section = _section_of(name, sections)
        if section is None:
            section = _section_of(_meant(name, sections), sections)
        place = tree.setdefault(section, {}) if section else tree
        place[name] = plain_keyword(f"{section}.{name}" if section else name, value)
    _write_out_arm(task, tree)
    return tree


def _write_out_arm(task: str, tree: Tree) -> None:
    """Replaces an `rs.Arm` by the arm's quantities. The load is included only if the task takes a load."""
    parameters = tree.get("parameters", {})
    arm = parameters.get("arm")
    if isinstance(arm, SlenderArm):
        loaded = "F" in CONFIGS[task].taken_of_a_rod(tree.get(task, {}))
        names = [n for n in ArmSection.model_fields if n not in RELATIVE and (loaded or n not in LOADS)]
        known = known_load(arm) if loaded else arm
        given = {name: getattr(known, name) for name in names}
        for name, default in DEFAULT_VALUES.items():
            given[name] = None if given[name] == default else given[name]
        parameters["arm"] = {name: plain(value) for name, value in given.items() if value is not None}


def known_load(arm: ArmKind) -> ArmKind:
    """The arm with its load as a quantity. A load relative to flutter starts PETSc and solves for flutter."""
    if arm.share_of_flutter is None:
        return arm
    from ..verdict.planes import with_known_load

    return with_known_load(arm)


@signals_held
def job_from(tree: Tree) -> Job:
    """The validated job of a config tree; InputError, in the words of the command line, for bad input."""
    config = validated(with_files_read(tree, Path()))
    job = job_of(Path(config.task), config, tree)
    size = job.points.count * job.layout.bytes_per_point
    if size > memory():
        raise InputError(
            f"the results of {job.points.count:.6g} points take {size / 1e9:.3g} GB, more than the "
            f"{memory() / 1e9:.3g} GB of memory of this machine; `rodsweep run` writes them into a file"
        )
    return job


def refuse_unfit(tree: Tree) -> None:
    """Raises InputError for a config tree that `job_from` refuses, before the ranks of a run start.

    Points with a load relative to flutter are left to the run, whose ranks share the search for flutter.
    """
    arm = validated(with_files_read(tree, Path())).parameters.arm
    if arm is None or arm.load_axis not in RELATIVE:
        job_from(tree)


def _sections(task: str) -> dict[str, Collection[str]]:
    """Known keys of each section of a task by the section's name; "" is the top level."""
    fields = CONFIGS[task].model_fields
    inner: dict[str, Any] = {name: fields[name].annotation for name in (task, "parameters")}
    inner["material"] = MaterialSection
    top = [name for name in Config.model_fields if name not in ("task", "parameters", "material")]
    return {name: tuple(section.model_fields) for name, section in inner.items()} | {"": top}


def _section_of(name: str, sections: Mapping[str, Collection[str]]) -> str | None:
    """Name of the section with a given key; None if no section has the key."""
    return next((section for section, known in sections.items() if name in known), None)


def _meant(name: str, sections: Mapping[str, Collection[str]]) -> str:
    """The known key nearest to an unknown one.

    A quantity of an arm given outside its section yields any known key: validation then names the right
    section. Raises InputError with a list of all keys if no key is near.
    """
    known = [key for keys in sections.values() for key in keys]
    close = nearest(name, known)
    if not close and name not in ArmSection.model_fields:
        raise unknown(name, known)
    return close[0] if close else known[0]


class AxisRange(TypedDict):
    """A range of values in the form of a config."""

    start: float | str
    stop: float | str
    num: int
    spacing: str


@in_sentences("rs.linspace(0, 10, num=11)")
def linspace(start: float | str, stop: float | str, num: int) -> AxisRange:
    """`num` equally spaced values from start to stop, as an axis of a sweep; quantities of an arm such as "2
    kPa" too.
    """
    return _range(start, stop, num, "linear")


@in_sentences("rs.logspace(10, 1e6, num=31)")
def logspace(start: float | str, stop: float | str, num: int) -> AxisRange:
    """`num` values from start to stop with equal ratios, as an axis of a sweep.

    `start` and `stop` are the end values, as for NumPy's `geomspace`, not exponents.
    """
    return _range(start, stop, num, "log")


def _range(start: float | str, stop: float | str, num: int, spacing: str) -> AxisRange:
    """A range in the form of a config; InputError for a masked value."""
    for name, value in (("start", start), ("stop", stop), ("num", num)):
        if np.ma.is_masked(value):
            raise InputError(f"{name} is masked, so it is not a number; give a number")
    return {"start": start, "stop": stop, "num": num, "spacing": spacing}


def plain(value: Any) -> Any:
    """A value in Python types: arrays and tuples become lists, NumPy scalars numbers, paths text.

    pint quantities and arrays of them become text with their unit. Raises ValueError for masked values.
    """
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | range):
        return [plain(item) for item in value]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "to_base_units"):  # a pint quantity; np.asarray would drop its unit
        return _with_unit(plain(value.magnitude), f"{value.units:~C}")
    if np.ma.is_masked(value):
        raise ValueError("a value of the array is masked, so it is not a number; leave it out")
    if hasattr(value, "__array__"):
        return np.asarray(value).tolist()
    return value


def plain_keyword(key: str, value: Any) -> Any:
    """`plain` of the value of a keyword; InputError, naming the key, for a masked value."""
    try:
        return plain(value)
    except ValueError as error:
        raise InputError(f"{key}: {error}") from None


def _with_unit(value: Any, unit: str) -> Any:
    """Appends a unit to a number, or to each number of a list; without a unit the value is unchanged."""
    if isinstance(value, list):
        return [_with_unit(item, unit) for item in value]
    return f"{value!r} {unit}" if unit else value
