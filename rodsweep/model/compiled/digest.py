"""Digest of a compiled function: its bytecode, the functions that it calls, the global values that it reads.

numba copies called functions and global values into a compiled function, which must be compiled again when
one of the copies is outdated. Comments, docstrings and line numbers do not change the digest.
`rodsweep.model.compiled.cache` names files of compiled code by the digest.
"""

import builtins
import dis
import inspect
from collections.abc import Iterable, Iterator, Mapping, MutableMapping
from hashlib import sha256
from itertools import pairwise
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import Any, NamedTuple

import numpy as np
from numba import types
from numba.core.dispatcher import Dispatcher

from .kernel_constants import KernelConstants

VARIADIC_FLAGS = inspect.CO_VARARGS | inspect.CO_VARKEYWORDS
"""Flags of a code object for *args and **kwargs; no other flags change the compiled code."""
GLOBAL_READ_INSTRUCTIONS = ("LOAD_GLOBAL", "LOAD_NAME")
"""Names of the bytecode instructions that read a global value."""
REPR_STABLE_TYPES = (bool, int, float, complex, str, bytes, type(None), type(Ellipsis))
"""Types whose values have the same `repr` in every process."""


class FunctionText(NamedTuple):
    """A Python function in the digest. text: its code and constants. called_kernels: the kernels that it
    calls."""

    text: str
    called_kernels: list["Kernel"]


class Kernel(NamedTuple):
    """A Python function to compile. options: numba's compiler options, as text."""

    function: FunctionType
    options: str


TextCache = MutableMapping[FunctionType, FunctionText]
"""Cache of the text of every function."""


def kernel_of(function: Any, options: Mapping[str, Any]) -> Kernel:
    """The kernel of `function`. options: numba's compiler options, by name."""
    # Sorted, so that options in another order have the same text.
    return Kernel(function, repr(sorted((name, _in_fixed_order(value)) for name, value in options.items())))


def kernel_digest(kernel: Kernel, cache: TextCache) -> str:
    """SHA-256 of a kernel and of all functions that it calls, directly or indirectly. cache: cache of the
    texts of functions, which is filled."""
    texts: dict[FunctionType, str] = {}
    pending = [kernel]
    while pending:
        function, options = pending.pop()
        # Kernels may call each other in a circle.
        if function not in texts:
            # The first text is kept: numba compiled that code, even if a global value has changed since.
            text_of_function = cache.get(function) or _text_of_function(function, options)
            cache[function] = text_of_function
            texts[function] = text_of_function.text
            pending += text_of_function.called_kernels
    return sha256("\n".join(texts.values()).encode()).hexdigest()


def type_text(numba_type: Any) -> str:
    """Text of the numba type of an argument, with the field names that numba's own name of the type omits.
    The text also contains the module of a NamedTuple, because compiled code refers to the class by its
    module. Raises TypeError for a function type, which does not determine the code of the function."""
    # The code of a function passed as an argument would not be part of the digest.
    if isinstance(numba_type, types.Callable):
        raise TypeError(f"kernels take no functions as arguments: {numba_type}")
    items = numba_type.types if isinstance(numba_type, types.BaseTuple) else ()
    # Scalar types are their own dtype, which would never end.
    if hasattr(numba_type, "dtype") and numba_type.dtype is not numba_type:
        items = (*items, numba_type.dtype)
    fields = getattr(numba_type, "fields", "")
    name = _qualified_name(numba_type.instance_class) if isinstance(numba_type, types.BaseNamedTuple) else ""
    return f"{type(numba_type).__name__} {name} {numba_type} {fields} ({', '.join(map(type_text, items))})"


def _text_of_function(function: FunctionType, options: str) -> FunctionText:
    """Name, options, bytecode and global values of a function as text, and the kernels that it calls."""
    lines = [_qualified_name(function), options]
    values = _ValueTextConverter(function)
    # Values of enclosing functions are compiled in as constants, like globals.
    cell_contents = [cell.cell_contents for cell in function.__closure__ or ()]
    lines += map(values.text, (function.__defaults__, function.__kwdefaults__, *cell_contents))
    for code in _code_objects(function.__code__):
        instructions = list(dis.get_instructions(code))
        lines += _code_lines(code, instructions)
        read_values = _global_values_read(function, instructions)
        lines += [f"{name} = {values.text(value)}" for name, value in read_values.items()]
    return FunctionText("\n".join(lines), values.called_kernels)


