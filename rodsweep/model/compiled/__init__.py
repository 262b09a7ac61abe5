"""Compiled kernels: loops over an algebra unrolled, machine code cached by the kernels' source."""
