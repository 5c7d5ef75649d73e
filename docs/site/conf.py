# SPDX-License-Identifier: GPL-2.0-or-later
"""The site of the documents: `scripts/docs.sh`. Its root is that of the repository, so links are those of the files."""

import pathlib

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml
from pygments.lexer import RegexLexer, words
from pygments.token import Comment, Keyword, Name, Number, Operator, String, Text

ROOT = pathlib.Path(__file__).resolve().parents[2]

project = "Spot drainage"
author = "The authors of spot-drainage"
copyright = "the authors of spot-drainage"
version = release = (ROOT / "VERSION").read_text().strip()

extensions = ["myst_parser"]
root_doc = "docs/index"
# docs/index.md is the front page of the site, README.md that of the repository.
include_patterns = ["docs/**", "*.md", "*/README.md", "examples/**/*.md", "liggghts-inputs/**/README.md",
                    "lammps-package/doc/*.rst"]
exclude_patterns = [".pytest_cache", "README.md", "docs/site", "build*", "results", "**/.*"]

myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # a note may begin with a heading of any level
nitpicky = True

html_theme = "furo"
html_title = f"Spot drainage {version}"
html_extra_path = ["redirect"]
html_static_path = ["static"]
html_css_files = ["wider.css"]
html_copy_source = False
html_show_sphinx = False
html_math_renderer = "mathml"  # drawn by browsers themselves: no network, no script
highlight_language = "none"
pygments_style = "default"


class LammpsLexer(RegexLexer):
    """Words of input scripts, as coarse as readers need: commands, comments, variables and numbers."""

    name = "LAMMPS"
    aliases = ["LAMMPS", "lammps"]
    tokens = {
        "root": [
            (r"#.*$", Comment),
            (r"\$\{[^}]*\}|\$\([^)]*\)|\$\w", Name.Variable),
            (r'"[^"]*"', String),
            (r"&$", Operator),
            (words(("atom_style", "boundary", "dump", "dump_modify", "fix", "fix_modify", "include", "plugin", "read_data",
                    "region", "run", "thermo", "thermo_style", "timestep", "units", "variable"), prefix="^ *", suffix=r"\b"),
             Keyword),
            (r"(?<![\w.])[-+]?\d[\d.]*(e[-+]?\d+)?(?![\w.])", Number),
            (r"\s+|\S", Text),
            (r"\w+", Text),
        ]
    }


def link_page_of_lammps(app, env, node, contnode):
    """fix_spot.rst refers to pages of LAMMPS by :doc:, which stand beside it in LAMMPS' own manual."""
    if node.get("refdomain") != "std" or node.get("reftype") != "doc" or not node.get("refdoc", "").startswith("lammps-package/doc/"):
        return None
    return nodes.reference("", "", contnode, internal=False, refuri=f"https://docs.lammps.org/{node['reftarget']}.html")


def math_as_mathml(inline):
    def visit(translator, node):
        mathml = tex2mathml(node.astext(), inline)
        translator.body.append(mathml if inline else f'<div class="math">{mathml}</div>')
        raise nodes.SkipNode
    return visit, None


def setup(app):
    app.add_lexer("LAMMPS", LammpsLexer)
    app.add_html_math_renderer("mathml", math_as_mathml(True), math_as_mathml(False))
    app.connect("missing-reference", link_page_of_lammps)
    return {"parallel_read_safe": True}
