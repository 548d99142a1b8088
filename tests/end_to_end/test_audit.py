"""The audit log returns every verdict, and reports damage with a message."""
import json
import unittest

from surefoot_cli import CliTest, surefoot

COMMANDS = (1, 9, 13, 17, 25, 200)


class AuditLog(CliTest):
    def setUp(self):
        super().setUp()
        self.map = self.dir / "run"
        self.log = self.dir / "audit"
        self.run_ok("run", "sim:floor", "--out", self.map, "--max-frames", "12", "--set", "sim.known_motion=true",
                    "--set", "sim.sensor=analytic")

    def ask(self, command, *more):
        return surefoot("gate", "--map", self.map, "--pose", "0,0,0", "--command", command, *more)

    def fill(self):
        for command in COMMANDS:
            self.ask(command, "--audit", self.log)
        files = sorted(self.log.glob("audit-*.log"), key=lambda file: file.name.split("-")[2])
        self.assertEqual(len(files), len(COMMANDS))
        return files

    def test_every_verdict_comes_out_of_the_log_again(self):
        self.fill()
        whole = self.json_of("audit", "verify", self.log)
        self.assertEqual({"files", "bytes", "runs", "verdicts", "gaps", "lost", "acts", "unfinished", "damage"}, set(whole))
        self.assertEqual(whole["verdicts"], len(COMMANDS))
        self.assertEqual(whole["runs"], len(COMMANDS))
        self.assertIsNone(whole["damage"])
        again = self.json_of("audit", "replay", self.log)
        self.assertEqual(set(again) - set(whole), {"equal", "different", "first_difference"})
        self.assertEqual((again["equal"], again["different"]), (len(COMMANDS), 0))
        self.assertIn("intact", self.run_ok("audit", "verify", self.log).stdout)

    def test_damage_is_told_and_ends_with_1(self):
        files = self.fill()
        content = bytearray(files[2].read_bytes())
        content[len(content) // 2] ^= 4
        files[2].write_bytes(content)
        for verb in ("verify", "replay"):
            process = surefoot("audit", verb, self.log, "--json")
            self.assertEqual(process.returncode, 1)
            damage = json.loads(process.stdout)["damage"]
            self.assertEqual(damage["file"], str(files[2]))
            self.assertIn("hash", damage["what"])
            self.assertIn(files[2].name, process.stderr)
        files[2].unlink()
        process = surefoot("audit", "verify", self.log)
        self.assertEqual(process.returncode, 1)
        self.assertIn("1 log files are missing", process.stderr)
        self.assertIn("DAMAGED", process.stdout)

    def test_an_end_that_was_cut_is_a_warning(self):
        files = self.fill()
        files[-1].write_bytes(files[-1].read_bytes()[:-5])
        process = self.run_ok("audit", "verify", self.log)
        self.assertIn("the writer stopped there", process.stderr)

    def test_a_log_that_cannot_be_written_changes_no_verdict(self):
        plain = self.ask(9, "--json")
        blocked = self.dir / "file"
        blocked.write_text("no folder")
        logged = self.ask(9, "--json", "--audit", blocked)
        self.assertEqual(logged.returncode, plain.returncode)
        self.assertEqual(logged.stdout, plain.stdout)
        self.assertIn("not written to the audit log", logged.stderr)

    def test_what_is_no_log_is_a_sentence(self):
        for path in (self.dir / "nowhere", self.map):
            process = surefoot("audit", "verify", path)
            self.assertEqual(process.returncode, 1)
            self.assertTrue(process.stderr.strip())
        process = surefoot("audit", "verify", self.map / "report.json")
        self.assertEqual(process.returncode, 1)
        self.assertIn("no frame begins here", process.stderr)


if __name__ == "__main__":
    unittest.main()
