"""Pools of PETSc and SLEPc solvers that are reused from point to point and destroyed when replaced.

Python's garbage collection would not free PETSc objects: petsc4py only puts collected objects on a list.
"""

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar
from weakref import WeakSet


@dataclass(frozen=True, slots=True, kw_only=True)
class SolverPoolSettings:
    """Memory limit of a pool of solvers."""

    max_bytes: int = 100_000_000
    """Above this memory, in bytes, a pool destroys its least recently used objects before it creates an
    object. The limit allows dozens of solvers for a few modes, or three solvers for 300 modes."""


SOLVER_POOL_SETTINGS = SolverPoolSettings()


class Destroyable(Protocol):
    """An object for an `LruPool`: `destroy` frees the object's memory, `memory_bytes` estimates it."""

    @property
    def memory_bytes(self) -> int:
        """Estimate of the object's current memory, in bytes."""

    def destroy(self) -> None: ...


Key = TypeVar("Key", bound=Hashable)
Object = TypeVar("Object", bound=Destroyable)


class LruPool(Generic[Key, Object]):
    """Cache of objects made by `create(key)`; a full pool destroys the least recently used objects. A pool is
    full with `limit` objects, or above `SOLVER_POOL_SETTINGS.max_bytes`. Objects may grow while they solve,
    so a pool may exceed the memory limit until the next object is created."""

    def __init__(self, create: Callable[[Key], Object], limit: int) -> None:
        self._create = create
        self._limit = limit
        self._objects: OrderedDict[Key, Object] = OrderedDict()
        _pools.add(self)

    def __len__(self) -> int:
        return len(self._objects)

    @property
    def memory_bytes(self) -> int:
        """Estimate of the memory of all objects in the pool, in bytes."""
        return sum(kept.memory_bytes for kept in self._objects.values())

    def get(self, key: Key) -> Object:
        """The object for `key`, created if the pool has none; a call with another key may destroy it."""
        if key not in self._objects:
            while len(self._objects) >= self._limit or self.memory_bytes > SOLVER_POOL_SETTINGS.max_bytes:
                self._objects.popitem(last=False)[1].destroy()
            self._objects[key] = self._create(key)
        self._objects.move_to_end(key)
        return self._objects[key]

    def destroy_object(self, key: Key) -> None:
        """Destroys the object for `key`, if the pool has one."""
        if key in self._objects:
            self._objects.pop(key).destroy()

    def destroy_all(self) -> None:
        """Destroys all objects of the pool."""
        while self._objects:
            self._objects.popitem()[1].destroy()


_pools: WeakSet[LruPool[Any, Any]] = WeakSet()


def destroy_pooled_solvers() -> None:
    """Destroys the objects of all pools; called after an exception, which may leave objects unusable."""
    for pool in list(_pools):
        pool.destroy_all()
