"""Error messages for users: one sentence that says what to do, and with --json one object."""
import json
import shutil
import unittest

from surefoot_cli import ROOT, CliTest, surefoot


class Typos(CliTest):
    def test_the_likely_name_is_told(self):
        for words, likely in ((["rnu", "sim:floor", "--out", "x"], "'run'"),
                              (["eval", "map", "a", "b"], "'maps'"),
                              (["run", "sim:floor", "--oout", "x"], "'--out'"),
                              (["run", "sim:demo_stair", "--out", "x"], "'demo_stairs'"),
                              (["sim", "demo_stair", "--out", "x"], "'demo_stairs'"),
                              (["sim", "floor", "--rig", "zed_vag", "--out", "x"], "'zed_vga'"),
                              (["run", "sim:floor", "--machine", "rexx", "--out", "x"], "'rex'"),
                              (["eval", "suite", "--scenes", "demo_stair", "--out", "x"], "'demo_stairs'"),
                              (["config", "--preset", "lasr"], "'laser'"),
                              (["config", "--set", "elevation.lenght_m=3"], "'elevation.length_m'")):
            with self.subTest(words):
                process = surefoot(*words, cwd=self.dir)
                self.assertEqual(process.returncode, 2, process.stderr)
                self.assertIn(f"did you mean {likely}", process.stderr)
                self.assertFalse((self.dir / "x").exists())

    def test_what_is_like_nothing_gets_no_guess(self):
        process = surefoot("qqqqqqqqqqqq")
        self.assertEqual(process.returncode, 2)
        self.assertIn("there is no verb 'qqqqqqqqqqqq'", process.stderr)
        self.assertNotIn("did you mean", process.stderr)


class Gate(CliTest):
    def gate(self, *words):
        process = surefoot("gate", "--pose", "0,0,0", "--json", *words, cwd=self.dir)
        return process, json.loads(process.stdout)

    def test_a_word_as_command_is_answered_with_the_codes(self):
        for word in ("walk", "-1", "256", "9.5", ""):
            process, answer = self.gate("--map", "nope", f"--command={word}")
            self.assertEqual(process.returncode, 2, word)
            self.assertEqual(answer["verdict"], "ERROR")
        self.assertIn("--command 'walk'", self.gate("--map", "nope", "--command", "walk")[0].stderr)
        self.assertIn("9 N", self.gate("--map", "nope", "--command", "walk")[0].stderr)

    def test_without_a_map_the_answer_names_what_was_asked(self):
        process, answer = self.gate("--map", "nope", "--command", "9")
        self.assertEqual(process.returncode, 4)
        self.assertEqual((answer["verdict"], answer["command"]), ("ERROR", 9))

    def test_a_wrong_call_is_no_verdict_but_ERROR(self):
        for words in ([], ["--map", "x"], ["--map", "x", "--command", "9", "--machine", "nobody"]):
            process, answer = self.gate(*words)
            self.assertEqual((process.returncode, answer["verdict"]), (2, "ERROR"), words)

    def test_help_tells_every_exit_code(self):
        text = surefoot("gate", "--help").stdout
        for code in ("0 OK", "3 NOT_TRAVERSABLE", "4 ERROR", "2 wrong call"):
            self.assertIn(code, " ".join(text.split()))


