"""The arm of a config: its section, axes and quantities."""
