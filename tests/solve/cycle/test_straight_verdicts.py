"""What limit_cycle says of a straight rod: never against its spectrum, beside Hopf points and in limits."""

from math import inf, nan

import numpy as np
import pytest
from rods import rod_of
from surveyed import few

from rodsweep.bench.limit_cycle.swept_rods import TWO_SEGMENT_PROFILE
from rodsweep.model.material.rod_material import RodMaterial
from rodsweep.model.rod import Rod
from rodsweep.solve.cycle import limit_cycle
from rodsweep.solve.cycle.hopf_start import HopfPointBelowForce, hopf_point_below_force
from rodsweep.solve.cycle.limit_cycle import CycleRequest, CycleStatus, solve_cycle
from rodsweep.solve.cycle.second_state import SecondStableState
from rodsweep.solve.cycle.straight_rod import (
    StraightRodStability,
    eigenvalues_to_follow,
    straight_rod_stability,
)
from rodsweep.solve.hopf.normal_form import normal_form_by_mesh_rule
from rodsweep.solve.spectrum.path import followed_leader
from rodsweep.solve.spectrum.path.followed_leader import follow_leading_eigenvalue
from rodsweep.solve.spectrum.search import SpectrumRequest, solve_spectrum

BESIDE = Rod(F=28.201858565493147, k1=inf, k2=100.0, gamma3=1e-3, gamma1=100.0)
"""2e-7 above its Hopf point, which the rod with k1 = 1e8 has above this force."""
LIMITS = {
    "inextensible": (inf, 1.8e7, 2.5e-4, 27.5),
    "inextensible, hardly dragged": (inf, 355.0, 1.4e-6, 1.0),
    "filament": (inf, inf, 0.0, 1.0),
    "stiffer in shear than any motion": (1e3, 1e11, 1e-3, 1.0),
}
DISTANCES = {"far enough": (1e-7, 400), "next to it": (3e-9, 60)}
"""Relative, with the returns to wait for: next to it most motions do not settle, however long."""
SLOW_STRETCH = (302.12326241855584, 187241.9063523965, 1e-12, 85.99487502008489)
"""Its stretch relaxes in 0.1 tau2, in which its tip swings five times."""


def ended(point, amplitude=0.1, most_periods=400, **more):
    return solve_cycle(point, CycleRequest(1e-6, amplitude, 1, 0, 0, 0, most_periods, **more))


@pytest.mark.parametrize(
    ("w", "error", "stable", "growth", "doubt"),
    [
        (-1 + 10j, 1e-12, True, -1.0, ""),
        (1 + 10j, 1e-12, False, 1.0, "growth rate is 1 +- 1e-12, so the straight rod is unstable"),
        (-1e-13 + 10j, 5e-14, None, 0.0, "growth rate is -1e-13 +- 5e-14, so the stability"),
        (1e-15 + 100j, 1e-17, None, 0.0, "is undecided"),
        (complex(nan, nan), nan, None, 7.0, "is not known: no mesh"),
    ],
)
def test_the_sign_of_a_growth_rate_is_sure_beyond_its_error(w, error, stable, growth, doubt):
    rod = StraightRodStability(w, error, "no mesh")
    assert (rod.is_stable, rod.growth_rate(7.0)) == (stable, growth)
    assert doubt in rod.unproved_stability_text and bool(rod.unproved_stability_text) != bool(rod.is_stable)


@pytest.mark.long
@pytest.mark.parametrize("amplitude", [0.06, 0.1])
def test_a_motion_that_decays_at_the_linear_rate_by_coincidence_is_not_straight(amplitude):
    """Below the fold of a subcritical branch the growth is g0 + c1 y^2 - c2 y^4, near y = 0.055 again g0. The
    rod beats with y = 0.0427; by an independent integration (BDF, elements of order 12) y is 0.0476 and
    0.0486 after 252 returns, and falls more and more slowly.
    """
    c = ended(Rod(F=85.6, k1=150.0, k2=1e4, gamma3=1e-4), amplitude)
    assert c.status in (CycleStatus.cycle, CycleStatus.not_settled)


