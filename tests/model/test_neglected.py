"""What the model leaves out of an arm, as numbers: by hand, against the linear problem, and as arrays."""

import math

import numpy as np
import pytest

import rodsweep as rs
from rodsweep.model.arm.arm import SlenderArm
from rodsweep.model.arm.neglected import (
    COMPRESSION_LIMIT,
    INERTIA_LIMIT,
    REYNOLDS_LIMIT,
    WEIGHT_LIMIT,
    Effect,
    Validity,
    angular_frequency_at_smallest_drag,
    neglected_effects,
    smallest_drag,
    worst_validity,
)
from rodsweep.model.arm.unsteady_drag import MAX_SERIES_FREQUENCY, drag_phase_lag

WATER = {"length": 0.12, "radius": 0.006, "young": 80e3, "poisson": 0.49, "viscosity": 1e-3}
"""A soft arm in water, in SI units."""


def named(effects):
    return {effect.name: effect for effect in effects}


def test_effects_on_an_arm_in_water_by_hand():
    """m omega/gamma2 with gamma2 = 4 pi eta/(ln 160 + 1/2), F/k1, rho U 2 a/eta, weight over 7.837 k3/L^2."""
    arm = SlenderArm(**WATER, density_difference=100.0)
    effects = named(neglected_effects(arm, 50.0, 40.0))
    logarithm = math.log(160) + 0.5
    inertia = 1100 * math.pi * 36e-6 * 50 * logarithm / (4 * math.pi * 1e-3)
    s = 1000 * 50 * (0.12 / 4.694) ** 2 / 1e-3
    heavy = 100 * 9.81 * math.pi * 36e-6 * 0.12 / (80e3 * math.pi * 1296e-12 / 4 / 0.0144)
    values = {
        "inertia of the arm": inertia,
        "inertia of the fluid": float(drag_phase_lag(s, logarithm)),
        "compression": 40 / 1600,
        "weight": heavy / 7.837,
        "Reynolds number": 1000 * 50 * 0.06 * 0.012 / 1e-3,
    }
    assert {name: float(effect.value) for name, effect in effects.items()} == pytest.approx(values, rel=1e-9)
    limits = [effects[name].limit for name in values]
    assert limits == [INERTIA_LIMIT, INERTIA_LIMIT, COMPRESSION_LIMIT, WEIGHT_LIMIT, REYNOLDS_LIMIT]


@pytest.mark.parametrize(("phase", "lowered"), [(INERTIA_LIMIT, 0.065), (INERTIA_LIMIT / 10, 0.007)])
def test_inertia_at_its_limit_lowers_flutter_as_stated(phase, lowered):
    """With inertia lambda + m lambda^2/gamma2 = mu, the eigenvalue without; at flutter lambda = i omega."""
    filament = rs.Rod(k1=math.inf, k2=math.inf, gamma3=0.0)
    F = filament.thresholds(F_max=60).F_hopf * (1 - lowered)
    found = filament.replace(F=F).spectrum(modes=1)
    assert -found.growth_rate[0] / abs(found.frequency[0]) == pytest.approx(phase, rel=0.02)


def mobility(s, logarithm):
    """2 pi eta times that of a line of forces with wavenumber 1 in unsteady Stokes flow.

    It is cut off where the steady one is logarithm/2.

    The integral of (q^2/2 + 1)/((q^2 + 1) (q^2 + 1 + i s)) over the plane of q, in u = ln(q^2 + 1).
    """
    end = 2 * logarithm - 1 + math.exp(1 - 2 * logarithm)  # steady: (u + 1 - exp(-u))/4 up to the end
    u, step = np.linspace(0.0, end, 20001, retstep=True)
    p = np.exp(u)
    integrand = 0.5 * ((p - 1) / 2 + 1) / (p + 1j * s)
    return step * (integrand.sum() - (integrand[0] + integrand[-1]) / 2)


@pytest.mark.parametrize("s", [1e-3, 0.1, 1.0, 10.0, 100.0])
def test_phase_of_the_fluid_is_that_of_unsteady_flow(s):
    """Apart from the cut-off of the integral, which ends at q^2/k^2 = exp(19) = 2e8."""
    exact = -np.angle(mobility(s, 10.0))
    assert drag_phase_lag(s, 10.0) == pytest.approx(exact, rel=1e-5)


def test_phase_of_the_fluid_is_proportional_to_slow_rates():
    assert drag_phase_lag(1e-4, 3.0) == pytest.approx(0.75e-4 / 3, rel=1e-3)
    assert drag_phase_lag(1e-9, 3.0) == pytest.approx(0.75e-9 / 3, rel=1e-8)
    assert drag_phase_lag([0.0, np.nan], 3.0) == pytest.approx([0.0, np.nan], abs=0.0, nan_ok=True)


