"""D of arms that vary along their length, from propagators of elements, and all computations with this D."""
