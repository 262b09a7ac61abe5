"""Questions of the page, and the processes that answer them. Knows nothing of controls and pictures."""