def test_phase_of_the_fluid_is_smooth_where_its_series_ends():
    """Steps of 1, 2 and 1 % of s across the end: the middle change of phase/s is the sum of the others."""
    s = MAX_SERIES_FREQUENCY * np.array([0.98, 0.99, 1.01, 1.02])
    phase = drag_phase_lag(s, 1.5) / s
    assert phase[2] - phase[1] == pytest.approx(phase[1] - phase[0] + phase[3] - phase[2], rel=0.02)


@pytest.mark.parametrize("name", ["inertia of the arm", "inertia of the fluid", "Reynolds number"])
def test_a_fluid_as_viscous_as_stated_brings_an_effect_to_its_limit(name):
    """The rate is that of the same frequency in 1/tau2, so it falls with viscosity."""
    arm = SlenderArm(**WATER)
    before = named(neglected_effects(arm, angular_frequency_at_smallest_drag(arm, 170.0), 35.0))[name]
    factor = float(before.viscosity_factor_at_limit)
    thicker = SlenderArm(**WATER | {"viscosity": factor * 1e-3})
    after = named(neglected_effects(thicker, angular_frequency_at_smallest_drag(thicker, 170.0), 35.0))[name]
    assert before.value_over_limit > 1
    assert factor > 1
    assert after.value == pytest.approx(after.limit, rel=1e-9)


def test_no_fluid_undoes_compression_and_weight():
    effects = named(neglected_effects(SlenderArm(**WATER, density_difference=100.0), math.nan, 400.0))
    assert [float(effects[name].viscosity_factor_at_limit) for name in ("compression", "weight")] == [
        math.inf
    ] * 2
    assert (
        float(
            named(neglected_effects(SlenderArm(**WATER), math.nan, 4.0))[
                "compression"
            ].viscosity_factor_at_limit
        )
        == 0
    )


def test_least_drag_moves_fastest():
    arm = SlenderArm(**WATER)
    rates = [170.0 / arm.tau2_with(drag) for drag in arm.base_drag_estimates]
    assert angular_frequency_at_smallest_drag(arm, 170.0) == pytest.approx(max(rates))
    assert smallest_drag(arm).gamma2 == min(drag.gamma2 for drag in arm.base_drag_estimates)


def test_validity_goes_by_tenths_of_the_limit_and_is_of_arrays():
    values = np.array([0.0, 0.099, 0.101, 0.999, 1.001, np.nan]) * 3.0
    effect = Effect(name="e", value=values, limit=3.0, viscosity_factor_at_limit=values)
    assert effect.validity.tolist() == [0, 0, 1, 1, 2, 0]
    assert effect.validity.dtype == np.int8


def test_rates_and_forces_broadcast():
    arm = SlenderArm(**WATER)
    rates, forces = np.array([[0.0], [np.nan], [1e4]]), np.array([1.0, 40.0, 400.0])
    effects = neglected_effects(arm, rates, forces)
    assert all(effect.value.shape == (3, 3) for effect in effects)
    assert worst_validity(effects, of_cycles=False).tolist() == [[0, 1, 2], [0, 1, 2], [2, 2, 2]]
    one = neglected_effects(arm, 1e4, 400.0)
    assert [float(a.value) for a in one] == [float(b.value[2, 2]) for b in effects]


def test_reynolds_number_is_of_cycles_only_and_of_their_amplitude():
    arm = SlenderArm(**WATER)
    number = named(neglected_effects(arm, 50.0, 40.0))["Reynolds number"]
    assert worst_validity([number], of_cycles=True) == Validity.does_not_apply
    still = named(neglected_effects(arm, 50.0, 40.0, amplitude=0.05))["Reynolds number"]
    assert number.value == pytest.approx(10 * still.value)
    others = neglected_effects(SlenderArm(**WATER | {"viscosity": 100.0}), 0.0, 4.0)
    assert worst_validity((number, *others), of_cycles=False) == Validity.applies
    assert worst_validity((number, *others), of_cycles=True) == Validity.does_not_apply


def test_an_arm_without_load_has_no_force():
    arm = SlenderArm(**WATER)
    assert arm.load_name is None
    assert arm.k1 == pytest.approx(1600)
    with pytest.raises(rs.InputError, match="^pressure is missing"):
        _ = arm.F
    assert SlenderArm(**WATER, force=0.0).load_name == "force"


@pytest.mark.filterwarnings("error")
def test_a_tube_without_an_amplitude_has_an_unknown_flattening_of_its_wall():
    tube = SlenderArm(length="10 cm", radius="5 mm", inner_radius="3 mm", young="1 MPa", viscosity="12 Pa s")
    effects = named(neglected_effects(tube, math.nan, math.nan, amplitude=math.nan))
    assert np.isnan(effects["flattening of the wall"].value)
