"""Questions of the page, and the processes that solve them. Knows nothing of controls and pictures."""
