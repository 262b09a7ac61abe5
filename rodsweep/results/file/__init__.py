"""The result file: creation, exchange, seal and validation; reading, merging and provenance."""
