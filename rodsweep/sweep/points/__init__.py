"""The points of a sweep: grids of parameters or of arm quantities, lists; loads relative to flutter; lines,
groups, chains and shards."""
