# SPDX-License-Identifier: Apache-2.0
# Sphinx configuration of the reference: the pages of docs and the Python package. Run by cmake/BuildReference.cmake.
import os
import re

from docutils import nodes
from docutils.parsers.rst import Directive

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
html_extra_path = ["site", "../../resources/schemas"]


def without_links_to_other_pages(_app, _name, source):
    """Markdown files outside of docs are not part of the site: their links become plain text."""
    source[0] = re.sub(r"\[([^\]]+)\]\((?:\.\./)+(?:tests|plugins|benchmarks)/[^)]*\.md[^)]*\)", r"\1", source[0])


def is_skipped(_app, _what, _name, item, skip, _options):
    """Fields of a NamedTuple: the text of the class describes them."""
    return True if (getattr(item, "__doc__", "") or "").startswith("Alias for field") else skip


class Parameters(Directive):
    """A table of the parameters that the simulator declares for a body, its supports and the world."""

    def run(self):
        import c3de
        try:
            sim = c3de.open(c3de.resource("scenes/first_light.toml"))
        except c3de.Error as error:
            return [self.state.document.reporter.warning("parameters: %s" % error, line=self.lineno)]
        with sim:
            declared = [(re.sub(r"^body\.[^.]+\.", "body.NAME.", one.path), one.unit, one.accepted, one.meaning)
                        for one in sim.parameters()]
        table = nodes.table()
        group = nodes.tgroup(cols=4)
        table += group
        group += [nodes.colspec(colwidth=width) for width in (28, 8, 22, 42)]
        head, body = nodes.thead(), nodes.tbody()
        group += [head, body]
        for part, cells in [(head, ("key", "unit", "accepted", "meaning"))] + [(body, row) for row in declared]:
            row = nodes.row()
            part += row
            for column, text in enumerate(cells):
                shown = nodes.literal(text=text) if column == 0 and part is body else nodes.Text(text)
                entry, paragraph = nodes.entry(), nodes.paragraph()
                paragraph += shown
                entry += paragraph
                row += entry
        return [table]


def setup(app):
    app.add_directive("c3de-parameters", Parameters)
    app.connect("autodoc-skip-member", is_skipped)
    app.connect("source-read", without_links_to_other_pages)
