"""Findings of `tools/check_conversions` in made-up sources; it also reads all sources of the project."""
import importlib.machinery
import importlib.util
import pathlib
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
loader = importlib.machinery.SourceFileLoader("check_conversions", str(ROOT / "tools" / "check_conversions"))
check_conversions = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
loader.exec_module(check_conversions)


def lines_found(source, header=""):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "made_up.cpp"
        path.write_text(source)
        if header:
            path.with_suffix(".hpp").write_text(header)
        return [line for line, _ in check_conversions.findings(path)]


class CheckConversions(unittest.TestCase):
    def test_each_way_to_convert_is_found(self):
        for text in ("static_cast<int>(x_m)", "static_cast<std::size_t>(std::floor(at))", "static_cast<std::int64_t>(n * 1e9)",
                     "std::lround(x)", "llrint(x)", "p_m.cast<int>()", "v_m.template cast<std::int32_t>()",
                     "static_cast<unsigned>(p.x())", "static_cast<Eigen::Index>(2.0F * k)"):
            with self.subTest(text):
                self.assertEqual(lines_found(f"void f() {{\n    g({text});\n}}\n"), [2])

    def test_a_name_declared_as_a_number_with_a_point_is_found(self):
        self.assertEqual(lines_found("int f(double share) {\n    return static_cast<int>(share);\n}\n"), [2])
        self.assertEqual(lines_found("int A::f() {\n    return static_cast<int>(share_);\n}\n", "struct A { float share_; };\n"), [2])

    def test_a_conversion_over_several_lines_is_found_where_it_begins(self):
        self.assertEqual(lines_found("int f(int n) {\n    return static_cast<int>(\n        n *\n        0.5);\n}\n"), [2])

    def test_what_is_checked_proven_or_an_integer_is_not_found(self):
        for text in ("checked_integer<int>(x_m)", "saturated_integer<int>(std::floor(x_m))", "static_cast<int>(count)",
                     "static_cast<int>(points_m.size())", "static_cast<std::size_t>(saturated_integer<int>(x_m))",
                     "static_cast<int>(x_m);  // in range: x_m is a share of 10", "// static_cast<int>(x_m)",
                     "static_cast<double>(x_m)"):
            with self.subTest(text):
                self.assertEqual(lines_found(f"void f(int count) {{\n    g({text});\n}}\n"), [])

    def test_a_reason_counts_on_its_line_and_the_one_below_alone(self):
        reason = "    // in range: clamped above\n"
        cast = "    n = static_cast<int>(x_m);\n"
        self.assertEqual(lines_found("{\n" + reason + cast + cast + "}\n"), [4])

    def test_all_of_our_folders_are_read(self):
        folders = {path.relative_to(ROOT).parts[0] for path in check_conversions.sources()}
        self.assertEqual(folders, set(check_conversions.FOLDERS))


if __name__ == "__main__":
    unittest.main()
