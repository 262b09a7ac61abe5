"""Special points of branches: kinds, location, and curves over two parameters."""
