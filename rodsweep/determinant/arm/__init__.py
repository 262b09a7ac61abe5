"""D(w) of arms that are not uniform or not of linear material, from propagators of short elements."""
