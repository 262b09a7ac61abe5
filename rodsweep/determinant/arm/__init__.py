"""D of arms, which vary along their length or are not of linear material, from propagators of elements, and
all computations with this D."""
