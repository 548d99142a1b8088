"""surefoot rex-link against a small rosbridge server: its queries, sounds and movements. No test measures time. A busy
machine may pause for 100 ms, so tests push the joystick several times, and only forbidden results are strict."""
import signal
import subprocess
import sys
import threading
import unittest

from fake_rosbridge import FakeRosbridge
from surefoot_cli import BINARY, ROOT, CliTest, surefoot

TONES = ROOT / "service" / "rex_link" / "tones"
PATIENCE_S = 60.0
PUSHES = "".join(f"{time_s:.1f} 9\n{time_s + 0.9:.1f} 0\n" for time_s in (0.5, 2.0, 3.5))


class RexLink(CliTest):
    def setUp(self):
        super().setUp()
        self.script = self.dir / "walk.txt"
        self.script.write_text(PUSHES)

    def gate(self, verdict_of):
        gate = FakeRosbridge(verdict_of)
        self.addCleanup(gate.close)
        return gate

    def link(self, port, *words):
        return self.json_of("rex-link", "--url", f"ws://127.0.0.1:{port}", "--script", self.script, "--step-time", 0.3,
                            *words)

    def start(self, *words):
        """Starts the program with pipes and ends it after a minute, so that a test that waits for a line cannot hang."""
        process = subprocess.Popen([BINARY, "rex-link", *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        patience = threading.Timer(PATIENCE_S, process.kill)
        patience.start()
        for end in (process.stdin.close, process.stdout.close, process.wait, patience.cancel, process.kill):
            self.addCleanup(end)
        return process

    def test_two_oks_move_it_and_the_tone_has_a_file(self):
        gate = self.gate(lambda command: "OK")
        told = self.link(gate.port, "--tones", TONES)
        self.assertGreaterEqual(told["motions"], 1)
        self.assertEqual(told["connections"], 1)
        self.assertEqual(told["questions"], len(gate.questions))
        events = told["events"]
        for i, event in enumerate(events):
            if event["event"] != "motion":
                continue
            before = [e for e in events[:i] if e["event"] in ("question", "answer")][-4:]
            self.assertEqual([e["event"] for e in before], ["question", "answer"] * 2)
            self.assertEqual({e["command"] for e in before}, {9})
            self.assertEqual([e["sequence"] for e in before[::2]], [e["sequence"] for e in before[1::2]])
        files = {e["file"] for e in events if e["event"] == "tone" and e["tone"] == "acknowledge"}
        self.assertEqual(files, {str(TONES / "acknowledge.wav")})

    def test_a_no_is_a_tone_and_nothing_else(self):
        for verdict, tone in (("NOT_TRAVERSABLE", "not_traversable"), ("ERROR", "cannot_judge")):
            told = self.link(self.gate(lambda command, verdict=verdict: verdict).port)
            self.assertEqual(told["motions"], 0)
            self.assertIn(tone, [e["tone"] for e in told["events"] if e["event"] == "tone"])
            self.assertNotIn("acknowledge", [e["tone"] for e in told["events"] if e["event"] == "tone"])

    def test_without_a_gate_it_says_so_and_fails(self):
        gate = self.gate(lambda command: "OK")
        gate.close()
        self.script.write_text("0 9\n0.3 0\n")
        process = surefoot("rex-link", "--url", f"ws://127.0.0.1:{gate.port}", "--script", self.script)
        self.assertEqual(process.returncode, 1)
        self.assertIn("no gate answered", process.stderr)
        self.assertIn("cannot_judge", process.stdout)

    def test_keys_come_through_a_pipe(self):
        gate = self.gate(lambda command: "OK")
        process = self.start("--url", f"ws://127.0.0.1:{gate.port}", "--keys")
        self.assertIn("connected", process.stdout.readline())
        process.stdin.write("s")
        process.stdin.flush()
        self.assertRegex(process.stdout.readline(), r"joystick +17")
        self.assertRegex(process.stdout.readline(), r"question +1: may the machine make movement 17\?")
        process.stdin.write("x")
        process.stdin.flush()
        self.assertEqual(process.wait(), 0)

    def test_an_interrupt_ends_it(self):
        self.script.write_text("0 0\n500 9\n")
        gate = self.gate(lambda command: "OK")
        process = self.start("--url", f"ws://127.0.0.1:{gate.port}", "--script", self.script)
        self.assertIn("connected", process.stdout.readline())
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(), 0)

    def test_wrong_calls_are_told(self):
        for words, why in ((["--script", self.script, "--url", "ws://rex.example"], "--url"),
                           (["--script", self.script, "--tones", self.dir], "acknowledge.wav"),
                           ([], "--script FILE or --keys")):
            process = surefoot("rex-link", *words)
            self.assertEqual(process.returncode, 2, process.stderr)
            self.assertIn(why, process.stderr)
        self.script.write_text("0.5 nine\n")
        process = surefoot("rex-link", "--script", self.script)
        self.assertEqual(process.returncode, 1)
        self.assertIn("walk.txt:1", process.stderr)

    def test_the_tones_are_those_that_their_script_makes(self):
        subprocess.run([sys.executable, ROOT / "tools" / "tones", self.dir / "tones"], check=True)
        made = {path.name: path.read_bytes() for path in (self.dir / "tones").iterdir()}
        kept = {path.name: path.read_bytes() for path in TONES.iterdir()}
        self.assertEqual(made, kept)


if __name__ == "__main__":
    unittest.main()
