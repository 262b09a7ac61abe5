"""Names that version 1.0 promises (docs/promises.md), from the code and from reference/promises.json.

    python tests/promised.py

adds the names of today to the stored ones, as a release does. A stored name is removed by hand only, with a
new major version.
"""

import importlib.util
import inspect
import json
from pathlib import Path
from typing import get_args

import click

import rodsweep as rs
from rodsweep import errors
from rodsweep.cli import commands
from rodsweep.config.tasks import CONFIG_CLASSES_BY_TASK
from rodsweep.errors import STOPPED_EXIT_STATUS
from rodsweep.model.parameters import PARAMETERS
from rodsweep.post.tables.table_names import DEFAULT_TABLE, TABLE_NAMES

STORED = Path(__file__).parent / "reference" / "promises.json"
DOCS = Path(__file__).parents[1] / "docs"
CLASSES = ("Answer", "Arm", "Picture", "Rod")
FUNCTIONS = ("linspace", "logspace", "open", "plot", "sweep", "table")


def reference():
    """The script that writes the tables of the documentation."""
    spec = importlib.util.spec_from_file_location("reference", DOCS / "reference.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def keys_of(model, prefix="") -> dict[str, str]:
    """Dotted names of the keys of a section of a config, each with its default."""
    found = {}
    for name, field in model.model_fields.items():
        inner = [each for each in (field.annotation, *get_args(field.annotation)) if is_section(each)]
        for section in inner:
            found |= keys_of(section, f"{prefix}{name}.")
        has_default = not (field.is_required() or inner)
        found[f"{prefix}{name}"] = str(field.default) if has_default else ""
    return found


def is_section(annotation) -> bool:
    """Whether the type of a key is a mapping with keys of its own."""
    return hasattr(annotation, "model_fields")


def variables(page, task: str) -> dict[str, str]:
    """Variables of the fullest file of a task: dimensions, unit and words."""
    found = {}
    for name, (variable, dimensions) in page.variables_of(page.whole(task)).items():
        words = " ".join(f"{value}:{word}" for value, word in variable.flags)
        found[name] = f"({', '.join(dimensions)}) {variable.units} {words}".strip()
    if task == "phase_diagram":
        for _, (name, dimensions, _, _, unit, _) in page.curve_rows(page.whole(task)):
            found[name.strip("`")] = f"{dimensions} {unit}"
    return found


def promised() -> dict[str, dict[str, dict[str, str]]]:
    """Every promised name of today with what it stands for: kind, section, name, meaning."""
    page = reference()
    statuses = {task: page.whole(task).task.solver().possible_statuses for task in CONFIG_CLASSES_BY_TASK}
    return {
        "config keys": {task: keys_of(config) for task, config in CONFIG_CLASSES_BY_TASK.items()},
        "parameters": {"": {name: p.unit for name, p in PARAMETERS.items()}},
        "variables": {task: variables(page, task) for task in CONFIG_CLASSES_BY_TASK},
        "attributes": {"": {name: "" for names in page.ATTRIBUTES for name in names.split(", ")}},
        "statuses": {task: {s.name: str(int(s)) for s in found} for task, found in statuses.items()},
        "exit statuses": {
            "": {
                "bug": str(errors.BUG_EXIT_STATUS),
                "bad input": str(errors.InputError.exit_status),
                "incomplete environment": str(errors.EnvironmentIncomplete.exit_status),
                "to be continued": str(STOPPED_EXIT_STATUS),
            }
        },
        "tables": {"": dict.fromkeys(TABLE_NAMES.values(), ""), "first": dict(DEFAULT_TABLE)},
        "commands": {
            name: {
                word: "" for each in command.params if isinstance(each, click.Option) for word in each.opts
            }
            for name, command in commands.commands.items()
        },
        "python": {"": dict.fromkeys(rs.__all__, "")}
        | {name: dict.fromkeys(members(getattr(rs, name)), "") for name in CLASSES}
        | {name: dict.fromkeys(inspect.signature(getattr(rs, name)).parameters, "") for name in FUNCTIONS},
    }


def members(kind: type) -> list[str]:
    """Public methods and properties of a class."""
    return [name for name in vars(kind) if not name.startswith("_")]


def broken(stored, today) -> list[str]:
    """Stored names that are gone or stand for something else today."""
    return [
        f"{kind}: {section} {name} was {meaning!r}, is {now.get(name, 'gone')!r}"
        for kind, sections in stored.items()
        for section, names in sections.items()
        for now in [today.get(kind, {}).get(section, {})]
        for name, meaning in names.items()
        if now.get(name) != meaning
    ]


def joined(stored, today):
    """The stored names and those of today."""
    return {
        kind: {section: stored.get(kind, {}).get(section, {}) | names for section, names in sections.items()}
        for kind, sections in today.items()
    }


if __name__ == "__main__":
    before = json.loads(STORED.read_text()) if STORED.exists() else {}
    if gone := broken(before, promised()):
        raise SystemExit("\n".join(gone))
    STORED.write_text(json.dumps(joined(before, promised()), indent=1) + "\n")
