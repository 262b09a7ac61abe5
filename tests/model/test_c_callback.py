"""Callbacks for C code, through which no exception can pass."""

import ctypes

from numba import types

from rodsweep.model.compiled.compilation import c_callback


def reciprocal(x):
    """1/x."""
    return 1.0 / x


def test_division_by_zero_in_a_callback_gives_infinity_and_prints_nothing(capfd):
    """numba would print "Exception ignored ... ZeroDivisionError" and return 0."""
    callback = c_callback(reciprocal, types.float64(types.float64))
    function = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)(callback.address)
    assert function(0.0) == float("inf")
    assert capfd.readouterr().err == ""
