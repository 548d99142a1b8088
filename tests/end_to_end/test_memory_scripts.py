"""Remembered ground: runs lab/memory_scripts with one seed per script. The figures are in docs/lab."""
import csv
import os
import pathlib
import subprocess
import tempfile
import unittest

SEED = 21


class MemoryScripts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "quick.csv"
            subprocess.run([os.environ["MEMORY_SCRIPTS_BINARY"], file, str(SEED), "1", "quick"], check=True)
            with open(file, newline="") as text:
                cls.steps = list(csv.DictReader(text))

    def asked(self, script, drift):
        mine = [s for s in self.steps if s["script"] == script and float(s["drift_percent"]) == drift and s["asked"] == "1"]
        self.assertTrue(mine, f"{script} must reach the order that it asks about")
        return mine

    def test_nothing_dangerous_is_allowed(self):
        dangerous = [s for s in self.steps if s["safe"] == "0" and s["clear"] == "1"]
        self.assertGreater(len(dangerous), 2)
        for step in dangerous:
            self.assertEqual(step["verdict"], "NOT_TRAVERSABLE", step)

    def test_a_table_behind_stops(self):
        for drift in (0.0, 10.0):
            last = self.asked("table", drift)[-1]
            self.assertEqual((last["safe"], last["verdict"]), ("0", "NOT_TRAVERSABLE"), last)

    def test_drift_that_is_told_inhibits_a_step_onto_a_tread(self):
        for step in self.asked("tread", 10.0):
            self.assertNotEqual(step["verdict"], "OK", step)
            self.assertIn("MEMORY_UNCERTAIN", step["reasons"])


if __name__ == "__main__":
    unittest.main()
