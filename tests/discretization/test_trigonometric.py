"""The trigonometric polynomial through samples of one period, against functions known in closed form."""

import numpy as np
import pytest

from rodsweep.discretization.elements.trigonometric import (
    fourier_coefficients,
    hermite_fourier_coefficients,
    hermite_fourier_coefficients_of_columns,
    interpolate_samples,
    series_maxima,
    series_minima,
    series_samples,
    series_values_at,
    time_derivative,
    time_of_rise_through_mean,
)

SAMPLES = pytest.mark.parametrize("n", [31, 32])


def wave(t):
    """A function of period 1 that 31 samples determine to rounding, its largest value e at t = 0.373."""
    return np.exp(np.sin(2 * np.pi * (t - 0.123)))


@SAMPLES
def test_a_smooth_period_is_interpolated_and_differentiated(n):
    t = np.arange(n) / n
    samples = wave(t)[:, None]
    assert series_maxima(fourier_coefficients(samples), samples)[0] == pytest.approx(np.e, rel=1e-12)
    at = np.array([0.01, 0.373, 0.9, 1.9])
    assert interpolate_samples(wave(t), at) == pytest.approx(wave(at), rel=1e-12)
    slope = 2 * np.pi * np.cos(2 * np.pi * (t - 0.123)) * wave(t)
    assert time_derivative(wave(t)) == pytest.approx(slope, abs=1e-10)


@SAMPLES
def test_every_column_is_a_function_of_its_own(n):
    t, at = np.arange(n) / n, np.array([0.2, 0.7])
    both = np.stack([wave(t), np.cos(2 * np.pi * t)], axis=1)
    assert interpolate_samples(both, at)[:, 0] == pytest.approx(
        interpolate_samples(both[:, 0], at), rel=1e-13
    )
    assert time_derivative(both)[:, 1] == pytest.approx(-2 * np.pi * np.sin(2 * np.pi * t), abs=1e-10)


@SAMPLES
@pytest.mark.parametrize("shift", [0.0, 0.013, 0.51])
def test_the_rise_through_the_mean_is_found_between_samples(n, shift):
    sine = 3.0 + np.sin(2 * np.pi * (np.arange(n) / n - shift))
    late = time_of_rise_through_mean(sine) - shift
    assert late - round(late) == pytest.approx(0.0, abs=1e-12)


def test_the_highest_harmonic_of_an_even_number_of_samples_is_a_cosine():
    alternating = np.array([1.0, -1.0, 1.0, -1.0])
    assert interpolate_samples(alternating, np.array([0.125])) == pytest.approx(0.0, abs=1e-14)
    assert time_derivative(alternating) == pytest.approx(np.zeros(4), abs=1e-14)


@pytest.mark.parametrize("m", [9, 64, 65])
def test_values_and_slopes_tell_twice_as_many_harmonics_as_values(m):
    k, rng = np.arange(m + 1), np.random.default_rng(3)
    exact = rng.standard_normal((m + 1, 2)) + 1j * rng.standard_normal((m + 1, 2))
    exact[0], exact[m] = exact[0].real, 1j * exact[m].imag  # at the nodes harmonic m shows as a sine only
    waves = np.exp(2j * np.pi * np.outer(np.arange(m) / m, k))
    values, slopes = (waves @ exact).real, (waves @ (2j * np.pi * k[:, None] * exact)).real
    found = hermite_fourier_coefficients(values, slopes)
    assert np.abs(found - exact).max() < 1e-13 * np.abs(exact).max()
    for count in (7, 8, 4 * m, 4 * m + 1):
        t = np.arange(count) / count
        assert series_samples(found, count) == pytest.approx(series_values_at(exact, t), abs=1e-11)


@pytest.mark.parametrize("nodes", [5, 8])
def test_half_a_period_tells_what_the_whole_does_where_the_other_half_repeats_or_reverses_it(nodes):
    signs, rng = np.array([1.0, -1.0, -1.0]), np.random.default_rng(nodes)
    half = rng.standard_normal((2, nodes, 3))
    whole = np.concatenate([half, signs * half], axis=1)
    exact = hermite_fourier_coefficients(whole[0], whole[1])
    assert np.abs(hermite_fourier_coefficients_of_columns(half[0], half[1], signs) - exact).max() < 1e-14
    assert np.all(hermite_fourier_coefficients_of_columns(half[0], half[1], signs)[::2, 1:] == 0)


def test_extrema_are_those_of_dense_samples():
    """Of several columns, from four samples for each harmonic; the largest dense one is hardly below."""
    rng = np.random.default_rng(7)
    decay = 0.6 ** np.arange(12)[:, None]
    c = decay * (rng.standard_normal((12, 5)) + 1j * rng.standard_normal((12, 5)))
    dense, samples = series_samples(c, 40000), series_samples(c, 48)
    for beyond in (
        series_maxima(c, samples) - dense.max(axis=0),
        dense.min(axis=0) - series_minima(c, samples),
    ):
        assert np.all(beyond >= -1e-13) and np.all(beyond < 1e-6)


def test_a_constant_is_its_own_maximum():
    assert series_maxima(np.array([[2.0 + 0j]]), np.full((4, 1), 2.0)) == pytest.approx([2.0], rel=1e-15)
