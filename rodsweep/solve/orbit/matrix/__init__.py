"""Newton's matrix of a periodic orbit: elimination, solution of linear systems, multipliers, memory."""