def _global_values_read(function: FunctionType, instructions: Iterable[dis.Instruction]) -> dict[str, Any]:
    """Global values of `function` that `instructions` read, by name; of a `KernelConstants` object only the
    fields that are read. Raises NameError for a name that is neither a global name nor a builtin."""
    values = {}
    # Only the fields that are read count, so that other settings can change without a new compilation.
    for instruction, next_instruction in pairwise(instructions):
        if instruction.opname in GLOBAL_READ_INSTRUCTIONS and instruction.argval in function.__globals__:
            value = function.__globals__[instruction.argval]
            if isinstance(value, KernelConstants) and next_instruction.opname == "LOAD_ATTR":
                values[f"{instruction.argval}.{next_instruction.argval}"] = getattr(
                    value, next_instruction.argval
                )
            else:
                values[instruction.argval] = value
        elif instruction.opname in GLOBAL_READ_INSTRUCTIONS and not hasattr(builtins, instruction.argval):
            raise NameError(
                f"{_qualified_name(function)} reads {instruction.argval}, which its module does not define"
            )
    return values


def _code_objects(code: CodeType) -> Iterator[CodeType]:
    """Yields a code object and all code objects inside it, such as those of inner functions."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            # Comprehensions and inner functions have code objects of their own among the constants.
            yield from _code_objects(constant)


def _code_lines(code: CodeType, instructions: Iterable[dis.Instruction]) -> list[str]:
    """Bytecode of a code object as lines of text, with constants in place of their indices. The indices are
    left out because an added docstring changes them."""
    counts = code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags & VARIADIC_FLAGS
    lines = [code.co_name, repr((counts, code.co_varnames, code.co_freevars, code.co_cellvars))]
    # Since Python 3.11 the blocks of `try` are not in the bytecode but in this table.
    lines.append(code.co_exceptiontable.hex())
    for instruction in instructions:
        value = instruction.argval
        # The `repr` of a code object contains its address.
        argument = value.co_name if isinstance(value, CodeType) else repr(_in_fixed_order(value))
        lines.append(f"{instruction.opname} {argument}")
    return lines


def _in_fixed_order(value: Any) -> Any:
    """The value itself, or a sorted list for a set, because the order of a set differs between processes."""
    return sorted(value, key=repr) if isinstance(value, set | frozenset) else value


class _ValueTextConverter:
    """Converts the values that one function refers to into text that is equal in every process. function: the
    function. called_kernels: kernels found among the converted values."""

    def __init__(self, function: FunctionType) -> None:
        self.function = function
        self.called_kernels: list[Kernel] = []

    def text(self, value: Any) -> str:
        """Text of a value. Raises TypeError for a type without reproducible text."""
        if isinstance(value, REPR_STABLE_TYPES):
            return repr(value)
        if isinstance(value, Mapping):
            return self.text(list(value.items()))
        if isinstance(value, tuple | list):
            return f"{self._class_text(type(value))} [{', '.join(map(self.text, value))}]"
        if isinstance(value, type):
            return self._class_text(value)
        return _array_or_type_text(value) or self._function_or_module_name(value)

    def _function_or_module_name(self, value: Any) -> str:
        """Name of a function or of a module outside this package. A function of this package is also added to
        `called_kernels`. Raises TypeError for any other value."""
        if hasattr(value, "_defn"):  # an intrinsic of numba
            value = value._defn
        # A called kernel enters with its own code, so that a change there recompiles its callers too.
        if isinstance(value, Dispatcher):
            self.called_kernels.append(kernel_of(value.py_func, value.targetoptions))
            return _qualified_name(value.py_func)
        if isinstance(value, ModuleType) and not self._is_in_own_package(value.__name__):
            return value.__name__
        if isinstance(value, FunctionType) and self._is_in_own_package(value.__module__):
            self.called_kernels.append(Kernel(value, ""))
        # The versions of NumPy and numba in the name of the file stand for the code of their functions.
        if isinstance(value, FunctionType | BuiltinFunctionType):
            return _qualified_name(value)
        raise TypeError(
            f"{_qualified_name(self.function)} is compiled and reads {value!r}, which has no digest; pass it "
            "as an argument, or import the needed names of a module"
        )

    def _class_text(self, kind: type) -> str:
        """Name of a class, with the fields of a NamedTuple; TypeError for other classes of this package."""
        fields = getattr(kind, "_fields", None)
        if fields is not None:
            return f"{_qualified_name(kind)} {fields} {self.text(getattr(kind, '_field_defaults', {}))}"
        if self._is_in_own_package(kind.__module__):
            raise TypeError(f"{_qualified_name(self.function)}: {kind} is not a NamedTuple")
        return _qualified_name(kind)

    def _is_in_own_package(self, module: str) -> bool:
        return module.partition(".")[0] == self.function.__module__.partition(".")[0]


def _array_or_type_text(value: Any) -> str | None:
    """Text of an array, or of a type of NumPy or numba; None for other values."""
    if isinstance(value, np.ndarray | np.generic):
        return f"{_array_or_type_text(value.dtype)} {np.shape(value)} {value.tobytes().hex()}"
    if isinstance(value, np.dtype):
        return f"{value!r} {value.itemsize} {value.fields}"
    if isinstance(value, types.ExternalFunction):
        return f"{value.symbol} {value.sig}"
    return type_text(value) if isinstance(value, types.Type) else None


def _qualified_name(value: Any) -> str:
    return f"{value.__module__}.{value.__qualname__}"
