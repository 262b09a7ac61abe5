"""Phase diagrams: rows (lines of constant second parameter) and boundary curves."""
