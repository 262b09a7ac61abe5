"""Changes of stability along a path of arms that have no closed form of D."""
