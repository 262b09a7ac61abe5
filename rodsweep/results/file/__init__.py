"""The result file: creation, atomic replacement, seal and validation; reading, merging and provenance."""

from ...errors import import_refusal

try:
    import h5py  # noqa: F401 - the modules here import it; this one says why it is missing
except (ImportError, ValueError) as error:  # ValueError: compiled for another NumPy
    raise import_refusal("h5py", error, extra="files") from error
