"""How Sphinx builds the site; `python -m docs.site` lays out its pages and calls it."""

from pathlib import Path

from sphinx.application import Sphinx

from docs.site import mathml
from robot import __version__

project = "Kick control"
author = "the kickctl authors"
project_copyright = author
release = version = __version__

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = "index"
language = "en"
# Only what the site itself has: it works without a network.
html_theme = "pydata_sphinx_theme"
html_math_renderer = "mathml"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_js_files = ["math.js"]
html_search_scorer = str(Path(__file__).with_name("scorer.js"))
html_title = f"Kick control {release}"
html_copy_source = False
html_show_sphinx = False
html_context = {"default_mode": "auto"}
html_theme_options = {
    "header_links_before_dropdown": 8,
    "navigation_with_keys": False,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
    "show_prev_next": True,
}
html_sidebars: dict[str, list[str]] = {"index": []}

myst_enable_extensions = ["dollarmath", "html_image"]
myst_heading_anchors = 4
nb_execution_raise_on_error = True
nb_execution_timeout = 600
nb_ipywidgets_js: dict[str, dict[str, str]] = {}

autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
default_role = "code"
napoleon_use_ivar = True
# Docstrings say it shorter than an annotation of numpy.
napoleon_attr_annotations = False
highlight_language = "none"


def setup(app: Sphinx) -> None:
    """Let browsers draw equations by themselves."""
    app.add_html_math_renderer("mathml", (mathml.inline, None), (mathml.block, None))
