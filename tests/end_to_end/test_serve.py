"""surefoot serve with its gate process: a walk that the gate allows and stops, and the behaviour when one of the two
processes dies, stops or is killed. Times come from the gate's clock (ages of frames), not from the test's."""
import os
import pathlib
import re
import signal
import subprocess
import time
import unittest

from surefoot_cli import BINARY, ROOT, CliTest
from websocket_client import RosbridgeClient

GATE = BINARY.parent / "surefoot-gate"
FORWARD, BACKWARD, TURN_LEFT = 9, 17, 25
PATIENCE_S = 120.0
FAIR_SHARE = ("--nice", "0")  # with a lower priority, frames come too late on a busy machine
SILENCE_S = 1.0  # ten times the time-out of a client


class GateProcess(CliTest):
    def test_it_is_linked_with_nothing_of_perception(self):
        libraries = subprocess.run(["ldd", GATE], capture_output=True, text=True, check=True).stdout
        self.assertIn("libstdc++", libraries)
        for name in ("opencv", "ceres", "boost", "spdlog"):
            self.assertNotIn(name, libraries)

    def test_wrong_calls_are_said_and_nothing_listens(self):
        for words, said in ((["--snapshots", "x", "--machine", "no_such_machine"], "no_such_machine"),
                            (["--snapshots", "x", "--bind", "0.0.0.0"], "--certificate"),
                            (["--snapshots", "x", "--assured"], "--audit"),
                            (["--snapshots", "x", "--attest", "1.1"], "attestation_radius_m"),
                            (["--snapshots", "x", "--token-file", self.dir], "regular file"),
                            ([], "--snapshots")):
            process = subprocess.run([GATE, *words], capture_output=True, text=True, timeout=60)
            self.assertNotEqual(process.returncode, 0, words)
            self.assertIn(said, process.stderr)
            self.assertNotIn("listening", process.stdout)

    def test_a_machine_with_which_it_fails_its_own_questions_is_refused(self):
        """Steps of 2 cm reach no new ground, so the ground gives no reason to refuse."""
        text = (ROOT / "machines" / "rex.yaml").read_text()
        short = self.dir / "short.yaml"
        short.write_text(re.sub(r"(forward|left)_m: (-?[\d.]+)", lambda m: f"{m[1]}_m: {float(m[2]) / 20:.4f}", text))
        process = subprocess.run([GATE, "--snapshots", "x", "--machine", short, "--port", "0"], capture_output=True,
                                 text=True, timeout=60)
        self.assertNotEqual(process.returncode, 0)
        self.assertRegex(process.stderr, r"short\.yaml: .* self-test, the question DISCONNECTED with movement 9")

    def test_a_gate_without_the_key_trusts_no_map_and_says_so(self):
        process = subprocess.Popen([GATE, "--snapshots", self.dir / "channel", "--port", "0"], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        self.assertIn("--channel-key", process.stderr.readline())

    def test_a_gate_of_ones_own_gets_the_key_from_a_file(self):
        key = self.dir / "key"
        key.write_text(os.urandom(16).hex())
        key.chmod(0o600)
        channel = self.dir / "channel"
        service = subprocess.Popen([BINARY, "serve", "sim:walk_floor", "--port", "0", "--no-page", "--channel", channel,
                                    "--channel-key", key, "--set", "sim.sensor=analytic", *FAIR_SHARE],
                                   stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(service.stdout.close)
        self.addCleanup(service.wait)
        self.addCleanup(service.kill)
        service.stdout.readline()
        process = subprocess.Popen([GATE, "--snapshots", channel, "--channel-key", key, "--port", "0"],
                                   stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        client = RosbridgeClient(int(process.stdout.readline().rsplit(":", 1)[1]))
        self.addCleanup(client.close)
        patience = time.monotonic() + PATIENCE_S
        while {"WARMUP", "NOT_READY", "FRAME_STALE"} & set((values := client.step(FORWARD))["reasons"]):
            self.assertLess(time.monotonic(), patience, values)
            time.sleep(0.05)
        self.assertNotIn("INTERNAL", values["reasons"])

    def test_without_perception_it_answers_error(self):
        process = subprocess.Popen([GATE, "--snapshots", self.dir / "channel", "--port", "0"], stdout=subprocess.PIPE,
                                   text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        client = RosbridgeClient(int(process.stdout.readline().rsplit(":", 1)[1]))
        self.addCleanup(client.close)
        for direction in (FORWARD, 0, 27, 255):
            values = client.step(direction)
            self.assertEqual(values["verdict"], "ERROR")
            self.assertEqual(values["result_code"], -1)
        self.assertEqual(client.call("/step", direction=FORWARD)["values"]["resultCode"], -1)


class Walk(CliTest):
    def test_a_table_stops_the_walk_seen_and_remembered(self):
        """Fig. 9.16 of the reference thesis (Lange 2016): up to a table, back, half a turn, back to the table out of view.

        With the full noise the gate also refuses some steps on the floor, because of the slope under the feet."""
        log = self.dir / "audit"
        told = self.json_of("serve", "sim:tests/end_to_end/table_ahead.yaml", "--seed", 1, "--attest", 1, "--walk",
                            "9*6,17*2,25*12,17*5", "--port", 0, "--once", "--set", "sim.sensor=analytic",
                            "--set", "sim.noise=0.5", "--audit", log, *FAIR_SHARE, cwd=ROOT)["movements"]
        self.assertEqual([m["command"] for m in told], [FORWARD] * 6 + [BACKWARD] * 2 + [TURN_LEFT] * 12 + [BACKWARD] * 5)
        ahead = [m for m in told if m["command"] == FORWARD]
        self.assertTrue(all(m["moved"] for m in ahead[:4]), ahead)
        self.assertFalse(ahead[-1]["moved"], "a sixth step would hit the table")
        self.assertEqual(ahead[-1]["verdict"], "NOT_TRAVERSABLE")
        self.assertIn("something", ahead[-1]["text"])
        self.assertTrue(all(m["moved"] for m in told[6:20]), told[6:20])
        backs = told[20:]
        self.assertTrue(backs[0]["moved"], backs)
        self.assertFalse(backs[-1]["moved"], "the table is behind the machine")
        self.assertIn("overhead", backs[-1]["text"])
        replayed = self.json_of("audit", "replay", log)
        self.assertEqual(replayed["different"], 0)
        self.assertGreaterEqual(replayed["equal"], 2 * sum(m["moved"] for m in told))


class Channel(CliTest):
    def test_what_a_killed_service_left_in_shared_memory_goes(self):
        """Removes only files of this user that are named after a process that has ended."""
        memory = pathlib.Path("/dev/shm")
        begin = f"surefoot-{os.getuid()}-"
        gone = subprocess.Popen(["true"])
        gone.wait()
        orphan = memory / f"{begin}{gone.pid}.channel"
        others = [memory / f"{begin}{os.getpid()}.channel", memory / f"{begin}{gone.pid}0x.channel"]
        for file in (orphan, *others):
            file.write_bytes(b"")
            self.addCleanup(file.unlink, missing_ok=True)
        self.run_ok("serve", "sim:walk_floor", "--max-frames", 1, "--port", 0, "--once", "--set", "sim.sensor=analytic")
        self.assertFalse(orphan.exists())
        self.assertTrue(all(file.exists() for file in others))


class Faults(CliTest):
    """The chain on a scene with a standing machine; steps are asked for but not made."""

    def setUp(self):
        super().setUp()
        self.start()

    def start(self, niceness=FAIR_SHARE):
        said = open(self.dir / "stderr", "a")
        self.addCleanup(said.close)
        self.service = subprocess.Popen(
            [BINARY, "serve", "sim:walk_floor", "--attest", "1", "--walk", "0", "--port", "0", "--set",
             "sim.sensor=analytic", "--no-page", "--channel", self.dir / "channel", *niceness],
            stdout=subprocess.PIPE, stderr=said, text=True)
        self.addCleanup(self.service.stdout.close)
        self.addCleanup(self.service.wait)
        self.addCleanup(self.service.kill)
        self.port = int(self.service.stdout.readline().rsplit(":", 1)[1])
        self.gate = self.gate_process()
        self.client = RosbridgeClient(self.port)
        self.addCleanup(self.client.close)

    @staticmethod
    def resume(process):
        try:
            os.kill(process, signal.SIGCONT)
        except ProcessLookupError:
            pass

    def gate_process(self):
        children = pathlib.Path(f"/proc/{self.service.pid}/task/{self.service.pid}/children").read_text().split()
        self.assertEqual(len(children), 1)
        return int(children[0])

    def wait_for(self, verdict):
        patience = time.monotonic() + PATIENCE_S
        while (values := self.client.step(FORWARD))["verdict"] != verdict:
            self.assertLess(time.monotonic(), patience, values)
            time.sleep(0.02)
        return values

    def first_error(self):
        """Asks until the gate answers ERROR."""
        patience = time.monotonic() + PATIENCE_S
        while (values := self.client.step(FORWARD))["verdict"] != "ERROR":
            self.assertLess(time.monotonic(), patience)
            time.sleep(0.01)  # more than 200 queries a second give OVERLOAD
        return values

    def test_a_perception_that_hangs_inhibits(self):
        self.wait_for("OK")
        for _ in range(3):
            self.service.send_signal(signal.SIGSTOP)
            values = self.first_error()
            self.assertIn("FRAME_STALE", values["reasons"])
            for _ in range(20):
                self.assertEqual(self.client.step(FORWARD)["verdict"], "ERROR")
                time.sleep(0.01)
            self.service.send_signal(signal.SIGCONT)
            self.wait_for("OK")

    def wait_for_words(self, words):
        """Waits for words of the service or its gate on stderr."""
        patience = time.monotonic() + PATIENCE_S
        while words not in (said := (self.dir / "stderr").read_text()):
            self.assertLess(time.monotonic(), patience, said)
            time.sleep(0.02)

    def test_a_perception_that_is_killed_takes_its_gate_with_it(self):
        """The gate ends at once, so that the port is free for the next start."""
        for round_ in range(3):
            if round_ > 0:
                self.start()
            self.wait_for("OK")
            self.service.kill()
            killed = time.monotonic()
            with self.assertRaises((ConnectionError, OSError)):
                while True:
                    self.client.step(FORWARD)
                    time.sleep(0.01)
            self.assertLess(time.monotonic() - killed, 2.0)  # milliseconds on a machine that is not busy
            while pathlib.Path(f"/proc/{self.gate}").exists():
                self.assertLess(time.monotonic() - killed, 5.0)

    def test_a_second_service_on_the_same_channel_is_refused_and_harms_nothing(self):
        self.wait_for("OK")
        second = subprocess.run([BINARY, "serve", "sim:walk_floor", "--port", "0", "--no-page", "--once", "--channel",
                                 self.dir / "channel"], capture_output=True, text=True, timeout=60)
        self.assertNotEqual(second.returncode, 0)
        self.assertIn(f"process {self.service.pid} (surefoot", second.stderr)
        self.assertNotIn("listens", second.stdout)
        self.assertTrue((self.dir / "channel").exists())
        for _ in range(20):
            self.assertNotIn("INTERNAL", self.client.step(FORWARD)["reasons"])
            time.sleep(0.02)
        self.wait_for("OK")

    def test_a_channel_that_is_lost_is_said_and_made_anew(self):
        channel = self.dir / "channel"
        for lose, words in ((channel.unlink, "deleted or replaced"), (lambda: os.truncate(channel, 0), "cut off"),
                            (lambda: os.truncate(channel, 500_000), "cut off")):
            self.wait_for("OK")
            (self.dir / "stderr").write_text("")
            lose()
            self.wait_for_words(words)
            self.wait_for_words("serve repaired it")
            self.wait_for_words("open again")
            self.wait_for("OK")
        self.assertIsNone(self.service.poll())

    def test_a_map_that_another_process_changed_is_a_fault(self):
        self.wait_for("OK")
        channel = self.dir / "channel"
        patience = time.monotonic() + PATIENCE_S
        while "INTERNAL" not in (values := self.client.step(FORWARD))["reasons"]:
            self.assertLess(time.monotonic(), patience, values)
            with open(channel, "r+b") as file:  # changes a byte of each slot; perception soon overwrites two of them
                for slot in range(3):
                    file.seek(4096 + slot * ((channel.stat().st_size - 4096) // 3) + 200_000)
                    byte = file.read(1)
                    file.seek(-1, os.SEEK_CUR)
                    file.write(bytes([byte[0] ^ 1]))
            time.sleep(0.01)
        self.wait_for_words("another process has changed a map")
        for _ in range(50):  # the error is latched
            self.assertEqual(self.client.step(FORWARD)["verdict"], "ERROR")
            time.sleep(0.02)

    def test_an_orphan_that_holds_the_port_is_named(self):
        """A gate that hangs does not end with its perception."""
        os.kill(self.gate, signal.SIGSTOP)
        self.addCleanup(lambda: pathlib.Path(f"/proc/{self.gate}").exists() and os.kill(self.gate, signal.SIGKILL))
        self.service.kill()
        self.service.wait()
        words = [BINARY, "serve", "sim:walk_floor", "--port", str(self.port), "--no-page", "--max-frames", "1", "--once"]
        refused = subprocess.run(words, capture_output=True, text=True, timeout=60)
        self.assertNotEqual(refused.returncode, 0)
        self.assertIn(f"process {self.gate} (surefoot-gate) listens there", refused.stderr)
        os.kill(self.gate, signal.SIGCONT)  # now the gate ends, and the next start need not wait for it
        self.assertEqual(subprocess.run(words, capture_output=True, timeout=60).returncode, 0)

    def test_a_gate_that_is_killed_comes_back_without_permission(self):
        self.wait_for("OK")
        for _ in range(3):
            os.kill(self.gate, signal.SIGKILL)
            with self.assertRaises((ConnectionError, OSError)):
                for _ in range(1000):
                    self.client.step(FORWARD)
                    time.sleep(0.01)
            told = self.service.stdout.readline()  # the line with the new address
            self.port = int(told.rsplit(":", 1)[1])
            self.gate = self.gate_process()
            self.client.close()
            self.client = RosbridgeClient(self.port)
            values = self.client.step(FORWARD)
            self.assertEqual(values["verdict"], "ERROR")
            self.assertTrue({"WARMUP", "NOT_READY"} & set(values["reasons"]), values)
            # The operator attestation ended with the old process: the first step is refused again.
            self.assertIn("UNKNOWN_CELLS", self.wait_for("NOT_TRAVERSABLE")["reasons"])

    def test_the_gate_comes_first_whenever_it_is_started(self):
        """Perception has a lower priority than the gate and than the thread that supervises the gate."""
        self.service.kill()
        self.service.wait()
        self.start(niceness=())
        own = os.getpriority(os.PRIO_PROCESS, 0)
        for _ in range(2):
            threads = [int(t.name) for t in pathlib.Path(f"/proc/{self.service.pid}/task").iterdir()]
            patience = time.monotonic() + PATIENCE_S
            while not any(os.getpriority(os.PRIO_PROCESS, thread) == own + 10 for thread in threads):
                self.assertLess(time.monotonic(), patience)
            self.assertEqual(os.getpriority(os.PRIO_PROCESS, self.service.pid), own)
            self.assertEqual(os.getpriority(os.PRIO_PROCESS, self.gate), own)
            os.kill(self.gate, signal.SIGKILL)
            self.service.stdout.readline()  # the line with the new address
            self.gate = self.gate_process()

    def test_a_gate_that_hangs_says_nothing(self):
        self.wait_for("OK")
        for _ in range(3):
            os.kill(self.gate, signal.SIGSTOP)
            self.addCleanup(self.resume, self.gate)
            self.client.socket.settimeout(SILENCE_S)
            with self.assertRaises(TimeoutError):
                self.client.step(FORWARD)
            self.client.close()
            os.kill(self.gate, signal.SIGCONT)
            self.client = RosbridgeClient(self.port)
            self.wait_for("OK")


if __name__ == "__main__":
    unittest.main()
