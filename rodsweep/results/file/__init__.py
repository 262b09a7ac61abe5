"""The result file: its creation, exchange, seal and validation; reading, merging, provenance."""
