"""Elements of an arm: their propagators as polynomials in w, by collocation."""
