"""Counts, ranges and numbers with errors in words."""

import numpy as np
import pytest

from rodsweep.post.summary.number_texts import (
    error_text,
    number_with_error_text,
    parameter_ranges_text,
    rounded_number_and_total_error,
    rounded_text,
    value_range_text,
)
from rodsweep.wording import count_of_total, counted, duration, is_or_are


@pytest.mark.parametrize(
    ("count", "noun", "text"),
    [
        (1, "rank", "1 rank"),
        (2, "rank", "2 ranks"),
        (0, "point", "0 points"),
        (1, "branch", "1 branch"),
        (3, "branch", "3 branches"),
        (2, "frequency", "2 frequencies"),
        (2, "unforeseen exception", "2 unforeseen exceptions"),
        (np.int64(1), "row", "1 row"),
    ],
)
def test_one_thing_is_not_several(count, noun, text):
    assert counted(count, noun) == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(8.7e-5, "0.087 ms"), (0.99949, "999 ms"), (0.9996, "1 s"), (4.3, "4.3 s"), (123.4, "123 s")],
)
def test_a_time_needs_no_power_of_ten(seconds, text):
    assert duration(seconds) == text


def test_a_part_is_named_by_its_whole():
    assert count_of_total(1, 1, "rod") == "1 of 1 rod"
    assert count_of_total(1, 2, "rod") == "1 of 2 rods"
    assert (is_or_are(1), is_or_are(2)) == ("is", "are")


@pytest.mark.parametrize(
    ("values", "errors", "text"),
    [
        ([199.9998, 200.0], None, "200"),
        ([199.998, 200.0], None, "199.998 to 200"),
        ([1.23456789], None, "1.23457"),
        ([0.1234, 0.5678], [6e-3, 4e-4], "0.1 to 0.568"),
        ([152026.4, 62.31], [60.0, 0.4], "62 to 152000"),
        ([2.0, np.nan, np.inf], None, "2"),
        ([np.nan], None, "none"),
        ([3, 5], None, "3 to 5"),
        ([0.0, 1e-7], None, "0 to 1e-07"),
    ],
)
def test_a_range_has_no_digit_that_its_errors_do_not_leave(values, errors, text):
    assert value_range_text(np.array(values), None if errors is None else np.array(errors)) == text


def test_a_number_and_its_error_contain_the_true_number():
    """Also where the number was rounded away from it, and the error down."""
    random = np.random.default_rng(3)
    for _ in range(2000):
        value, error = float(random.normal() * 10 ** random.uniform(-9, 9)), 10 ** random.uniform(-12, 0)
        error *= abs(value)
        true = value + error * random.choice([-1, 1])
        text, _, stated = number_with_error_text(value, error).partition(" (+- ")
        assert abs(float(text) - true) <= float(stated.rstrip(")")) * (1 + 1e-12) + 1e-15 * abs(value)
        assert rounded_number_and_total_error(value, error)[0] == text
        end = rounded_text(value, error)
        size = abs(float(end)) or abs(value)
        assert abs(float(end) - true) <= 1.001 * 10.0 ** np.ceil(np.log10(2 * error)) + 1e-5 * size


def test_an_error_is_rounded_up():
    assert [error_text(error) for error in (1e-3, 1.001e-3, 9.5e-3, 0.0, np.inf, np.nan)] == [
        "1e-03",
        "2e-03",
        "1e-02",
        "0e+00",
        "inf",
        "nan",
    ]


def test_ends_of_ranges_have_the_digits_of_their_own_errors():
    assert parameter_ranges_text([(1.23456789123, 2.3456789), (5.0, 7.125)], {2.3456789: 1e-3}) == (
        "1.23456789 to 2.35, 5 to 7.125"
    )
    assert parameter_ranges_text([], {}) == "none"
