"""Findings of the document checks in made-up pages; the project's own documents must have none."""
import importlib.machinery
import importlib.util
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def tool(name):
    loader = importlib.machinery.SourceFileLoader(name, str(ROOT / "tools" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


class Links(unittest.TestCase):
    def problems(self, text):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "page.md"
            (page.parent / "other.md").write_text("# Other page\n## The `gate`: why?\n<a id=\"h6\"></a>\n")
            page.write_text(text)
            return list(tool("check_links").problems_of_links(page, text))

    def test_links_that_lead_somewhere_are_right(self):
        for link in ("other.md", "other.md#other-page", "other.md#the-gate-why", "other.md#h6", "https://example.org/x", "#page"):
            self.assertEqual(self.problems(f"# Page\n[words]({link})\n"), [], link)

    def test_a_link_without_a_file_or_heading_is_found(self):
        self.assertEqual(self.problems("[words](gone.md)"), ["the link to 'gone.md' leads to no file"])
        self.assertEqual(self.problems("![picture](img/gone.png)"), ["the link to 'img/gone.png' leads to no file"])
        self.assertEqual(self.problems("[words](other.md#gone)"), ["the link to 'other.md#gone' leads to no heading"])

    def test_code_is_no_link(self):
        self.assertEqual(self.problems("`[words](gone.md)`\n```\n[words](gone.md)\n```\n"), [])

    def test_our_pages_have_no_such_link(self):
        ended = subprocess.run([ROOT / "tools" / "check_links"], capture_output=True, text=True)
        self.assertEqual((ended.returncode, ended.stderr), (0, ""))


class Messages(unittest.TestCase):
    def test_strings_that_stand_together_are_one_text(self):
        source = 'f("the first part "\n  "of one text");  // "not this comment here"\nf("x", "two words", R"(raw "text" of four words)");\n'
        self.assertEqual(tool("check_messages").messages_of(source),
                         [(1, "the first part of one text"), (3, 'raw "text" of four words')])

    def test_comment_lines_are_one_text(self):
        source = "/// Height of the ground\n/// in odom [m].\nint x;  ///< how many were seen\n// SPDX-License-Identifier: Apache-2.0\n"
        self.assertEqual(tool("check_messages").comments_of(source),
                         [(1, "Height of the ground in odom [m]."), (3, "how many were seen")])

    def test_rows_of_a_table_are_paragraphs(self):
        found = tool("check_messages").paragraphs_of("Some words here.\nAnd more.\n\n| a row of words |\n| another row of words |\n")
        self.assertEqual([text for _, text in found], ["Some words here. And more.", "| a row of words |", "| another row of words |"])


if __name__ == "__main__":
    unittest.main()
