"""Questions of the page, and processes that answer questions. Knows nothing of controls and pictures."""
