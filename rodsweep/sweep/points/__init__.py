"""The points of a sweep: grids and lists, and their division into lines, stretches, chains and shards."""
