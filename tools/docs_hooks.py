"""Prepares a page before MkDocs renders it (`make docs`).

Links that leave docs/ (to sources and to files at the top of the repository) become plain text, because the site
contains only the documents. A link to a file that does not exist stops the build.
"""
import os
import pathlib
import re

from mkdocs.exceptions import PluginError
from mkdocs.structure.nav import Link

ROOT = pathlib.Path(__file__).resolve().parent.parent
SECTIONS = {"get_started": "Get started", "how_to": "How to", "concepts": "Concepts", "reference": "Reference",
            "evidence": "Evidence", "lab": "Lab notebook"}
FIRST = {"get_started": ["install", "own_camera", "understand_the_answer", "use_the_library"],
         "concepts": ["depth", "odometry", "ground_and_gravity", "elevation_map", "traversability", "stairs", "gate"],
         "evidence": ["index", "headline_figures", "safety", "accuracy", "benchmarks", "foreign_data"], "lab": ["index"],
         "reference": ["cli", "settings", "glossary", "hazards", "gate_reasons"]}
LINK = re.compile(r"\[([^\]]*)\]\(([^)\s#]+)(#[^)\s]*)?\)")


def on_config(config):
    """The navigation: one section per folder, with the most important pages first."""
    docs = ROOT / "docs"
    config["nav"] = [{"Home": "index.md"}]
    for folder, title in SECTIONS.items():
        names = [path.stem for path in (docs / folder).glob("*.md") if path.stem != "accuracy_notes"]
        first = [name for name in FIRST.get(folder, []) if name in names]
        config["nav"].append({title: [f"{folder}/{name}.md" for name in first + sorted(set(names) - set(first))]})
    config["nav"][-2]["Evidence"].append("evidence/results/README.md")
    config["nav"].append({"Decisions": "decisions/index.md"})
    return config


def on_files(files, config):
    """Removes files for Doxygen from the site."""
    for file in [file for file in files if file.src_path in ("Doxyfile", "api_main_page.dox")]:
        files.remove(file)
    return files


def on_nav(nav, config, files):
    """Doxygen writes the C++ reference after MkDocs: `nav` of the configuration would report a missing page."""
    reference = next(section for section in nav.items if section.title == SECTIONS["reference"])
    link = Link("C++ API", "api/index.html")
    link.parent = reference
    reference.children.insert(len(FIRST["reference"]), link)
    return nav


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
