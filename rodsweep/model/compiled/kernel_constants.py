"""Frozen settings whose fields compiled functions read as constants."""

from collections.abc import Mapping
from typing import Any, ClassVar

from numba.core import types
from numba.core.datamodel import models, register_default
from numba.core.imputils import lower_constant, lower_getattr_generic
from numba.core.types.misc import maybe_literal
from numba.core.typing.templates import AttributeTemplate, infer_getattr
from numba.core.typing.typeof import typeof, typeof_impl


class KernelConstants:
    """Base class of frozen dataclasses of numbers and tuples of numbers that are global constants of modules.

    A compiled function may read fields and properties of such a constant, but call no method. The machine
    code contains the numbers; a function is compiled again when the source changes a field that the function
    reads.
    """

    __slots__ = ()
    field_ranges: ClassVar[Mapping[str, tuple[float, float]]] = {}
    """Exclusive bounds (lower, upper) of fields, by name of the field, for fields whose bounds a proof
    requires."""

    def __post_init__(self) -> None:
        """Raises ValueError for a field outside its bounds in `field_ranges`."""
        for name, (low, high) in self.field_ranges.items():
            if not low < getattr(self, name) < high:
                raise ValueError(f"{name} = {getattr(self, name)} does not lie between {low} and {high}")


class _SettingsType(types.Type):
    """The numba type of one `KernelConstants` object. settings: the object."""

    def __init__(self, settings: KernelConstants) -> None:
        self.settings = settings
        # Types are compared by name, so settings with other values give another type, and other code.
        super().__init__(name=repr(settings))

    def type_and_value(self, name: str) -> Any:
        """Returns (numba type, value) of the field `name`. An integer has a literal type, as globals do."""
        value = getattr(self.settings, name)
        return maybe_literal(value) or typeof(value), value


register_default(_SettingsType)(models.OpaqueModel)


@typeof_impl.register(KernelConstants)
def _type_of(settings: KernelConstants, context: Any) -> _SettingsType:
    return _SettingsType(settings)


@infer_getattr
class _FieldTypeResolver(AttributeTemplate):
    key = _SettingsType

    def generic_resolve(self, settings: _SettingsType, name: str) -> types.Type:
        kind: types.Type = settings.type_and_value(name)[0]
        return kind


@lower_constant(_SettingsType)
def _lower_settings_object(context: Any, builder: Any, kind: _SettingsType, settings: KernelConstants) -> Any:
    # At run time the object is empty: each field is a constant in the code.
    return context.get_dummy_value()


@lower_getattr_generic(_SettingsType)
def _lower_settings_field(context: Any, builder: Any, kind: _SettingsType, value: Any, name: str) -> Any:
    return context.get_constant_generic(builder, *kind.type_and_value(name))
