"""Newton's method for a cycle and its parameter together: units of arc length, bordered matrix, closing
condition."""
