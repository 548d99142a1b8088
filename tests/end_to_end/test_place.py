"""run --place: a place database is saved, recognised and extended; unusable files give an error."""
import json

from surefoot_cli import CliTest, surefoot

QUICK = ("--max-frames", 44, "--depth-every", 3, "--set", "elevation.length_m=2")


class Places(CliTest):
    def visit(self, *extra):
        file = self.dir / "home.place"
        self.run_ok("run", "sim:room", "--out", self.dir / "out", "--place", file, *extra)
        return json.loads((self.dir / "out" / "report.json").read_text())["place"]

    def test_the_second_run_finds_the_place_of_the_first(self):
        first = self.visit(*QUICK)
        self.assertEqual((first["saved_keyframes"], first["recognitions"], first["left_as_it_was"]), (0, 0, None))
        self.assertEqual(first["T_map_odom"], [0, 0, 0, 0, 0, 0, 1])
        self.assertGreaterEqual(first["own_keyframes"], 3)
        self.assertEqual(first["kept_keyframes"], first["own_keyframes"])
        bytes_of_first = (self.dir / "home.place").read_bytes()
        second = self.visit(*QUICK)
        self.assertEqual(second["saved_keyframes"], first["kept_keyframes"])
        self.assertGreater(second["recognitions"], 0)
        self.assertIsNotNone(second["recognised_ns"])
        for value in second["T_map_odom"][:6]:
            self.assertLess(abs(value), 0.01)  # both runs start at the same pose
        size = len(bytes_of_first) - 8
        self.assertEqual((self.dir / "home.place").read_bytes()[32:size], bytes_of_first[32:size])

    def test_without_images_nothing_is_remembered(self):
        place = self.visit("--max-frames", 2, "--set", "sim.sensor=analytic")
        self.assertEqual((place["own_keyframes"], place["T_map_odom"]), (0, None))
        self.assertEqual(place["left_as_it_was"], "no frame had images and depth")
        self.assertFalse((self.dir / "home.place").exists())

    def test_a_file_that_cannot_be_used_stays_and_ends_the_call(self):
        file = self.dir / "foreign.place"
        file.write_text("not a place")
        process = surefoot("run", "sim:floor", "--max-frames", 2, "--out", self.dir / "out", "--place", file)
        self.assertEqual(process.returncode, 1)
        self.assertIn("foreign.place: not a remembered place", process.stderr)
        self.assertEqual(file.read_text(), "not a place")
        self.assertFalse((self.dir / "out").exists())
        process = surefoot("run", "sim:floor", "--max-frames", 2, "--out", self.dir / "out", "--place",
                           self.dir / "none" / "a.place")
        self.assertEqual(process.returncode, 2)
        self.assertIn("there is no folder", process.stderr)
