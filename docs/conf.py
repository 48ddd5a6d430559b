"""Sphinx settings; `docs/build.py` prepares the sources and starts Sphinx."""

import json
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path[0:0] = [str(ROOT), str(HERE)]

from actuator_opt.version import VERSION  # noqa: E402

_prepared = json.loads((HERE / "_build" / "prepared.json").read_text("utf-8"))

project = "actuator-opt"
author = "The actuator-opt authors"
version = release = VERSION
extensions = [
    "myst_parser",
    "extensions.runs",
    "extensions.roles",
    "extensions.mathml",
    "extensions.navigation",
]
source_suffix = {".md": "markdown"}
exclude_patterns = ["README.md"]
nitpicky = True
language = "en"

myst_enable_extensions = ["dollarmath", "colon_fence", "deflist", "attrs_inline"]
myst_heading_anchors = 3
suppress_warnings = ["myst.header"]
reference_labels = _prepared["labels"]
run_folders = _prepared["runs"]
math_numfig = False
html_math_renderer = "mathml"
highlight_language = "none"
pygments_style, pygments_dark_style = "friendly", "native"

html_theme = "furo"
html_title = f"actuator-opt {VERSION}"
html_static_path = [str(HERE / "_static")]
html_css_files = ["actuator-opt.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
html_show_sphinx = False
html_theme_options = {"top_of_page_buttons": []}
html_use_index = False
html_show_search_summary = False  # a browser may not read other files of a folder
html_domain_indices = False
html_permalinks_icon = "#"
toc_object_entries = False
maximum_signature_line_length = 90
