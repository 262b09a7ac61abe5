"""One follower for all curves of solutions: steps, their lengths, where a curve ends."""
