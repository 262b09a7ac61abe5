"""Results as tables with one row per item: their names and contents, columns, rows, and alignment as text."""
