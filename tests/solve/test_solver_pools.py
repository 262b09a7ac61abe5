"""Pools of solvers kept from point to point."""

from rodsweep.discretization.elements.resolution import Resolution
from rodsweep.model.rod import Rod
from rodsweep.solve.backend.solver_pools import SOLVER_POOL_SETTINGS, LruPool
from rodsweep.solve.spectrum.krylov_schur import UniformSolver


class Grown:
    """An object that takes little memory when it is created and `memory_bytes` later."""

    def __init__(self, name):
        self.name = name
        self.memory_bytes = 0
        self.destroyed = False

    def destroy(self):
        self.destroyed = True


def test_a_pool_drops_what_has_grown_beyond_its_memory():
    """Kept solvers took up to 2.4 GB where hundreds of modes grow, because only their number was limited."""
    pool = LruPool(Grown, 24)
    first, second, third = (pool.get(name) for name in "abc")
    for kept in (first, second, third):
        kept.memory_bytes = SOLVER_POOL_SETTINGS.max_bytes // 2
    assert pool.get("c") is third  # who uses three objects in turn keeps them
    pool.get("d")
    assert [first.destroyed, second.destroyed, third.destroyed] == [True, False, False]
    assert pool.memory_bytes <= SOLVER_POOL_SETTINGS.max_bytes


def test_a_pool_drops_the_least_recently_used_beyond_its_number():
    pool = LruPool(Grown, 2)
    first, second = pool.get("a"), pool.get("b")
    pool.get("a")
    pool.get("c")
    assert (first.destroyed, second.destroyed) == (False, True)


def test_a_solver_of_many_modes_knows_its_memory():
    solver = UniformSolver(Resolution(8, 20))
    rod = Rod(F=1e4, k1=1e6, k2=1e6, gamma3=1e-6)
    taken = []
    for modes in (4, 100):
        solver.solve(rod, 1e7, modes)
        taken.append(solver.memory_bytes)
    solver.destroy()
    assert taken[1] - taken[0] > 8 * 480 * 190  # the Krylov space alone
