"""Roots of D, refined by Newton's method from approximate eigenvalues."""
