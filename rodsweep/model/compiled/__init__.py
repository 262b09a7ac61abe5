"""Compiled kernels: unrolling of loops over a Lie algebra, and a disk cache of machine code."""
