"""Compilation of kernels with Numba: loops over an algebra unrolled, machine code cached by the kernels' source."""
