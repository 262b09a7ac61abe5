"""The Python interface `import rodsweep as rs`: a rod or a sweep, solved in this process or on many ranks.

Keyword arguments become the same tree of keys as a YAML config and pass the same validation. The result
equals the Dataset that xarray reads from the result file. Only this package imports xarray. Modules are
loaded when a public name is first used; PETSc is loaded at the first solve.
"""
