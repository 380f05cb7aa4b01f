"""Adds every page of the tree, and every file that a page links to, to the site of mkdocs.yml.

Names of headings are GitHub's, so that links between pages hold in both. A page that is not in the navigation is a
warning, which --strict turns into an error.
"""

import logging
import os
import re

from mkdocs.structure.files import File, Files

SKIPPED = {"build", "node_modules", "tests/fuzz"}
LINK = re.compile(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)")
CODE = re.compile(r"^    .*$|^```(?s:.*?)^```$", re.MULTILINE)

log = logging.getLogger("mkdocs.dlo")


def slug(text, separator):
    """Returns the anchor that GitHub gives to a heading."""
    del separator
    return re.sub(r"[^\w -]", "", text.strip().lower()).replace(" ", "-")


def pages_of(root):
    """Yields the paths of all pages relative to the root."""
    for folder, names, files in os.walk(root):
        here = os.path.relpath(folder, root)
        names[:] = [n for n in names
                    if not n.startswith(".") and n not in SKIPPED and os.path.join(here, n) not in SKIPPED]
        yield from (os.path.normpath(os.path.join(here, f)) for f in files if f.endswith(".md"))


def on_config(config):
    config["mdx_configs"].setdefault("toc", {})["slugify"] = slug
    return config


def on_files(files, config):
    root = os.path.dirname(config["config_file_path"])
    found = {path: None for path in sorted(pages_of(root))}
    found.pop("tests/doc/main.md", None)  # Doxygen's first page
    for page in list(found):
        with open(os.path.join(root, page), encoding="utf-8") as file:
            for target in LINK.findall(CODE.sub("", file.read())):
                path = os.path.normpath(os.path.join(os.path.dirname(page), target))
                if not path.endswith(".md") and os.path.isfile(os.path.join(root, path)):
                    found.setdefault(path, None)
    theme = [f for f in files if f.abs_src_path and not f.abs_src_path.startswith(config["docs_dir"])]
    ours = [File(path, root, config["site_dir"], config["use_directory_urls"]) for path in found]
    return Files(theme + ours)


def on_nav(nav, config, files):
    listed = {page.file.src_uri for page in nav.pages}
    for file in files.documentation_pages():
        if file.src_uri not in listed:
            log.warning("%s is not in the navigation of mkdocs.yml", file.src_uri)
    return nav
