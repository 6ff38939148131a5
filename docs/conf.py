"""How Sphinx builds the site: ``make docs``. It needs no network, neither to build nor to read."""

import sys
from pathlib import Path

from sphinx.application import Sphinx

FOLDER = Path(__file__).parent
# The commands of the development tools are on the page of commands, installed or not.
sys.path[:0] = [str(FOLDER.parent), str(FOLDER.parent / "devtools"), str(FOLDER / "extensions")]

from neurotouch_hid import __version__  # noqa: E402  (found by the lines above)

project = "neurotouch_hid"
author = "The neurotouch_hid maintainers"
copyright = f"2026, {author}"  # noqa: A001  (Sphinx wants this name)
version = release = __version__

extensions = [
    "command_pages",
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
]

# A heading can be linked to as FILE.md#its-words, as on the pages that show Markdown themselves.
myst_heading_anchors = 4
myst_enable_extensions = ["deflist"]

smartquotes_action = "De"  # "--" and "..." only: quotes stay as they are typed

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True

# Every link must lead somewhere. In signatures, names that the API's page does not describe stay
# without a link, and so do those of other projects, whose indexes would have to be downloaded.
nitpicky = True
nitpick_ignore_regex = [("py:.*", r"(?!neurotouch_hid\.(messages|errors|gel)\.).*")]

html_theme = "furo"
html_title = "neurotouch_hid"
html_static_path = ["pictures"]
html_favicon = "../neurotouch_hid/page/static/shared/icon.svg"
html_show_sourcelink = False
html_copy_source = False


def setup(app: Sphinx) -> None:
    """Gives the groups of pages at the side a level, so that screen readers can jump to them."""
    app.connect("html-page-context", add_level, priority=900)  # after the theme has made them


def add_level(_app: Sphinx, _page: str, _template: str, context: dict[str, str], _: object) -> None:
    """Changes the theme's list of pages in place."""
    tree = context.get("furo_navigation_tree", "")
    context["furo_navigation_tree"] = tree.replace(
        'role="heading"', 'role="heading" aria-level="2"'
    )
