# SPDX-License-Identifier: Apache-2.0
# Sphinx configuration of the reference: the pages of docs and the Python package. Run by cmake/BuildReference.cmake.
import os
import re

project = "C3DE"
author = "The C3DE contributors"
copyright = "The C3DE contributors"
version = release = os.environ["C3DE_VERSION"]

extensions = ["myst_parser", "sphinx.ext.autodoc"]
root_doc = "reference/index"
exclude_patterns = ["plugin/snippets", "gallery"]
myst_heading_anchors = 5  # as links between the pages use them
autodoc_member_order = "bysource"
default_role = "literal"  # `name` in texts of the package
smartquotes = False
html_theme = "alabaster"
html_theme_options = {"description": "Simulations of tissue in images", "page_width": "1100px"}
html_sidebars = {"**": ["about.html", "searchbox.html", "navigation.html"]}
html_copy_source = False
html_show_sphinx = False
html_extra_path = ["site"]


def without_links_to_other_pages(_app, _name, source):
    """Markdown files outside of docs are not part of the site: their links become plain text."""
    source[0] = re.sub(r"\[([^\]]+)\]\((?:\.\./)+(?:tests|plugins|benchmarks)/[^)]*\.md[^)]*\)", r"\1", source[0])


def is_skipped(_app, _what, _name, item, skip, _options):
    """Fields of a NamedTuple: the text of the class describes them."""
    return True if (getattr(item, "__doc__", "") or "").startswith("Alias for field") else skip


def setup(app):
    app.connect("autodoc-skip-member", is_skipped)
    app.connect("source-read", without_links_to_other_pages)
