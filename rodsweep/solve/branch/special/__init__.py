"""Special points of branches: what happens there, where they lie, their curves over two parameters."""
