"""Newton's method for a cycle together with the parameter: units of arc length, bordered matrix, and the
condition that closes the system."""
