"""Progress of long solves: what each listener receives of the same report."""

from rodsweep.solve_progress import SolvePosition, report, reporting_to, solve_part


def test_a_listener_receives_positions_within_its_own_block():
    outer, inner = [], []
    with reporting_to(lambda place: outer.append(place())):
        with solve_part("point 2 of 4", (0.25, 0.5)), reporting_to(lambda place: inner.append(place())):
            with solve_part("branch 1", (0.0, 0.5)):
                report(lambda: SolvePosition("F = 30", 0.5))
            report()
        report(lambda: SolvePosition("curves"))
    assert inner == [SolvePosition("branch 1: F = 30", 0.25), SolvePosition()]
    assert outer == [
        SolvePosition("point 2 of 4: branch 1: F = 30", 0.3125), SolvePosition(), SolvePosition("curves"),
    ]  # fmt: skip
