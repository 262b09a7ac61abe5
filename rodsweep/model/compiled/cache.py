"""Compiled functions on disk: a file for each kernel and types of arguments, named by all that it is made of.

numba's own cache knows the source file of a function and nothing of what the function calls. Here the file's
name holds the digest of the code (`rodsweep.model.compiled.digest`): editing a comment compiles nothing,
editing a formula compiles its callers, and versions of the program share a directory.

A file that is damaged counts as absent, and one that cannot be written is done without.
"""

import os
import pickle
import sys
import warnings
from collections.abc import Mapping, Sequence
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
from numba.core.serialize import dumps
from numba.core.sigutils import normalize_signature

from ...watch import report
from .digest import Part, digest, kernel_of, type_text

VERSIONS = (sys.implementation.cache_tag, numba.__version__, llvmlite.__version__, np.__version__)
"""Compiled code of one version is of no use to another."""
SEAL = 32
"""Bytes of SHA-256 at the start of a file, of what follows: it shows a file that was cut off."""
_first_parts: dict[FunctionType, Part] = {}
"""Description of each function at its first use, which is the state that numba compiled."""


class KernelCache(_Cache):
    """The cache of one function: what numba's dispatchers and C callbacks ask for compiled code."""

    def __init__(self, function: Any, options: Mapping[str, Any], directories: Sequence[Path]) -> None:
        """`options`: numba's; `directories`: all are read, and the first that can be is written."""
        self._kernel = kernel_of(function, options)
        self._directories = tuple(directories)

    @property
    def cache_path(self) -> str | None:
        """Cache file of the function, as numba reports it."""
        return str(self._directories[0]) if self._directories else None

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The compiled function for arguments `sig`, or None."""
        report()  # a place to stop between two compilations of some seconds each
        target_context.refresh()  # as numba's cache does: registers what a loaded function may refer to
        name = self._name(sig, target_context.codegen(), _first_parts)
        for directory in self._directories:
            content = _read(directory / name)
            if content is not None:
                return CompileResult._rebuild(target_context, *pickle.loads(content))
        return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keeps what was compiled, unless it holds addresses or a global value has changed meanwhile."""
        name = self._name(sig, data.codegen, {})
        changed = name != self._name(sig, data.codegen, _first_parts)
        if data.library.has_dynamic_globals or data.lifted or changed:
            return
        content, failures = dumps(data._reduce()), []
        for directory in self._directories:
            try:
                _write(directory / name, content)
                return
            except OSError as error:
                failures.append(f"{directory} ({error.strerror})")
        if failures:
            _warn_once(
                f"compiled formulas cannot be kept in {' or '.join(failures)}: the next run takes minutes to "
                "compile them again; NUMBA_CACHE_DIR names another directory"
            )

    def _name(self, sig: Any, codegen: Any, parts: dict[FunctionType, Part]) -> str:
        arguments, result = normalize_signature(sig)
        kinds = [type_text(kind) for kind in (*arguments, *([] if result is None else [result]))]
        content = repr((VERSIONS, codegen.magic_tuple(), kinds, digest(self._kernel, parts)))
        function = self._kernel.function
        name = f"{function.__module__}.{function.__qualname__}".replace("<", "").replace(">", "")
        return f"{name}-{sha256(content.encode()).hexdigest()[:32]}.kernel"

    def enable(self) -> None:
        """numba asks for it; a cache is always on."""

    def disable(self) -> None:
        """Keeps and loads nothing from now on."""
        self._directories = ()

    def flush(self) -> None:
        """Nothing is held back."""


@cache
def _warn_once(sentence: str) -> None:
    """Python's own memory of warnings is emptied by numba at every compilation."""
    warnings.warn(sentence, stacklevel=1)


def _read(path: Path) -> bytes | None:
    try:
        held = path.read_bytes()
    except OSError:
        return None
    seal, content = held[:SEAL], held[SEAL:]
    return content if sha256(content).digest() == seal else None


def _write(path: Path, content: bytes) -> None:
    """All of it or nothing, whoever else writes the same file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{uuid4().hex}")
    try:
        unfinished.write_bytes(sha256(content).digest() + content)
        os.replace(unfinished, path)
    except OSError:
        unfinished.unlink(missing_ok=True)
        raise
