"""The hull of an arm: a convex region of w that contains all eigenvalues of the arm."""