def test_the_leading_eigenvalue_is_the_spectrums_also_from_a_rod_near_by():
    rod, near = Rod(F=28.0, k1=1e4, k2=1e2, gamma3=1e-2), Rod(F=27.5, k1=1e4, k2=1e2, gamma3=1e-2)
    leading = straight_rod_stability(rod)
    w = solve_spectrum(rod, SpectrumRequest(1, 1e-9, True)).eigenvalues[0]
    assert leading.w == pytest.approx(complex(w.real, abs(w.imag)), rel=1e-12)
    assert straight_rod_stability(rod, np.array([straight_rod_stability(near).w])).w == pytest.approx(
        leading.w, rel=1e-12
    )
    assert (
        leading.is_stable is False
        and straight_rod_stability(Rod(F=27.0, k1=1e4, k2=1e2, gamma3=1e-2)).is_stable is True
    )


@pytest.mark.parametrize(
    ("rod", "end", "followed"),
    [
        (Rod(F=14.0, k1=1e4, k2=1e3, gamma3=1e-2, taper=0.5), 17.0, 1.0),
        (Rod(F=40.0, k1=1e4, k2=1e3, gamma3=1e-2, taper=0.5), 50.0, 1.0),  # a second pair grows from 43.5 on
        (Rod(F=1.0, k1=1e3, k2=1e3, gamma3=1e-2, taper=0.7), 30.0, 0.5),  # real, then a pair
        (
            Rod(F=20.0, k1=200.0, k2=1e4, gamma3=1e-4, material=RodMaterial("neo_hookean", "swelling")),
            40.0,
            1.0,
        ),
    ],
)
def test_eigenvalues_followed_along_a_chain_of_arms_lead(rod, end, followed):
    near = eigenvalues_to_follow(rod, straight_rod_stability(rod))
    steps = 12
    count = 0
    for F in np.linspace(rod.F, end, steps + 1)[1:].tolist():
        here = rod.with_values(F=F)
        found = straight_rod_stability(here, near)
        w = solve_spectrum(here, SpectrumRequest(1, 1e-9, True)).eigenvalues[0]
        assert found.w == pytest.approx(complex(w.real, abs(w.imag)), rel=1e-12)
        count += len(found.followed_eigenvalues) > 0
        near = eigenvalues_to_follow(here, found)
    assert count >= followed * steps


def test_a_chain_of_arms_follows_as_many_eigenvalues_as_a_proof_without_a_count_needs(monkeypatch):
    """Six eigenvalues prove nothing at the first force, where seven do. Between the forces 16.9 and 17.1 the
    second pair becomes two real eigenvalues, which are followed without a search."""
    rod = Rod(F=18.3, k1=1e4, k2=1e2, gamma3=1e-2, material=RodMaterial(profile=TWO_SEGMENT_PROFILE))
    near = eigenvalues_to_follow(rod, straight_rod_stability(rod))
    assert len(near) == 5 and (near.imag > 0).sum() == 2
    for F in (18.3 * 0.99 ** np.arange(1, 20)).tolist():
        here = rod.with_values(F=F)
        with monkeypatch.context() as patch:
            patch.setattr(followed_leader, "count_of_arm", None)
            found = straight_rod_stability(here, near)
        w = solve_spectrum(here, SpectrumRequest(1, 1e-9, True)).eigenvalues[0]
        assert found.w == pytest.approx(complex(w.real, abs(w.imag)), rel=1e-12)
        near = found.followed_eigenvalues
        assert len(near) == (5 if (near.imag > 0).sum() == 2 else 6)
    assert (near.imag > 0).sum() == 1


@pytest.mark.parametrize("taper", [0.5, 1.0])
def test_an_eigenvalue_that_does_not_lead_is_not_followed(taper):
    rod = Rod(F=30.0, k1=1e4, k2=1e3, gamma3=1e-2, taper=taper)
    w = solve_spectrum(rod, SpectrumRequest(6, 1e-9, True)).eigenvalues
    upper = w[w.imag >= 0]
    assert follow_leading_eigenvalue(rod, upper, 1e-9).w == pytest.approx(upper[0], rel=1e-12)
    assert follow_leading_eigenvalue(rod, upper[1:], 1e-9) is None


@pytest.mark.parametrize(("start", "end", "pairs"), [(17.83, 17.48, 1), (17.48, 17.83, 2)])
def test_a_pair_that_becomes_real_or_complex_is_followed_without_a_search(start, end, pairs):
    material = RodMaterial(profile=TWO_SEGMENT_PROFILE)
    rods = [Rod(F=F, k1=1e4, k2=1e2, gamma3=1e-2, material=material) for F in (start, end)]
    guesses, expected = (
        w[w.imag >= 0]
        for w in (solve_spectrum(rod, SpectrumRequest(6, 1e-9, True)).eigenvalues for rod in rods)
    )
    followed = follow_leading_eigenvalue(rods[1], guesses, 1e-9)
    assert followed.eigenvalues == pytest.approx(expected, rel=1e-9)
    assert (expected.imag > 0).sum() == pairs != (guesses.imag > 0).sum()


