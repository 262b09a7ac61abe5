"""Compiled functions on disk: one file for each kernel and its argument types, named by a digest of the code.

numba's own cache detects changes of the source file of a function, but not changes of called functions. Here
the digest covers the function and its callees (`rodsweep.model.compiled.digest`): a changed comment
recompiles nothing, a changed formula recompiles all its callers, and versions of the program can share a
directory.

A damaged file is ignored; a file that cannot be written is skipped.
"""

import os
import pickle
import sys
import warnings
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import cache
from hashlib import sha256
from pathlib import Path
from types import FunctionType
from typing import Any
from uuid import uuid4

import llvmlite
import numba
import numpy as np
from numba.core.caching import _Cache
from numba.core.compiler import CompileResult
from numba.core.runtime import rtsys
from numba.core.serialize import dumps
from numba.core.sigutils import normalize_signature

from ...solve_progress import report
from .digest import FunctionText, kernel_digest, kernel_of, type_text
from .slice_assignment import install_shape_mismatch_message

COMPILER_VERSIONS = (sys.implementation.cache_tag, numba.__version__, llvmlite.__version__, np.__version__)
"""Versions of Python, numba, llvmlite and NumPy. They are part of the name of a cache file, because compiled
code is valid for one combination of versions only."""
PACKAGE_DIRECTORY = Path(__file__).parents[2]
"""Directory of the package rodsweep."""
CACHE_CHECKSUM_BYTES = 32
"""Length, in bytes, of the SHA-256 checksum at the start of a cache file, which reveals truncation."""
_texts_at_first_use: dict[FunctionType, FunctionText] = {}
"""Text of each function at its first use in this process: numba compiled the code of this text."""


def cache_directories() -> list[Path]:
    """Directories for compiled code, in order of preference: only a directory under NUMBA_CACHE_DIR if this
    variable is set; otherwise a directory in the package, then one under XDG_CACHE_HOME, or under ~/.cache if
    XDG_CACHE_HOME is not set."""
    if directory := os.environ.get("NUMBA_CACHE_DIR"):
        return [Path(directory) / "rodsweep"]
    # First next to the package, so that an installation compiled once serves all its users.
    caches = [PACKAGE_DIRECTORY / "__pycache__"]
    if directory := os.environ.get("XDG_CACHE_HOME"):
        caches.append(Path(directory) / "rodsweep")
    else:
        with suppress(RuntimeError):  # the user has no home directory
            caches.append(Path.home() / ".cache" / "rodsweep")
    return [parent / "compiled" for parent in caches]


class KernelCache(_Cache):
    """Disk cache of one compiled function, with the interface of numba's dispatchers and C callbacks."""

    def __init__(self, function: Any, options: Mapping[str, Any], directories: Sequence[Path]) -> None:
        """function: the function to compile. options: numba's compiler options. directories: directories of
        cache files; all are read, and files are written into the first writable directory."""
        self._kernel = kernel_of(function, options)
        self._directories = tuple(directories)

    @property
    def cache_path(self) -> str | None:
        """First directory of cache files, which numba reports; None if the cache is disabled."""
        return str(self._directories[0]) if self._directories else None

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The compiled function for the signature `sig`; None if the cache has no valid file."""
        report()  # a stop request can end the run here, between two compilations of some seconds each
        # Defines symbols that loaded code may use. numba's own cache calls refresh(), which would import the
        # compiler.
        rtsys.initialize(target_context)
        name = self._cache_file_name(sig, target_context.codegen(), _texts_at_first_use)
        # All directories are read, as the file may have been written by a user with other rights.
        for directory in self._directories:
            content = _read_cache_file(directory / name)
            if content is not None:
                return CompileResult._rebuild(target_context, *pickle.loads(content))
        # Only now, because this imports the compiler, which a run with a full cache never needs.
        install_shape_mismatch_message()  # numba compiles the function next
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Writes the compiled function `data` for the signature `sig` to disk. Nothing is written if the code
        contains memory addresses or lifted loops, or if a global value that the code reads has changed since
        the first use of the function. If no directory is writable, a warning is issued."""
        # An empty mapping reads all texts anew, so that the two names differ if a value has changed.
        name = self._cache_file_name(sig, data.codegen, {})
        has_changed = name != self._cache_file_name(sig, data.codegen, _texts_at_first_use)
        # Addresses differ in each process, and code of changed values would be found under a wrong name.
        if data.library.has_dynamic_globals or data.lifted or has_changed:
            return
        # The serialiser of numba also stores functions and types that the standard one refuses.
        content = dumps(data._reduce())
        failures = []
        for directory in self._directories:
            try:
                _write_cache_file(directory / name, content)
                return
            except OSError as error:
                failures.append(f"{directory} ({error.strerror})")
        if failures:
            _warn_once(
                f"compiled formulas cannot be stored in {' or '.join(failures)}: the next run takes minutes "
                "to compile the formulas again; set NUMBA_CACHE_DIR to another directory"
            )

    def _cache_file_name(self, sig: Any, codegen: Any, texts: dict[FunctionType, FunctionText]) -> str:
        arguments, result = normalize_signature(sig)
        type_texts = [type_text(kind) for kind in (*arguments, *([] if result is None else [result]))]
        content = repr(
            (COMPILER_VERSIONS, codegen.magic_tuple(), type_texts, kernel_digest(self._kernel, texts))
        )
        function = self._kernel.function
        name = f"{function.__module__}.{function.__qualname__}".replace("<", "").replace(">", "")
        return f"{name}-{sha256(content.encode()).hexdigest()[:32]}.kernel"

    def enable(self) -> None:
        """Does nothing, because the cache is always enabled; numba requires this method."""

    def disable(self) -> None:
        """Stops reading and writing files."""
        self._directories = ()

    def flush(self) -> None:
        """Does nothing, because files are written at once; numba requires this method."""


@cache
def _warn_once(sentence: str) -> None:
    """Issues the warning `sentence` once per process. Python's own filter is not enough: numba resets the
    record of issued warnings at every compilation."""
    warnings.warn(sentence, stacklevel=1)


def _read_cache_file(path: Path) -> bytes | None:
    """Content of the cache file `path` without its checksum; None if the file is missing or damaged."""
    try:
        checked_bytes = path.read_bytes()
    except OSError:
        return None
    checksum = checked_bytes[:CACHE_CHECKSUM_BYTES]
    content = checked_bytes[CACHE_CHECKSUM_BYTES:]
    # A damaged file would crash the process only when its machine code runs.
    return content if sha256(content).digest() == checksum else None


def _write_cache_file(path: Path, content: bytes) -> None:
    """Writes `content` to the file `path` atomically: other processes see the complete file or no file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    # Each process writes its own file, so that ranks which compile the same kernel do not mix their bytes.
    temporary_file = path.with_name(f".{uuid4().hex}")
    try:
        temporary_file.write_bytes(sha256(content).digest() + content)
        os.replace(temporary_file, path)
    except OSError:
        # A full disk must not leave partial files behind.
        temporary_file.unlink(missing_ok=True)
        raise
