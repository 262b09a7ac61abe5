"""Settings of the documentation site: Sphinx reads the Markdown pages of this folder. `make docs` builds it.

The cells of the tutorials run when the site is built; an exception in a cell ends the build. All other pages
are checked by `tests/test_docs.py`.
"""

import re

import rodsweep

project = "rodsweep"
author = copyright = "the rodsweep developers"
version = release = rodsweep.__version__

extensions = ["myst_nb", "sphinx.ext.autodoc"]
exclude_patterns = ["_build"]
root_doc = "index"

smartquotes = False  # the prime of y' is no apostrophe

html_theme = "furo"
html_title = f"rodsweep {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False

myst_enable_extensions = ["deflist"]  # no formulas by MathJax, which a page would load from the network
myst_heading_anchors = 4
# Links to files of the clone, such as ../configs/fig2c.yaml: Sphinx copies them into the site.

nb_execution_mode = "force"
nb_execution_excludepatterns = ["notebook.ipynb"]  # stored with its outputs, which the tests compare
nb_execution_raise_on_error = True
nb_execution_timeout = 300
nb_merge_streams = True

autodoc_typehints = "none"  # the docstrings and the signatures say what is allowed
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
add_module_names = False
default_role = "code"  # docstrings mark code by single backticks


def escaped(app, what, name, obj, options, lines):
    """Escapes stars of docstrings, such as F* and **options, which are markup in reStructuredText."""
    lines[:] = [re.sub(r"(?<!`)\*", r"\\*", line) for line in lines]


def setup(app):
    app.connect("autodoc-process-docstring", escaped)
