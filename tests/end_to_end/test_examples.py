"""Runs each example of examples/ as its first lines say. The umbrella API and the command line must give the same results."""
import math
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import surefoot_cli

EXAMPLES = pathlib.Path(os.environ["EXAMPLES"])


def run(example, *words):
    ended = subprocess.run([EXAMPLES / example, *map(str, words)], capture_output=True, text=True, timeout=300)
    return ended.returncode, ended.stdout, ended.stderr


class Examples(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        folder = pathlib.Path(cls.folder.name)
        cls.recording, cls.run_folder = folder / "recording", folder / "run"
        for call in (("sim", "demo_stairs", "--frames", 40, "--out", cls.recording),
                     ("run", cls.recording, "--machine", "rex", "--out", cls.run_folder)):
            ended = surefoot_cli.surefoot(*call)
            assert ended.returncode == 0, ended.stderr
        cls.heights = cls.run_folder / "elevation.asc"

    def test_a_recording_is_run(self):
        code, out, err = run("01_run_a_recording", self.recording)
        self.assertEqual((code, err), (0, ""))
        frames = re.findall(r"^frame (\d+): base_link at .* (\d+) cells known$", out, re.M)
        self.assertEqual([int(index) for index, _ in frames], list(range(40)))
        self.assertGreater(int(frames[-1][1]), 2000)

    def test_depth_images_become_a_map(self):
        code, out, err = run("02_map_from_depth_images")
        self.assertEqual((code, err), (0, ""))
        height_m = float(re.search(r"1\.5 m ahead is at (\S+) m", out)[1])
        self.assertLess(abs(height_m), 0.003)

    def test_heights_are_rated(self):
        code, out, err = run("03_rate_a_height_map", self.heights)
        self.assertEqual((code, err), (0, ""))
        known, cells, free = map(int, re.findall(r"\d+", out)[:3])
        self.assertTrue(cells >= known > free > 0, out)

    def test_stairs_are_found(self):
        code, out, err = run("04_find_stairs", self.heights, 0, 0)
        self.assertEqual((code, err), (0, ""))
        self.assertRegex(out, r"(?m)^\d+ flights, \d+ drops$")

    def test_the_gate_answers_as_the_command_line_does(self):
        code, out, err = run("05_ask_the_gate", self.recording, "rex", 9)
        self.assertEqual((code, err), (0, ""))
        last = out.splitlines()[-1]
        _, x, y, _, qx, qy, qz, qw = surefoot_cli.read_tum(self.run_folder / "trajectory.tum")[-1]
        yaw = math.atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))
        # No operator attests the ground for the example.
        asked = surefoot_cli.surefoot("gate", "--map", self.run_folder, "--pose", f"{x},{y},{yaw}", "--command", 9, "--machine", "rex",
                                      "--attest", 0)
        self.assertEqual(last, asked.stdout.strip())

    def test_ones_own_camera_is_connected(self):
        code, out, err = run("06_my_own_camera")
        self.assertEqual((code, err), (0, ""))
        pixels = [int(count) for count in re.findall(r": (\d+) pixels with depth", out)]
        self.assertEqual(len(pixels), 15)
        self.assertGreater(min(pixels), 100_000)

    def test_a_machine_is_described(self):
        code, out, err = run("07_my_own_machine", "rex")
        self.assertEqual((code, err), (0, ""))
        self.assertRegex(out, r"movement 9 \(N\)")
        code, _, err = run("07_my_own_machine", "no_such_machine")
        self.assertEqual(code, 1)
        self.assertIn("Known names: rex", err)

    def test_errors_say_what_is_wrong(self):
        for words in (("01_run_a_recording", "/no/such/folder"), ("03_rate_a_height_map", "/no/such/file.asc"),
                      ("05_ask_the_gate", "/no/such/folder", "rex", 9)):
            code, out, err = run(*words)
            self.assertEqual((code, out), (1, ""))
            self.assertIn("/no/such", err)
            self.assertEqual(run(words[0])[0], 2)


if __name__ == "__main__":
    unittest.main()
