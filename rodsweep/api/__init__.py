"""The Python interface: what `import rodsweep as rs` offers, one rod or a sweep, answered in this process.

It says in Python what a config says in YAML: keywords become the same tree of keys, go through the same
validation to the same solvers, and what comes is the Dataset that xarray reads from the result file. The only
importer of xarray. Its modules are loaded when a public name is first used, PETSc at the first solve.
"""
