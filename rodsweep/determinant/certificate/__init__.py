"""Certificates: no eigenvalue outside a box, none missed inside, no threshold between two forces."""
