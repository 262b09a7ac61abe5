"""Special points of branches: their kinds, their location, and their curves over two parameters."""
