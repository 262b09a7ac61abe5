"""The rod linearised about its straight state: the transverse and longitudinal eigenproblems, and
expansions."""