def test_an_unstable_rod_beside_its_hopf_point_ends_at_its_small_cycle():
    c = ended(BESIDE)
    assert (c.status, c.linear_growth_rate > 0) == (CycleStatus.cycle, True)
    rod = Rod(F=BESIDE.F, k1=BESIDE.k1, k2=BESIDE.k2, gamma3=BESIDE.gamma3)
    form = normal_form_by_mesh_rule(
        rod.with_values(gamma1=BESIDE.gamma1), complex(c.linear_growth_rate, c.linear_frequency), 1e-3
    )
    assert c.measures.tip_y_max == pytest.approx(form.squared_y_and_frequency(BESIDE.F)[0] ** 0.5, rel=1e-2)


@pytest.mark.parametrize("rod", few([*LIMITS.values()], 2), ids=few([*LIMITS], 2))
@pytest.mark.parametrize("where", few([*DISTANCES], 1))
def test_on_either_side_of_a_hopf_point_the_verdict_agrees_with_the_spectrum(rod, where):
    distance, returns = DISTANCES[where]
    k1, k2, gamma3, gamma1 = rod
    hopf = hopf_point_below_force(Rod(F=45.0, k1=k1, k2=k2, gamma3=gamma3)).F
    for F in (hopf * (1 - distance), hopf * (1 + distance)):
        stable = (
            solve_spectrum(
                Rod(F=F, k1=k1, k2=k2, gamma3=gamma3), SpectrumRequest(1, 1e-9, True)
            ).unstable_count
            == 0
        )
        c = ended(Rod(F=F, k1=k1, k2=k2, gamma3=gamma3, gamma1=gamma1), most_periods=returns)
        assert c.status != CycleStatus.straight or stable
        if where == "far enough":
            assert c.status == (CycleStatus.straight if stable else CycleStatus.cycle)


@pytest.mark.parametrize("start", ["mode", "hopf"])
def test_a_growth_rate_that_is_0_within_its_error_leaves_it_open(start, monkeypatch):
    """Far below the Hopf point the motion decays; the spectrum is made to say that it does not know."""
    monkeypatch.setattr(
        limit_cycle, "straight_rod_stability", lambda rod: StraightRodStability(-1e-13 + 60j, 1e-13)
    )
    c = ended(Rod(F=20.0, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0), start=start)
    assert (c.status, c.second_state) == (CycleStatus.not_settled, SecondStableState.not_known)
    assert start == "hopf" or "so the stability of the straight rod is undecided" in c.message


def test_at_the_force_of_a_hopf_point_no_cycle_is_born(monkeypatch):
    """The force that Newton's method finds for the Hopf point may be that of the rod, to the last digit."""
    monkeypatch.setattr(
        limit_cycle, "hopf_point_below_force", lambda rod: HopfPointBelowForce(rod.F, 113.547607865)
    )
    c = ended(Rod(F=27.4271941267593, k1=1e4, k2=1e2, gamma3=1e-2, gamma1=1.0), start="hopf")
    assert c.status == CycleStatus.not_settled
    assert c.message.startswith("no cycle is born from the Hopf point at F = 27.4271941267593 for this force")


@pytest.mark.parametrize(("F", "status"), [(43.0, "straight"), (44.2616704983273, "cycle"), (46.0, "cycle")])
def test_a_rod_that_stops_swinging_while_its_stretch_relaxes_goes_where_its_spectrum_says(F, status):
    c = ended(rod_of(F, *SLOW_STRETCH), 0.5)
    assert c.status.name == status
    assert (c.linear_growth_rate > 0) == (status == "cycle")


@pytest.mark.parametrize(("F", "why"), [(44.2616704983273, "the straight rod is unstable"), (43.0, "")])
def test_a_stored_motion_does_not_leave_the_straight_state_by_a_jump(F, why):
    c = ended(rod_of(F, *SLOW_STRETCH), 0.5, transient=50)
    assert c.status == (CycleStatus.not_settled if why else CycleStatus.straight)
    assert why in c.message


def test_a_stretch_that_has_not_relaxed_is_named():
    c = ended(Rod(F=20.0, k1=100.0, k2=1e2, gamma3=1e-3, gamma1=1e7), 0.8)
    assert c.status == CycleStatus.not_settled
    assert "the stretch of the rod has not relaxed" in c.message
