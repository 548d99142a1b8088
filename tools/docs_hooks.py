"""What `make docs` does to a page before MkDocs renders it.

Links that leave docs/ (to sources and to files at the top of the repository) become plain text: the site holds the
documents alone. A link to a file that does not exist stops the build.
"""
import os
import pathlib
import re

from mkdocs.exceptions import PluginError

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"\[([^\]]*)\]\(([^)\s#]+)(#[^)\s]*)?\)")


def on_page_markdown(markdown, page, **_):
    folder = (ROOT / "docs" / page.file.src_path).parent

    def replace(match):
        words, target = match.group(1), match.group(2)
        if re.match(r"[a-z]+:", target):
            return match.group(0)
        path = pathlib.Path(os.path.normpath(folder / target))
        if not path.exists():
            raise PluginError(f"docs/{page.file.src_path}: the link to '{target}' leads to no file")
        if path.is_relative_to(ROOT / "docs"):
            return match.group(0)
        return f"{words} (`{path.relative_to(ROOT)}`)" if words != str(path.relative_to(ROOT)) else f"`{words}`"

    return LINK.sub(replace, markdown)
