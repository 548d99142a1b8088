"""Results of `tools/accuracy --check` and `tools/benchmarks --check` for made-up pages and for the committed ones."""
import contextlib
import importlib.machinery
import importlib.util
import io
import pathlib
import subprocess
import sys
import tempfile
import unittest
from unittest import mock

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import required_figures  # noqa: E402

PAGE = f"""# Made up
| other | table |
|---|---|
| not | asked |

## Ground
{required_figures.HEADER}
|---|---|---|---|
| floor | 99 % | 95 % | yes |
| edge: height | 7 mm | 5 mm | **no** |
| only shown | 3 mm | - | - |

## Times
{required_figures.HEADER}
|---|---|---|---|
| frame | 300 ms | at most 200 ms | **no** |

Words behind the table.
"""
KNOWN = """# a comment
made_up | edge: height | worn sensor | and old
elsewhere | frame | of another page
"""


class RequiredFigures(unittest.TestCase):
    def judge(self, page=PAGE, known=KNOWN):
        return required_figures.complaints(required_figures.figures(page),
                                           required_figures.known_misses(known, "made_up"))

    def test_all_tables_of_required_figures_are_read_and_no_other(self):
        self.assertEqual([row[0] for row in required_figures.figures(PAGE)], ["floor", "edge: height", "only shown", "frame"])

    def test_a_new_miss_is_a_sentence_and_a_known_one_is_none(self):
        self.assertEqual(self.judge(), ["frame: 300 ms; required at most 200 ms"])
        self.assertEqual(self.judge(known=KNOWN + "made_up | frame | slow\n"), [])

    def test_the_list_of_known_misses_does_not_rot(self):
        both = KNOWN + "made_up | frame | slow\n"
        self.assertEqual(self.judge(known=both + "made_up | farme | slow\n"),
                         ["farme: known as a miss, but no row has this name"])
        self.assertEqual(self.judge(known=KNOWN + "made_up | frame\n"), ["frame: known as a miss without a reason"])

    def test_a_page_that_cannot_be_judged_is_not_passed(self):
        self.assertEqual(self.judge("# Nothing\n", ""), ["the page holds no required figure at all"])
        both = KNOWN + "made_up | frame | slow\n"
        for wrong in ("| 99 % | 95 % | perhaps |", "| ms | at most 10 ms | not measured |", "| 99 % | 95 % | - |", "| 99 % |"):
            (sentence,) = self.judge(PAGE.replace("| 99 % | 95 % | yes |", wrong), both)
            self.assertIn("floor: not a row", sentence)
        twice = PAGE.replace("| floor |", "| frame |")
        self.assertEqual(self.judge(twice, both), ["frame: stands there 2 times"])

    def test_the_exit_status(self):
        with tempfile.TemporaryDirectory() as folder:
            page, known = pathlib.Path(folder) / "made_up.md", pathlib.Path(folder) / "known.txt"
            page.write_text(PAGE)
            for text, status in ((KNOWN, 1), (KNOWN + "made_up | frame | slow\n", 0)):
                known.write_text(text)
                said = io.StringIO()
                with mock.patch.object(required_figures, "KNOWN_MISSES", known), contextlib.redirect_stdout(said), \
                        contextlib.redirect_stderr(said):
                    self.assertEqual(required_figures.check(page), status)
                self.assertEqual("made_up.md: frame: 300 ms; required at most 200 ms" in said.getvalue(), status == 1)

    def test_the_pages_that_are_checked_in_hold_no_new_miss(self):
        for page in ("accuracy", "benchmarks"):
            done = subprocess.run([ROOT / "tools" / page, "--check"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)


class PartsOfThePage(unittest.TestCase):
    """`tools/accuracy --only PART` measures one section again."""

    def setUp(self):
        loader = importlib.machinery.SourceFileLoader("accuracy", str(ROOT / "tools" / "accuracy"))
        self.accuracy = importlib.util.module_from_spec(importlib.util.spec_from_loader("accuracy", loader))
        loader.exec_module(self.accuracy)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.page = pathlib.Path(folder.name) / "accuracy.md"

    def write(self, part, *rows, more=None):
        runner = self.accuracy.Runner("surefoot", self.page.parent)
        with contextlib.redirect_stdout(io.StringIO()):
            for row in rows:
                runner.row(*row)
            runner.figure(f"shown of {part}", "1 mm")
        self.accuracy.write_section(self.page, self.accuracy.PARTS[part], runner, more)
        return required_figures.figures(self.page.read_text())

    def test_one_section_is_replaced_and_the_others_stay(self):
        self.write("stairs", ("height", "3 mm", "5 mm", True))
        # Sections have the order of the parts, not of the runs.
        rows = self.write("pairs", ("cones", "97 %", "95 %", True), more=["", "Words."])
        self.assertEqual([row[0] for row in rows], ["cones", "shown of pairs", "height", "shown of stairs"])
        rows = self.write("stairs", ("height", "6 mm", "5 mm", False))
        self.assertEqual(rows, [("cones", "97 %", "95 %", "yes"), ("shown of pairs", "1 mm", "-", "-"),
                                ("height", "6 mm", "5 mm", "**no**"), ("shown of stairs", "1 mm", "-", "-")])
        text = self.page.read_text()
        self.assertEqual([text.count(words) for words in ("\n## Real stereo pairs\n", "Words.", "## Reading these figures")],
                         [1, 1, 1])
        self.assertEqual(required_figures.complaints(rows, {}), ["height: 6 mm; required 5 mm"])


if __name__ == "__main__":
    unittest.main()
