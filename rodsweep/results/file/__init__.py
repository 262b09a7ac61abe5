"""The result file: creation, atomic replacement, seal and validation; reading, merging and provenance."""

from ...errors import import_failure_error

try:
    import h5py  # noqa: F401 - the modules here import it; this one says why it is missing
except (ImportError, ValueError) as error:  # ValueError: compiled for another NumPy
    raise import_failure_error("h5py", error, extra="files") from error
