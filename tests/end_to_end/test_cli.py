"""Every verb: help, its example, exit codes, JSON names."""
import json
import re
import shlex
import unittest

from surefoot_cli import BINARY, ROOT, CliTest, surefoot

# In the order in which one example needs another's results.
VERBS = [["sim"], ["run"], ["rate"], ["fuse"], ["ground"], ["gate"], ["eval"], ["eval", "trajectory"],
         ["eval", "maps"], ["config"], ["doctor"], ["bench"], ["record"], ["replay"], ["info"]]
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

    def test_scene_list_is_json_too(self):
        scenes = json.loads(surefoot("sim", "--list", "--json").stdout)["scenes"]
        self.assertIn("demo_stairs", [scene["name"] for scene in scenes])


if __name__ == "__main__":
    unittest.main()
