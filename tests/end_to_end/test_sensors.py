"""The simulator's other sensors: depth camera, analytic stereo, laser scanner, IMU by data sheet."""
import json
import signal
import subprocess
import time
import unittest

from surefoot_cli import BINARY, CliTest, read_tum, surefoot

FRAMES = 6


class Sensors(CliTest):
    def test_a_depth_camera_runs_through_the_chain_live_and_recorded(self):
        live, recording, played = self.dir / "live", self.dir / "recording", self.dir / "played"
        rgbd = ["--set", "sim.sensor=depth_camera", "--set", "sim.depth_camera=kinect_v2"]
        truth = self.json_of("run", "sim:floor", "--max-frames", FRAMES, *rgbd, "--out", live)["truth"]
        # The model's axial noise is 1-2 mm at these depths.
        self.assertLess(truth["elevation"]["median_abs_m"], 0.003)
        self.assertGreater(truth["depth"]["within_3_sigma"], 0.97)
        self.run_ok("sim", "floor", "--frames", FRAMES, *rgbd, "--out", recording)
        info = self.json_of("info", recording)
        self.assertEqual((info["kind"], info["frames"], info["width"]), ("tum_rgbd", FRAMES, 512))
        again = self.json_of("run", recording, "--out", played)
        self.assertEqual(again["frames"], FRAMES)
        self.assertGreater(again["map"]["known_cells"], 3000)
        camera = read_tum(recording / "groundtruth.txt")[0]
        body = read_tum(recording / "groundtruth.tum")[0]
        self.assertGreater(camera[3], body[3], "the camera must be above base_link")
        copy = self.dir / "copy"
        self.run_ok("record", recording, "--out", copy)
        self.assertEqual((copy / "depth" / "1.000000000.png").read_bytes(),
                         (recording / "depth" / "1.000000000.png").read_bytes())

    def test_the_analytic_sensor_says_that_it_is_modelled(self):
        out = self.dir / "out"
        analytic = ["--set", "sim.sensor=analytic"]
        self.run_ok("run", "sim:floor", "--max-frames", 20, *analytic, "--out", out)
        report = json.loads((out / "report.json").read_text())
        self.assertEqual(report["source"]["modelled"], ["odometry", "depth"])
        self.assertGreater(report["truth"]["coverage_within_2_5_m"], 0.9)
        self.assertIn("modelled from the truth", (out / "report.html").read_text())
        one, two = self.dir / "one", self.dir / "two"
        for folder, threads in ((one, 1), (two, 2)):
            self.run_ok("run", "sim:floor", "--max-frames", 12, *analytic, "--threads", threads, "--out", folder)
        for name in ("elevation.asc", "trajectory.tum", "map.snapshot"):
            self.assertEqual((one / name).read_bytes(), (two / name).read_bytes(), name)
        for words in (["sim", "floor"], ["record", "sim:floor"]):
            process = surefoot(*words, *analytic, "--out", self.dir / "recording")
            self.assertEqual(process.returncode, 2)
            self.assertIn("makes no images", process.stderr)
            self.assertFalse((self.dir / "recording").exists())

    def test_scans_agree_with_the_scene(self):
        coarse = ["--set", "sim.laser.step_deg=0.5"]
        cloud = self.dir / "scan.ply"
        scanned = self.json_of("sim", "floor", "--scan", cloud, *coarse,
                               "--station", "0,0,1.6", "--station", "1,-0.5,1.2")
        self.assertEqual((scanned["stations"], scanned["complete"], scanned["file"]), (2, True, str(cloud)))
        # All points lie on the plane z = 0 of the world, to a millimetre.
        ground = self.json_of("ground", cloud, "--origin", "0,0,1.6")
        self.assertAlmostEqual(ground["height_m"], 1.6, delta=0.002)
        self.assertLess(abs(ground["tilt_deg"]), 0.1)
        for wrong in ("0,0,-1", "0,0", "a,b,c"):
            process = surefoot("sim", "floor", "--scan", cloud, "--station", wrong)
            self.assertEqual(process.returncode, 2, wrong)
            self.assertIn("--station", process.stderr)
        process = surefoot("sim", "floor", "--scan", "/proc/nowhere/scan.ply")
        self.assertEqual(process.returncode, 1)
        self.assertIn("cannot write", process.stderr)

    def test_an_interrupted_scan_keeps_its_points(self):
        cloud = self.dir / "scan.ply"
        process = subprocess.Popen([str(BINARY), "sim", "room", "--scan", str(cloud), "--json"],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while not (cloud.exists() and cloud.stat().st_size > 1_000_000) and process.poll() is None:
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        answer, log = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1, log)
        self.assertIn("interrupted", log)
        scanned = json.loads(answer)
        self.assertFalse(scanned["complete"])
        head = cloud.read_bytes()[:400]
        self.assertIn(b"element vertex %d\n" % scanned["points"], head)
        body = cloud.stat().st_size - head.index(b"end_header\n") - len(b"end_header\n")
        self.assertEqual(body, 20 * scanned["points"])

    def test_the_sigma_of_heights_counts_the_lean_of_the_vertical(self):
        """A start on a cross-fall with a poor accelerometer: all heights tilt together, and their sigma covers it."""
        self.run_ok("run", "sim:cross_fall", "--seed", 50023, "--set", "sim.sensor=analytic", "--max-frames", 12,
                    "--set", "mount.gravity.accel_bias_m_s2=0.3", "--out",
                    self.dir / "out")
        report = json.loads((self.dir / "out" / "report.json").read_text())
        self.assertEqual(report["gravity_source"], "imu")
        sigma = report["truth"]["sigma"]
        self.assertGreater(sigma["within_1_sigma"], 0.5)
        self.assertGreater(sigma["within_2_sigma"], 0.9)

    def test_an_imu_brings_its_data_sheet_and_settings_stay_on_top(self):
        def noise(*settings):
            listed = self.json_of("config", *(w for s in settings for w in ("--set", s)))["settings"]
            return {s["key"].split(".")[-1]: float(s["value"]) for s in listed
                    if s["key"].startswith("sim.imu_noise.")}
        plain, sheet = noise(), noise("sim.imu=mpu6050")
        self.assertNotEqual(plain, sheet)
        both = noise("sim.imu=mpu6050", "sim.imu_noise.gyro_step_rad_s=0.5")
        self.assertEqual(both, {**sheet, "gyro_step_rad_s": 0.5})
        process = surefoot("config", "--set", "sim.imu=xsens")
        self.assertEqual(process.returncode, 2)
        self.assertIn("adis16448 | mpu6050 | bmi055", process.stderr)


if __name__ == "__main__":
    unittest.main()
