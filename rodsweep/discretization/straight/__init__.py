"""The eigenproblem of the straight rod on elements."""
