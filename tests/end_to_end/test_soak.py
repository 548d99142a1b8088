"""Twenty seconds of tools/soak: random faults, misbehaving clients, and the properties that hold on any busy machine."""
import json
import subprocess
import sys
import unittest

from surefoot_cli import BINARY, ROOT, CliTest

sys.path.insert(0, str(ROOT / "tools"))
import soak_report  # noqa: E402

SECONDS = 20.0
S = 1_000_000_000


def question(sent_s, took_s, verdict="OK", port=1):
    """A query that the gate decided halfway between sending and receiving."""
    sent, received = int(sent_s * S), int((sent_s + took_s) * S)
    return soak_report.Query(sent, received, verdict, "NONE", (sent + received) // 2, received + S, port)


def fault(kind, begin_s, end_s, port=1):
    return soak_report.Fault(kind, int(begin_s * S), int(end_s * S), 10, 11, port)


class Judgement(unittest.TestCase):
    def missed(self, query, *faults):
        return [what for what, _ in soak_report.judge_queries([query], faults)[0]]

    def test_answers_in_time_are_no_miss(self):
        self.assertEqual(self.missed(question(100, 0.249)), [])
        self.assertEqual(self.missed(question(100, 0.251)), ["late answer"])
        self.assertEqual(self.missed(question(100, 1.0, "TIMEOUT")), ["late answer"])

    def test_a_gate_that_stands_has_its_time_from_when_it_goes_on(self):
        stopped = fault("gate_pause", 99, 102)
        self.assertEqual(self.missed(question(100, 2.2), stopped), [])
        self.assertEqual(self.missed(question(100, 2.3), stopped), ["late answer"])

    def test_no_ok_on_old_frames(self):
        for kind in soak_report.PERCEPTION_GONE:
            self.assertEqual(self.missed(question(100.24, 0.01), fault(kind, 100, 102)), [], kind)
            self.assertEqual(self.missed(question(100.26, 0.01), fault(kind, 100, 102)), ["OK on old frames"], kind)
            self.assertEqual(self.missed(question(100.26, 0.01, "ERROR"), fault(kind, 100, 102)), [], kind)
        self.assertEqual(self.missed(question(102.1, 0.01), fault("perception_hang", 100, 102)), [])

    def test_no_ok_without_a_log_of_the_gate_that_lost_it(self):
        self.assertEqual(self.missed(question(101.6, 0.01), fault("audit_full", 100, 110)), ["OK without a log"])
        self.assertEqual(self.missed(question(101.4, 0.01), fault("audit_full", 100, 110)), [])
        self.assertEqual(self.missed(question(101.6, 0.01, port=2), fault("audit_full", 100, 110)), [])

    def test_only_a_killed_gate_may_leave(self):
        self.assertEqual(self.missed(question(100, 0.1, "LOST"), fault("gate_kill", 100.05, 100.3)), [])
        self.assertEqual(self.missed(question(100, 0.1, "LOST"), fault("audit_full", 100.05, 100.3)), ["no answer"])

    def test_a_block_that_is_not_whole_says_nothing_of_handles(self):
        def sample(elapsed_s, handles):
            return soak_report.Sample(elapsed_s, "gate", 1, 0, 0, 1, handles, 0, 1, 0, 0, 0)
        life = [sample(10.0 * i, 17 if i % 30 == 7 else 25) for i in range(63)]
        self.assertEqual(soak_report.fewest(life, "handles"), [(0.0, 17), (300 / 3600, 17)])
        self.assertEqual(len(soak_report.fewest(life[:20], "handles")), 0)

    def test_slopes_are_within_groups(self):
        self.assertAlmostEqual(soak_report.slope([[(0, 5), (1, 7)], [(10, 0), (12, 4)]]), 2.0)
        self.assertIsNone(soak_report.slope([[(0, 5)]]))


class Soak(CliTest):
    def test_nothing_is_allowed_that_must_not_be_and_nothing_dies(self):
        subprocess.run([sys.executable, ROOT / "tools" / "soak", "--hours", str(SECONDS / 3600.0), "--seed", "21", "--out",
                        self.dir / "soak", "--surefoot", BINARY], stdout=subprocess.DEVNULL, timeout=600)
        found = json.loads((self.dir / "soak" / "soak.json").read_text())
        self.assertGreater(sum(found["faults"].values()), 3)
        self.assertGreater(found["queries"], 20)
        for what in ("OK on old frames", "OK without a log", "no answer"):
            self.assertEqual(found["missed"].get(what, 0), 0, found["missed_queries"])
        self.assertEqual((found["surprises"], found["gate_surprises"]), (0, 0))
        first, last = found["handles_alone"]
        self.assertLessEqual(last, first)
        self.assertEqual(found["shm_files_most"], 1)
        self.assertIsNone(found["audit"]["damage"])
        self.assertEqual(found["audit"]["different"], 0)


if __name__ == "__main__":
    unittest.main()
