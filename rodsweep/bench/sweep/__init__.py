"""Complete runs of the command: scaling, overhead, memory."""
