"""The YAML document of a config: parsed, read, and refused in one sentence."""
