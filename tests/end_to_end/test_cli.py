"""Every verb: help, its example, exit codes, JSON names."""
import json
import re
import shlex
import unittest

from surefoot_cli import ROOT, CliTest, surefoot

# In the order in which one example needs another's results.
VERBS = [["sim"], ["run"], ["rate"], ["fuse"], ["ground"], ["gate"], ["eval"], ["eval", "trajectory"],
         ["eval", "maps"], ["eval", "suite"], ["config"], ["doctor"], ["bench"], ["record"], ["replay"], ["info"]]
GATE_EXIT_CODES = (0, 3, 4)


class Verbs(CliTest):
    def test_every_verb_of_the_program_is_listed_here(self):
        listed = re.findall(r"^  ([a-z]+) ", surefoot("--help").stdout.split("Subcommands:")[1], re.M)
        self.assertEqual(sorted(listed), sorted({verb[0] for verb in VERBS}))

    def test_every_help_has_an_example_and_the_example_runs(self):
        (self.dir / "tests").symlink_to(ROOT / "tests")
        for verb in VERBS:
            process = surefoot(*verb, "--help")
            self.assertEqual(process.returncode, 0, verb)
            self.assertIn("Example:", process.stdout, verb)
            example = process.stdout.split("Example:")[1].strip().splitlines()[0].strip()
            words = shlex.split(example)
            self.assertEqual(words[0], "surefoot")
            process = surefoot(*words[1:], cwd=self.dir)
            allowed = GATE_EXIT_CODES if verb == ["gate"] else (0,)
            self.assertIn(process.returncode, allowed, f"{example}\n{process.stderr}")
            if "--json" in words or verb == ["gate"]:
                self.assertTrue(process.stdout.strip(), example)

    def test_wrong_calls_exit_with_2_and_say_why(self):
        for words in (["walk"], ["run"], ["run", "sim:floor"], ["sim", "nowhere", "--out", "x"],
                      ["rate", "a.asc", "--out", "x", "--preset", "nothing"],
                      ["gate", "--map", "nowhere", "--pose", "0,0", "--command", "9"],
                      ["config", "--set", "elevation.lenght_m=3"],
                      ["config", "--set", "elevation.length_m"]):
            process = surefoot(*words, cwd=self.dir)
            self.assertEqual(process.returncode, 2, f"{words}: {process.stderr}")
            self.assertTrue(process.stderr.strip(), words)

    def test_gate_never_exits_with_0_when_it_cannot_judge(self):
        process = surefoot("gate", "--map", self.dir, "--pose", "0,0,0", "--command", "9")
        self.assertEqual(process.returncode, 4)

    def test_version(self):
        self.assertRegex(surefoot("--version").stdout.strip(), r"^\d+\.\d+\.\d+$")

    def test_config_prints_what_it_reads(self):
        text = self.run_ok("config", "--set", "elevation.length_m=8").stdout
        file = self.dir / "c.yaml"
        file.write_text(text)
        again = self.run_ok("config", "--config", file).stdout
        self.assertEqual(text, again)
        self.assertIn("length_m: 8", again)

    def test_json_is_one_object_with_the_promised_names(self):
        recording, run = self.dir / "recording", self.dir / "run"
        grid = "ncols 40\nnrows 40\nxllcorner 0\nyllcorner 0\ncellsize 0.05\nNODATA_value -9999\n" + "0 " * 1600
        (self.dir / "flat.asc").write_text(grid + "\n")
        steps = ROOT / "tests" / "conformance" / "elevation" / "steps.txt"
        promised = (  # in an order in which each finds what it needs
            (["sim", "floor", "--frames", 3, "--out", recording], "frames complete error folder"),
            (["run", recording, "--out", run, "--machine", "rex"], "source frames complete gravity_source map timing"),
            (["rate", self.dir / "flat.asc", "--out", self.dir / "rated"], "width height resolution_m folder"),
            (["fuse", steps, "--preset", "ethz", "--out", self.dir / "fused"], "steps folder"),
            (["ground", run / "map.ply", "--origin", "0,0,0.95"], "tilt_deg height_m inlier_ratio normal"),
            (["eval", "trajectory", run / "trajectory.tum", recording / "groundtruth.tum"],
             "ate_rmse_m rpe_trans_rmse_m rpe_rot_rmse_deg drift_percent matched"),
            (["eval", "maps", run, recording], "elevation traversability coverage"),
            (["eval", "suite", "--quick", "--scenes", "floor", "--noise", 1, "--out", self.dir / "suite"], "cases"),
            (["config"], "settings"),
            (["config", "--check"], "valid problem"),
            (["doctor"], "version machine rig depth_sigma floor steps"),
            (["bench", "gate"], "benchmarks"),
            (["record", recording, "--out", self.dir / "copy"], "frames complete error folder"),
            (["replay", recording, "--speed", 1000], "frames late speed per_frame"),
            (["info", recording], "kind frames rate_hz gaps imu_samples has_truth"),
        )
        self.assertEqual({tuple(v) for v in VERBS} - {("gate",), ("eval",)},
                         {tuple(call[:2]) if call[0] == "eval" else (call[0],) for call, _ in promised})
        answers = {}
        for call, names in promised:
            with self.subTest(" ".join(map(str, call[:2]))):
                answer = self.json_of(*call)
                self.assertLessEqual(set(names.split()), set(answer))
                answers[" ".join(map(str, call[:2]))] = answer
        maps = answers["eval maps"]
        self.assertLessEqual({"median_abs_m", "p90_abs_m"}, set(maps["elevation"]))
        self.assertLessEqual({"false_safe", "false_unsafe"}, set(maps["traversability"]))
        self.assertEqual({"name", "median_ms", "p99_ms", "peer_ms"}, set(answers["bench gate"]["benchmarks"][0]))
        self.assertEqual(len(answers[f"replay {recording}"]["per_frame"]), 3)

    def test_settings_are_checked_by_every_verb(self):
        for verb, rest in (("gate", ["--map", "x", "--pose", "0,0,0", "--command", "9"]), ("info", ["x"]),
                           ("record", ["x", "--out", "y"]), ("sim", ["--list"]), ("replay", ["x"])):
            for wrong in (["--set", "no.such_key=1"], ["--config", "nowhere.yaml"], ["--preset", "nothing"]):
                process = surefoot(verb, *rest, *wrong, cwd=self.dir)
                self.assertEqual(process.returncode, 2, f"{verb} {wrong}: {process.stderr}")
        process = surefoot("info", self.dir, "--set", "elevation.length_m=8")
        self.assertIn("change nothing here", process.stderr)

    def test_every_preset_is_known(self):
        by_default = self.run_ok("config").stdout
        for name in ("rex_zed", "rex_demo_stairs", "laser", "ethz"):
            self.assertNotEqual(self.run_ok("config", "--preset", name).stdout, by_default, name)

    def test_scene_list_is_json_too(self):
        scenes = json.loads(surefoot("sim", "--list", "--json").stdout)["scenes"]
        self.assertIn("demo_stairs", [scene["name"] for scene in scenes])


if __name__ == "__main__":
    unittest.main()
