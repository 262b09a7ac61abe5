"""The result file: made whole, exchanged whole, sealed; read, merged and told where it came from."""
