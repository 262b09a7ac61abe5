"""Safe YAML of a config: version 1.2, one small document of limited depth, plain data only.

Every parser event is checked before any value is built: no text can run code or exhaust memory. Every error
message is one sentence with the line and column in the file.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError
from ruamel.yaml.events import AliasEvent, Event, ScalarEvent
from ruamel.yaml.parser import Parser
from ruamel.yaml.reader import ReaderError

from ...errors import InputError, short_repr
from ..values import overflows_float, printable_name

MAX_CONFIG_BYTES = 100_000
"""Maximum size of a config file, in bytes: about 15,000 numbers, read in a second. Longer lists of points
belong in CSV files."""
MAX_TEXT_LENGTH = 1000
"""Maximum length of a key or value, in characters."""
HDF5_SIGNATURE = b"\x89HDF"
"""First bytes of an HDF5 file, hence of a result file."""
TABLE_SUFFIXES = (".csv", ".tsv")
"""Suffixes of files with lists of points, and of the tables that `rodsweep export` writes."""
MAX_KEY_DEPTH = 20
"""Maximum depth of nested lists and mappings in a config."""


@contextmanager
def refusals_naming_file(path: Path) -> Iterator[None]:
    """Context that puts the name of the config file `path` before the message of every InputError, for values
    that are checked only after the file was read."""
    try:
        yield
    except InputError as error:
        named = InputError(f"{printable_name(path)}: {error}")
        raise (named.marked_collective() if error.is_collective else named) from None


def read_config_text(path: Path) -> str:
    """Text of a UTF-8 file of at most MAX_CONFIG_BYTES bytes; InputError for any other file."""
    name = printable_name(path)
    try:
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise InputError(f"{name} is not a file")  # opening a pipe would wait for its writer
        with path.open("rb") as file:
            data = file.read(MAX_CONFIG_BYTES + 1)
    except OSError as error:
        raise InputError(f"{name} cannot be read: {error.strerror}") from error
    if data.startswith(HDF5_SIGNATURE):
        raise InputError(f"{name} is a result file, not a config; `rodsweep show` prints its content")
    if path.suffix in TABLE_SUFFIXES:
        raise InputError(f"{name} is a table, not a config; name the table in a config, as parameters.points")
    if len(data) > MAX_CONFIG_BYTES:
        raise InputError(
            f"{name} is larger than {MAX_CONFIG_BYTES} bytes, the limit for a config; write many points "
            "into a CSV file and name the file as parameters.points"
        )
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{name} is not UTF-8 text; save the file as UTF-8") from None


def parsed_yaml(text: str, source: str) -> Any:
    """Value of a YAML text, as nested dicts and lists; InputError if the text is not valid or not allowed.
    source: name of the text, with which the message begins."""
    if any(line.startswith("%") for line in text.splitlines()):
        raise InputError(f"{source}: directives (%...) are not allowed in a config; remove the line")
    yaml = YAML(typ="safe", pure=True)
    yaml.Parser = _PlainDataParser
    try:
        return yaml.load(text)
    except InputError as error:
        raise InputError(f"{source}{error}") from None
    except ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        column = error.position - text.rfind("\n", 0, error.position)
        message = f"{text[error.position]!r} cannot be printed; remove this character"
        raise InputError(f"{source}, line {line}, column {column}: {message}") from None
    except YAMLError as error:
        location = _location_clause(getattr(error, "problem_mark", None))
        context, problem = (getattr(error, name, None) or "" for name in ("context", "problem"))
        message = printable_name(" ".join(f"{context} {problem}".split()) or " ".join(str(error).split()))
        raise InputError(f"{source}{location}: not valid YAML: {message}") from None
    except (ValueError, OverflowError, RecursionError) as error:
        raise InputError(f"{source}: not valid YAML: {printable_name(error)}") from None


def _location_clause(mark: Any) -> str:
    """Line and column of a mark of the YAML reader, as ", line 2, column 5"; "" without a mark."""
    return f", line {mark.line + 1}, column {mark.column + 1}" if mark else ""


class _PlainDataParser(Parser):
    """YAML parser that raises InputError for an anchor, an alias, a tag, too deep nesting, or a refused
    scalar; the message begins with the location."""

    depth = 0

    def get_event(self) -> Event:
        event = super().get_event()
        try:
            self._refuse(event)
        except InputError as error:
            raise InputError(f"{_location_clause(event.start_mark)}: {error}") from None
        return event

    def _refuse(self, event: Any) -> None:
        """Raises InputError for an event of the parser that is not allowed."""
        if getattr(event, "anchor", None):
            text = printable_name(("*" if isinstance(event, AliasEvent) else "&") + event.anchor)
            raise InputError(f"anchors and aliases ({text}) are not allowed in a config; write the value out")
        if getattr(event, "tag", None):
            raise InputError(f"tags ({printable_name(event.tag)}) are not allowed in a config; remove them")
        if isinstance(event, ScalarEvent):
            _refuse_scalar(event)
        name = type(event).__name__
        self.depth += name.endswith("StartEvent") - name.endswith("EndEvent")
        if self.depth > MAX_KEY_DEPTH:
            raise InputError(f"keys are nested more than {MAX_KEY_DEPTH} levels deep, the limit for a config")


def _refuse_scalar(event: ScalarEvent) -> None:
    """Raises InputError for a YAML scalar that is too long or has characters that cannot be printed, for a
    merge key (<<), and for a number too large for a float."""
    text = event.value
    if len(text) > MAX_TEXT_LENGTH:
        limit = f"a value of a config has at most {MAX_TEXT_LENGTH}"
        raise InputError(f"{short_repr(text)} has {len(text)} characters; {limit}")
    if not text.isprintable():
        raise InputError(f"{short_repr(text)} has characters that cannot be printed; remove them")
    if event.style is None and text == "<<":
        raise InputError("merge keys (<<) are not allowed in a config; write the keys out")
    is_integer = text.lstrip("+-").isdigit()  # refused later, with its key
    if event.style is None and overflows_float(text) and not is_integer:
        raise InputError(f"{short_repr(text)} is too large for a floating-point number")
