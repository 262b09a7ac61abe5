"""Continuation of all curves of solutions: step, step length, ends of a curve."""
