"""The rod linearised about its straight state: transverse and longitudinal modes, and expansions."""