class FailuresInJson(CliTest):
    CALLS = ((1, "run", "nope", "--out", "x"), (2, "run", "sim:nope", "--out", "x"), (2, "run"), (2, "nope"),
             (2, "sim", "nope", "--out", "x"), (1, "depth", "nope", "nope", "--out", "x"), (2, "depth", "nope"),
             (2, "depth-accuracy", "--rig", "nope.yaml", "--pairs", "nope", "--out", "x"), (1, "rate", "nope.asc", "--out", "x"),
             (1, "fuse", "nope", "--preset", "ethz", "--out", "x"), (1, "ground", "nope.ply"),
             (1, "dem", "nope.ply", "--resolution", "1", "--out", "x"), (1, "eval", "trajectory", "nope", "nope"),
             (1, "eval", "maps", "nope", "nope"), (1, "eval", "depth", "nope.pfm", "nope.pfm"), (2, "eval"),
             (2, "eval", "suite", "--scenes", "nope", "--out", "x"),
             (1, "calibrate", "mono", "nope", "--board", "chessboard:8x5:0.03", "--out", "x"),
             (2, "calibrate", "stereo", "nope", "--board", "nope", "--out", "x"), (2, "config", "--set", "nope=1"),
             (2, "doctor", "--machine", "nope"), (2, "bench", "nope"), (1, "record", "nope", "--out", "x"),
             (1, "replay", "nope"), (1, "info", "nope"), (1, "rig", "nope"))

    def test_every_verb_prints_one_object_with_its_sentence(self):
        for code, *words in self.CALLS:
            with self.subTest(words):
                process = surefoot(*words, "--json", cwd=self.dir)
                answer = json.loads(process.stdout)
                self.assertEqual((process.returncode, answer["exit_code"]), (code, code), process.stderr)
                self.assertTrue(answer["error"])
                self.assertIn(answer["error"], process.stderr)
                plain = surefoot(*words, cwd=self.dir)
                self.assertEqual((plain.returncode, plain.stdout), (code, ""))
                self.assertEqual(plain.stderr, process.stderr)


class DepthScale(CliTest):
    def test_a_truth_that_is_not_in_pixels_is_noticed(self):
        depth = ROOT / "tests" / "conformance" / "depth"
        words = ["eval", "depth", depth / "disparity.pfm", depth / "truth.pfm", "--json"]
        process = self.run_ok(*words)
        scale = json.loads(process.stdout)["scale"]
        self.assertEqual((scale["used"], scale["suspected"], process.stderr), (1, None, ""))
        self.assertAlmostEqual(scale["truth_over_estimate"], 1.0, delta=0.05)
        # The same truth with a wrong scale of 1/16 px: the disparities are 16 times too large.
        process = self.run_ok(*words, "--scale", 0.0625)
        self.assertEqual(json.loads(process.stdout)["scale"]["suspected"], 1)
        self.assertIn("--scale 1", process.stderr)


class Scan(CliTest):
    def test_says_how_much_it_will_write(self):
        process = self.run_ok("sim", "demo_stairs", "--scan", self.dir / "s.ply", "--set", "sim.laser.step_deg=1", "--json")
        points = json.loads(process.stdout)["points"]
        said = float(process.stderr.split("about ")[1].split()[0])
        # The estimate for 1 deg comes from a fan of 2 deg, whose borders are 1 % of the beams.
        self.assertAlmostEqual(said / points, 1.0, delta=0.03)

    def test_refuses_what_the_disk_has_no_room_for(self):
        if shutil.disk_usage(self.dir).free > 5e12:
            self.skipTest("20 scans of 5e10 beams would fit on this disk")
        words = 20 * ["--station", "0,0,1.6"]
        process = surefoot("sim", "floor", "--scan", self.dir / "s.ply", "--set", "sim.laser.step_deg=0.001", *words)
        self.assertEqual(process.returncode, 1, process.stderr)
        self.assertIn("the disk has", process.stderr)
        self.assertFalse((self.dir / "s.ply").exists())


class EmptyMap(CliTest):
    def test_a_map_that_ends_before_the_view_begins_says_so(self):
        run = self.dir / "run"
        answer = self.json_of("run", "sim:floor", "--max-frames", 2, "--set", "elevation.length_m=1", "--out", run)
        self.assertEqual(answer["map"]["known_cells"], 0)
        self.assertIn("no pixel falls into it", answer["map"]["reason"])
        self.assertIn("elevation.length_m", answer["map"]["reason"])


class NoGround(CliTest):
    def test_a_wall_in_place_of_the_floor_gets_advice(self):
        wall = "".join(f"{0.02 * i} 2.0 {0.02 * j}\n" for i in range(100) for j in range(100))
        (self.dir / "wall.xyz").write_text(wall)
        process = surefoot("ground", self.dir / "wall.xyz")
        self.assertEqual(process.returncode, 1)
        for advice in ("--origin", "--frame", "ground.max_tilt_deg"):
            self.assertIn(advice, process.stderr)


if __name__ == "__main__":
    unittest.main()
