"""Files combined: merged, joined and extended, and which configs ask for the same results."""
