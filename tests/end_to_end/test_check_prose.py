"""Findings of `tools/check_prose` in made-up pages; the project's own documents must have none."""
import importlib.machinery
import importlib.util
import pathlib
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
loader = importlib.machinery.SourceFileLoader("check_prose", str(ROOT / "tools" / "check_prose"))
check_prose = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
loader.exec_module(check_prose)


def found(text):
    """Line and words of each finding, without the suggested replacement."""
    return [(line, phrase[1:].split(" -> ")[0].lower()) for line, _, phrases in check_prose.findings("page.md", text)
            for phrase in phrases]


class CheckProse(unittest.TestCase):
    def test_each_rule_is_found_at_the_start_and_in_the_middle_of_a_sentence(self):
        rules = [line.split("\t")[0].strip() for line in check_prose.RULES.read_text().splitlines()]
        self.assertGreater(len(rules), 40)
        for rule in rules:
            with self.subTest(rule):
                self.assertIn((1, rule), found(f"{rule} is a phrase.\n"))
                self.assertIn((1, rule), found(f"The gate reads {rule} here.\n"))

    def test_paragraphs_lists_headings_and_tables_are_read(self):
        for text, line in (("# Title\n\nThe gate\nstarts anew.\n", 3), ("* one\n* start it anew\n", 2), ("# Start it anew\n", 1),
                           ("| a | b |\n|---|---|\n| gate | starts anew |\n", 3), ("[start anew](page.md)\n", 1),
                           ("<!-- measured: begin -->\n1 m\n<!-- measured: end -->\nStart anew.\n", 4)):
            with self.subTest(text):
                self.assertEqual(found(text), [(line, "anew")])

    def test_a_phrase_over_two_lines_and_a_doubled_word_are_found(self):
        self.assertEqual(found("Start the gate in\norder to ask it.\n"), [(1, "in order to")])
        self.assertEqual(found("The gate asks the\nthe map.\n"), [(1, "the the")])

    def test_code_measured_blocks_and_longer_words_are_not_found(self):
        for text in ("Write `--attest 1` and `told`.\n", "```\nstart anew\n```\n", "    start anew\n",
                     "<!-- measured: begin -->\nstart anew\n<!-- measured: end -->\n", "[words](anew.md)\n",
                     "The scaffold of every renewed eyelet.\n", "Use `a` `b` and `a`.\n"):
            with self.subTest(text):
                self.assertEqual(found(text), [])

    def test_our_documents_are_read_and_have_no_fault(self):
        names = check_prose.documents()
        for name in ("README.md", "docs/index.md", "docs/evidence/safety.md", "surefoot/gate/README.md"):
            self.assertIn(name, names)
        self.assertFalse([name for name in names if name.startswith(("docs/lab/", "docs/decisions/"))])
        ended = subprocess.run([ROOT / "tools" / "check_prose"], capture_output=True, text=True)
        self.assertEqual((ended.returncode, ended.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
