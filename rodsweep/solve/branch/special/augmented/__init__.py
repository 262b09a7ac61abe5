"""Minimally augmented systems: a cycle near a known cycle is corrected together with a test function, using
the matrix factors of the known cycle."""
