"""Builds the documentation: ``sphinx-build -W docs site``. Needs the extra "docs"; no network."""

import sys
from importlib.metadata import version as version_of
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE))

from making import make  # noqa: E402 - after its folder is known
from sphinx.application import Sphinx  # noqa: E402
from sphinxcontrib.programoutput import run_programs  # noqa: E402

project, author = "imuwb", "the authors of imuwb"
version = release = version_of("imuwb")
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.intersphinx",
    "sphinx.ext.mathjax",
    "sphinx_copybutton",
    "sphinxcontrib.programoutput",
]
exclude_patterns = ["inventories", "pictures", "making", "made/terms/figures.md"]
myst_enable_extensions = ["colon_fence", "deflist", "fieldlist"]
myst_heading_anchors = 3
smartquotes = False  # options begin with two hyphens
html_theme = "furo"
html_title = f"imuwb {version}"
html_show_sourcelink = html_show_copyright = False
html_static_path, html_css_files = ["style"], ["site.css"]
copybutton_prompt_text, copybutton_only_copy_prompt_lines = "$ ", True
intersphinx_mapping = {
    "python": ("https://docs.python.org/3", str(HERE / "inventories" / "python.inv")),
    "numpy": ("https://numpy.org/doc/stable", str(HERE / "inventories" / "numpy.inv")),
}
autodoc_member_order, autodoc_typehints = "bysource", "signature"
napoleon_google_docstring, napoleon_numpy_docstring = True, False
programoutput_use_ansi = False
suppress_warnings = [
    "ref.python"
]  # a type such as Literal["name"] is taken for a field, of which many classes have one


def keep_bars(_app: Sphinx, _what: str, _name: str, _item: object, _options: object, lines: list[str]) -> None:
    """Show the bars of a size, such as |x|, in place of a substitution; texts in double backquotes stay."""
    for i, line in enumerate(lines):
        parts = line.split("``")
        lines[i] = "``".join(part if at % 2 else part.replace("|", r"\|") for at, part in enumerate(parts))


def setup(app: Sphinx) -> None:
    """Make the pages that come from the code, before the build reads them."""
    make(HERE)
    app.connect("autodoc-process-docstring", keep_bars)
    app.connect(
        "doctree-read", run_programs, priority=1
    )  # before Sphinx looks for the pictures that the commands write
