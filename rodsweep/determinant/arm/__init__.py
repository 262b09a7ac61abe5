"""D(w) of arms that are not uniform, from the propagators of their elements."""
