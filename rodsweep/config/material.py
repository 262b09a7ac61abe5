"""The section `material` of a config: constitutive law, cross-section, and a profile along the arm, which may
be a CSV file."""

import csv
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from ..errors import InputError, short_repr
from ..model.material.profile import FACTOR_NAMES, Profile
from ..model.material.rod_material import RodMaterial
from ..wording import counted
from .values import Number, StrictConfigSection, cell_number

MAX_PROFILE_ROWS = 1000
"""Maximum number of rows of a profile; longer profiles are refused."""
LawName = Literal["linear", "neo_hookean"]
SectionName = Literal["fixed", "swelling"]
FactorColumn = Annotated[
    list[Number] | None,
    Field(max_length=MAX_PROFILE_ROWS, description=f"a list of at most {MAX_PROFILE_ROWS} numbers"),
]


class ProfileTable(StrictConfigSection):
    """Table of factors that multiply stiffnesses and drags along the arm, in columns of equal length. An
    omitted column is 1 along the whole arm."""

    u: Annotated[
        list[Number], Field(max_length=MAX_PROFILE_ROWS, description="a list of numbers from 0 to 1")
    ]
    """Material coordinate, from 0 at the base to 1 at the tip, not decreasing. Two equal values mark a jump
    of the factors."""
    k1: FactorColumn = None
    """Factor of the stretch stiffness at each u."""
    k2: FactorColumn = None
    """Factor of the shear stiffness at each u."""
    k3: FactorColumn = None
    """Factor of the bending stiffness at each u."""
    gamma1: FactorColumn = None
    """Factor of the axial drag at each u."""
    gamma2: FactorColumn = None
    """Factor of the normal drag at each u."""
    gamma3: FactorColumn = None
    """Factor of the rotational drag at each u."""

    @cached_property
    def profile(self) -> Profile:
        """The `Profile` of this table; ValueError for an invalid table."""
        given = {name: getattr(self, name) for name in FACTOR_NAMES}
        ones = [1.0] * len(self.u)
        columns = {name: ones if column is None else column for name, column in given.items()}
        for name, column in columns.items():
            if len(column) != len(self.u):
                raise ValueError(
                    f"{name} has {counted(len(column), 'value')} and u has {len(self.u)}; give one value for "
                    "each u"
                )
        return Profile(tuple(self.u), tuple(zip(*columns.values(), strict=True)))

    @model_validator(mode="after")
    def _require_valid_profile(self) -> "ProfileTable":
        assert self.profile
        return self


def _allow_profile_file(schema: dict[str, Any]) -> None:
    """Adds the name of a CSV file as an allowed value to the JSON schema of a profile, in place."""
    schema["anyOf"] = [{"type": "string"}, *schema["anyOf"]]


class MaterialConfig(StrictConfigSection):
    """Constitutive law of the arm, and its variation along the length."""

    law: LawName = "linear"
    """Constitutive law: stress proportional to strain, or incompressible neo-Hookean rubber."""
    section: SectionName = "fixed"
    """Whether the cross-section keeps a fixed size or swells as the arm shortens."""
    profile: Annotated[
        ProfileTable | None,
        Field(
            description="the name of a CSV file, or a mapping of columns to lists",
            json_schema_extra=_allow_profile_file,
        ),
    ] = None
    """Name of a CSV file, or mapping, with the columns u, k1, k2, k3, gamma1, gamma2 and gamma3: factors
    along the arm."""

    @cached_property
    def rod_material(self) -> RodMaterial:
        """Constitutive law and profile; ValueError if the law does not allow the cross-section."""
        return RodMaterial(self.law, self.section, self.profile.profile if self.profile else None)

    @model_validator(mode="after")
    def _require_valid_material(self) -> "MaterialConfig":
        if not self.model_fields_set:
            raise ValueError("no key is given; give law, section or profile")
        assert self.rod_material
        return self


MAX_PROFILE_CHARACTERS = 1_000_000
"""Maximum number of characters in the CSV file of a profile; longer files are refused."""


def with_profile_read(document: Any, directory: Path) -> Any:
    """The parsed config `document` with the file name in `material.profile` replaced by the columns of the
    file.

    directory: folder of a relative file name. Raises InputError if the file is not a table of numbers.
    """
    if not isinstance(document, dict) or not isinstance(document.get("material"), dict):
        return document
    name = document["material"].get("profile")
    if not isinstance(name, str):
        return document
    if not name.strip():
        raise InputError("material.profile is empty; it should be the name of a CSV file")
    return document | {"material": document["material"] | {"profile": read_profile(directory / name)}}


def read_profile(path: Path) -> dict[str, list[float]]:
    """Columns of the CSV file of a profile, by name in the header; InputError for an invalid file."""
    file_text = f"material.profile: {path}"
    try:
        if not path.is_file():
            fault = "is not a file" if path.exists() else "does not exist"
            raise InputError(f"{file_text} {fault}; give the name of a CSV file")
        with path.open(newline="", encoding="utf-8-sig") as file:
            text = file.read(MAX_PROFILE_CHARACTERS + 1)
        rows = [[cell.strip() for cell in row] for row in csv.reader(text.splitlines()) if row]
    except OSError as error:
        raise InputError(f"{file_text} cannot be read: {error.strerror}") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{file_text} is not CSV text ({error})") from error
    if len(text) > MAX_PROFILE_CHARACTERS or len(rows) > MAX_PROFILE_ROWS + 1:
        raise InputError(f"{file_text} has more than {MAX_PROFILE_ROWS} rows; use fewer rows")
    header = rows[0] if rows else []
    if "u" not in header or not set(header) <= {"u", *FACTOR_NAMES} or len(set(header)) < len(header):
        raise InputError(
            f"{file_text}: the header must name u and any of {', '.join(FACTOR_NAMES)}, each once"
        )
    columns: dict[str, list[float]] = {name: [] for name in header}
    for number, row in enumerate(rows[1:], 1):
        row_name = f"{file_text}: row {number}"
        if len(row) != len(header):
            raise InputError(
                f"{row_name} has {counted(len(row), 'value')}, but the header names {len(header)}; give a "
                "value for each name of the header"
            )
        for name, cell in zip(header, row, strict=True):
            try:
                columns[name].append(cell_number(cell))
            except ValueError:
                raise InputError(f"{row_name}: {name} = {short_repr(cell)} is not a number") from None
    return columns
