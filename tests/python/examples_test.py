"""Tests that the examples run, and that every page shows what its Python prints."""

import contextlib
import importlib.util
import io
import os
import pathlib
import re

import pytest

ROOT = pathlib.Path(os.environ["DLO_ROOT"])
PAGES = sorted(str(path.relative_to(ROOT)) for folder in (".", "doc", "compare", "force_model", "energy_model", "data")
               for path in (ROOT.glob("*.md") if folder == "." else (ROOT / folder).rglob("*.md"))
               if "node_modules" not in path.parts and "```python\n" in path.read_text())


@pytest.mark.parametrize("path", sorted((ROOT / "compare/python/examples").glob("*.py")),
                         ids=lambda path: path.stem)
def test_example_runs(path):
    """Each example asserts the results that its text states."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(path.read_text(), path, "exec"), {"__name__": "__main__"})
    assert printed.getvalue()


def blocks(page):
    """Returns pairs (code, output or None) of a page's fenced blocks."""
    fenced = re.findall(r"^```(python|text)\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    for i, (kind, text) in enumerate(fenced):
        if kind == "python":
            shown = fenced[i + 1] if i + 1 < len(fenced) else ("", "")
            yield text, shown[1] if shown[0] == "text" else None


@pytest.mark.parametrize("name", PAGES)
def test_page_shows_what_it_prints(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "data").symlink_to(ROOT / "data")
    names = {"__name__": "__main__"}
    found = list(blocks((ROOT / name).read_text()))
    assert found
    for code, shown in found:
        if "vtkmodules" in code and importlib.util.find_spec("vtkmodules") is None:
            continue  # .ci/nightly installs it
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(code, name, "exec"), names)
        if shown is not None:
            assert printed.getvalue() == shown
