"""The rod linearised about its straight state: eigenproblems of transverse and longitudinal modes, and
expansions."""
