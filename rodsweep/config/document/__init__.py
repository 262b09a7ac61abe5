"""The YAML document of a config: parsing, validation, and error messages of one sentence."""
