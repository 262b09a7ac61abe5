"""Pool of PETSc and SLEPc objects that are kept from point to point and destroyed when replaced.

Python's garbage collection would not destroy them: petsc4py only sets the collected objects aside.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar
from weakref import WeakSet


@dataclass(frozen=True, slots=True, kw_only=True)
class KeptSettings:
    """Settings for the memory of a pool."""

    max_bytes: int = 100_000_000
    """Memory of the objects of a full pool: dozens of solvers for a few modes, or three for 300 modes, which
    take seconds a solve and milliseconds to create."""


KEPT = KeptSettings()


class Destroyable(Protocol):
    """An object with a `destroy` method that frees memory, and an estimate of this memory."""

    @property
    def kept_bytes(self) -> int:
        """Memory that the object takes at present, in bytes, approximately."""

    def destroy(self) -> None: ...


Key = TypeVar("Key", bound=Hashable)
Object = TypeVar("Object", bound=Destroyable)


class LruPool(Generic[Key, Object]):
    """A pool of objects made by `create` from keys; a full pool drops the least recently used objects.

    A pool is full with `limit` objects, or with `KEPT.max_bytes`. Objects grow with what they solve, so a
    pool may exceed the memory until the next object is created.
    """

    def __init__(self, create: Callable[[Key], Object], limit: int) -> None:
        self._create = create
        self._limit = limit
        self._objects: OrderedDict[Key, Object] = OrderedDict()
        _pools.add(self)

    def __len__(self) -> int:
        return len(self._objects)

    @property
    def kept_bytes(self) -> int:
        """Memory of all objects, in bytes, approximately."""
        return sum(kept.kept_bytes for kept in self._objects.values())

    def get(self, key: Key) -> Object:
        """The object of a key, kept or new; a later call with a different key may destroy the object."""
        if key not in self._objects:
            while len(self._objects) >= self._limit or self.kept_bytes > KEPT.max_bytes:
                self._objects.popitem(last=False)[1].destroy()
            self._objects[key] = self._create(key)
        self._objects.move_to_end(key)
        return self._objects[key]

    def drop(self, key: Key) -> None:
        """Destroys the object of a key, if kept."""
        if key in self._objects:
            self._objects.pop(key).destroy()

    def clear(self) -> None:
        """Destroys all objects."""
        while self._objects:
            self._objects.popitem()[1].destroy()


_pools: WeakSet[LruPool[Any, Any]] = WeakSet()


def forget_all() -> None:
    """Destroys every kept object: an exception in the middle of a solve may leave any of them unusable."""
    for pool in list(_pools):
        pool.clear()
