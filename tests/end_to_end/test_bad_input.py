"""Bad input: a clear sentence, exit code 1 or 2, and what was computed before is kept and valid."""
import json
import pathlib
import resource
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

from surefoot_cli import BINARY, CliTest, grey_png, read_tum, surefoot

FRAMES = 6


class BadInput(CliTest):
    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.TemporaryDirectory(prefix="surefoot-bad-input-")
        cls.good = pathlib.Path(cls.shared.name) / "good"
        process = surefoot("sim", "floor", "--frames", FRAMES, "--out", cls.good)
        assert process.returncode == 0, process.stderr

    @classmethod
    def tearDownClass(cls):
        cls.shared.cleanup()

    def broken_copy(self):
        copy = self.dir / "recording"
        shutil.copytree(self.good, copy)
        return copy

    def image(self, recording, camera, index):
        return sorted((recording / "mav0" / camera / "data").glob("*.png"))[index]

    def fails(self, process, *words, code=1):
        self.assertEqual(process.returncode, code, process.stderr)
        for word in words:
            self.assertIn(str(word), process.stderr)

    def run_broken(self, recording, *extra):
        return surefoot("run", recording, "--out", self.dir / "out", *extra)

    def kept(self, frames):
        """The results of the frames before the fault are there and valid."""
        out = self.dir / "out"
        self.assertEqual(len(read_tum(out / "trajectory.tum")), frames)
        report = json.loads((out / "report.json").read_text())
        self.assertEqual(report["frames"], frames)
        self.assertFalse(report["complete"])
        self.assertTrue(report["error"])
        self.assertIn("</html>", (out / "report.html").read_text())
        self.assertTrue((out / "elevation.asc").stat().st_size > 100)

    def test_missing_right_image(self):
        recording = self.broken_copy()
        victim = self.image(recording, "cam1", 4)
        victim.unlink()
        self.fails(self.run_broken(recording), victim.name)
        self.kept(4)

    def test_truncated_image(self):
        recording = self.broken_copy()
        victim = self.image(recording, "cam0", 3)
        victim.write_bytes(victim.read_bytes()[:2000])
        self.fails(self.run_broken(recording), victim.name, "truncated")
        self.kept(3)

    def test_unequal_sizes(self):
        recording = self.broken_copy()
        victim = self.image(recording, "cam1", 2)
        victim.write_bytes(grey_png(600, 376))
        self.fails(self.run_broken(recording), victim.name, "600")
        self.kept(2)

    def test_stamps_that_go_back(self):
        recording = self.broken_copy()
        index = recording / "mav0" / "cam0" / "data.csv"
        lines = index.read_text().splitlines()
        lines[3], lines[4] = lines[4], lines[3]
        index.write_text("\n".join(lines) + "\n")
        self.fails(self.run_broken(recording), "data.csv")

    def test_rig_for_another_resolution(self):
        rig = self.dir / "rig.yaml"
        rig.write_text("layout: side_by_side\nresolution: [1280, 720]\nrate_hz: 15\nbaseline_m: 0.12\n"
                       "focal_px: 700\nprincipal_px: [640, 360]\ndistortion: none\n")
        self.fails(self.run_broken(self.good, "--rig", rig), "1280", "672")

    def test_nan_in_a_calibration(self):
        recording = self.broken_copy()
        sensor = recording / "mav0" / "cam0" / "sensor.yaml"
        lines = ["intrinsics: [.nan, 342, 336, 188]" if line.startswith("intrinsics") else line
                 for line in sensor.read_text().splitlines()]
        sensor.write_text("\n".join(lines) + "\n")
        self.fails(self.run_broken(recording), "sensor.yaml")

    def test_empty_folder(self):
        empty = self.dir / "empty"
        empty.mkdir()
        self.fails(self.run_broken(empty), empty)

    def test_source_that_is_not_there(self):
        self.fails(self.run_broken(self.dir / "nowhere"), "nowhere")

    def test_unknown_key_with_file_and_line(self):
        config = self.dir / "c.yaml"
        config.write_text("elevation:\n  length_m: 6\n  lenght_m: 7\n")
        self.fails(self.run_broken(self.good, "--config", config), "c.yaml:3", "elevation.lenght_m",
                   "elevation.length_m", code=2)

    def test_value_out_of_range(self):
        self.fails(self.run_broken(self.good, "--set", "elevation.resolution_m=-1"), "elevation.resolution_m", "-1",
                   code=2)
        for setting in ("elevation.resolution_m=nan", "elevation.resolution_m=0.03333", "stereo.disparities=100",
                        "elevation.prefilter.min_range_m=90"):
            self.fails(self.run_broken(self.good, "--set", setting), setting.split("=")[0], code=2)

    def test_output_not_writable(self):
        (self.dir / "file").write_text("in the way")
        process = surefoot("run", self.good, "--out", self.dir / "file" / "out")
        self.fails(process, "file/out")

    def test_disk_full(self):
        def small_files():  # every write past 20 kB fails, as on a full disk
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
        process = surefoot("run", self.good, "--out", self.dir / "out", preexec_fn=small_files)
        self.fails(process, self.dir / "out")
        # What fitted is there, whole.
        self.assertEqual(len(read_tum(self.dir / "out" / "trajectory.tum")), FRAMES)
        self.assertEqual(list((self.dir / "out").glob("*.tmp*")), [])

    def test_interrupt_in_the_middle(self):
        out = self.dir / "out"
        process = subprocess.Popen([str(BINARY), "run", "sim:demo_stairs", "--out", str(out)],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while not out.exists() and process.poll() is None:  # the run has begun; its handler is there
            time.sleep(0.05)
        time.sleep(3.0)
        process.send_signal(signal.SIGINT)
        _, log = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 1, log)
        self.assertIn("interrupted", log)
        report = json.loads((out / "report.json").read_text())
        self.assertFalse(report["complete"])
        self.kept(report["frames"])


if __name__ == "__main__":
    unittest.main()
