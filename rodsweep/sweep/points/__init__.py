"""The points of a sweep: grids, lists, lines, stretches, chains and shards."""
