"""Newton's matrix of a periodic orbit: elimination, solutions, multipliers, memory."""
