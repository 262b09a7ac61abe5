"""Newton's matrix of a periodic orbit: its elimination, its solutions, the memory that it takes."""
