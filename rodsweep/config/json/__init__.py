"""The JSON schema of configs."""
