"""depth and depth-accuracy: results compared with the rendered truth, and every kind of bad pair."""
import random
import struct
import tempfile
import pathlib
import unittest

from surefoot_cli import CliTest, png_of, surefoot


def read_pfm(path):
    """Reads a little-endian PFM: (width, height, values from the upper left corner)."""
    kind, size, scale, data = path.read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    assert kind == b"Pf" and float(scale) < 0, (kind, scale)
    values = struct.unpack(f"<{width * height}f", data)
    return width, height, [v for row in range(height - 1, -1, -1) for v in values[row * width:(row + 1) * width]]


def speckle(width, height, seed=1):
    """Rows of random blobs of 4 px without repetition."""
    draw = random.Random(seed)
    coarse = [[draw.randrange(256) for _ in range(width // 4 + 2)] for _ in range(height // 4 + 2)]
    return [[coarse[v // 4][u // 4] for u in range(width)] for v in range(height)]


def shifted(rows, columns, down=0):
    """Shifts the image to the left and down; repeats the border."""
    height, width = len(rows), len(rows[0])
    return [[rows[max(0, v - down)][min(width - 1, u + columns)] for u in range(width)] for v in range(height)]


class Depth(CliTest):
    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.TemporaryDirectory(prefix="surefoot-depth-")
        cls.recording = pathlib.Path(cls.shared.name) / "floor"
        process = surefoot("sim", "floor", "--frames", 1, "--depth", "--out", cls.recording)
        assert process.returncode == 0, process.stderr

    @classmethod
    def tearDownClass(cls):
        cls.shared.cleanup()

    def eyes(self):
        return [next((self.recording / "mav0" / cam / "data").glob("*.png")) for cam in ("cam0", "cam1")]

    def pair(self, left, right):
        paths = self.dir / "left.png", self.dir / "right.png"
        for path, rows in zip(paths, (left, right)):
            path.write_bytes(png_of(rows))
        return paths

    def test_a_rendered_floor(self):
        left, right = self.eyes()
        out, other = self.dir / "out", self.dir / "other"
        answer = self.json_of("depth", left, right, "--rig", "zed_vga", "--out", out, "--threads", 1)
        self.assertEqual((answer["width"], answer["height"]), (672, 376))
        self.assertGreater(answer["density_percent"], 70)
        self.assertLess(answer["row_error"]["median_abs_px"], 0.1)
        self.assertGreater(answer["median_sigma_px"], 0.09)
        for name in ("disparity.png", "sigma.png"):
            self.assertTrue((out / name).read_bytes().startswith(b"\x89PNG"))
        width, height, disparity = read_pfm(out / "disparity.pfm")
        _, _, sigma = read_pfm(out / "sigma.pfm")
        _, _, outlier = read_pfm(out / "outlier_probability.pfm")
        self.assertEqual((width, height), (672, 376))
        infinity = float("inf")
        self.assertEqual([d == infinity for d in disparity], [s == infinity for s in sigma])
        self.assertTrue(all(0.0 <= p <= 1.0 for p in outlier))
        # Below the horizon is the floor, 1 m below the camera; the camera looks 32 deg down.
        middle = disparity[188 * 672 + 400]
        self.assertAlmostEqual(342 * 0.12 / middle, 1.0 / 0.52992, delta=0.03)
        points = self.json_of("ground", out / "cloud.ply", "--frame", "optical")
        self.assertAlmostEqual(points["height_m"], 1.0, delta=0.01)
        self.assertAlmostEqual(points["tilt_deg"], 32.0, delta=0.5)
        self.json_of("depth", left, right, "--rig", "zed_vga", "--out", other, "--threads", 2)
        for name in ("disparity.pfm", "sigma.pfm", "cloud.ply", "disparity.png"):
            self.assertEqual((out / name).read_bytes(), (other / name).read_bytes(), name)

    def test_without_a_rig_the_rows_are_measured(self):
        rows = speckle(320, 200)
        left, right = self.pair(rows, shifted(rows, 20))
        process = self.run_ok("depth", left, right, "--out", self.dir / "good")
        self.assertEqual(process.stderr, "")
        self.assertIn("give --rig to get a point cloud", process.stdout)
        self.assertFalse((self.dir / "good" / "cloud.ply").exists())
        _, _, disparity = read_pfm(self.dir / "good" / "disparity.pfm")
        self.assertAlmostEqual(disparity[100 * 320 + 200], 20.0, delta=0.1)
        left, right = self.pair(rows, shifted(rows, 20, down=3))
        process = self.run_ok("depth", left, right, "--out", self.dir / "crooked")
        self.assertRegex(process.stderr, r"rows differ by (2\.9|3\.0)\d px .*not rectified")
        left, right = self.pair(shifted(rows, 20), rows)
        process = surefoot("depth", left, right, "--out", self.dir / "exchanged")
        self.assertEqual(process.returncode, 1)
        self.assertIn("left and right camera seem to be swapped", process.stderr)
        self.assertFalse((self.dir / "exchanged").exists())

    def test_bad_pairs(self):
        black, white = [[0] * 160 for _ in range(120)], [[255] * 160 for _ in range(120)]
        for left, right in ((black, black), (white, white), (black, white)):
            out = self.dir / "plain"
            answer = self.json_of("depth", *self.pair(left, right), "--out", out)
            self.assertLess(answer["trusted_percent"], 1.0, "images without texture must give no trusted matches")
            self.assertIsNone(answer["row_error"]["median_abs_px"])
        noise = self.json_of("depth", *self.pair(speckle(320, 200, 1), speckle(320, 200, 2)), "--out", self.dir / "n")
        self.assertLess(noise["trusted_percent"], 10.0)
        for left, right, words in (
                ([[7]], [[7]], "too narrow for stereo.disparities"),
                (black, [[0] * 160 for _ in range(100)], "the left image has 160x120 px, the right image 160x100 px"),
                (black, [[0] * 161 for _ in range(120)], "differ in size")):
            process = surefoot("depth", *self.pair(left, right), "--out", self.dir / "out")
            self.assertEqual(process.returncode, 1, process.stderr)
            self.assertIn(words, process.stderr)
        process = surefoot("depth", *self.pair(black, black), "--rig", "zed_vga", "--out", self.dir / "out")
        self.assertIn("160x120 px, but rig 'zed_vga' was calibrated for 672x376", process.stderr)
        process = surefoot("depth", "nowhere.png", "nowhere.png", "--out", self.dir / "out", cwd=self.dir)
        self.assertEqual(process.returncode, 1)
        process = surefoot("depth", *self.pair(black, black), "--rig", "nothing", "--out", self.dir / "out")
        self.assertEqual(process.returncode, 2)
        self.assertIn("zed_vga", process.stderr)


class Accuracy(CliTest):
    def test_the_board_of_an_ideal_and_a_real_camera(self):
        options = ["--rig", "zed_vga", "--distances", "0.6,1.5", "--repeats", 1]
        ideal = self.json_of("depth-accuracy", *options, "--out", self.dir / "ideal")
        zed = self.json_of("depth-accuracy", *options, "--set", "sim.profile=zed", "--out", self.dir / "zed")
        near, far = ideal["distances"]
        self.assertEqual((near["distance_m"], far["distance_m"]), (0.6, 1.5))
        # One sigma of 0.1 px is 0.9 mm at 0.6 m and 5.5 mm at 1.5 m.
        self.assertLess(abs(near["axial_m"]), 0.0015)
        self.assertLess(abs(far["axial_m"]), 0.008)
        self.assertLess(near["std_m"], 0.002)
        self.assertLess(far["std_m"], 0.011)
        self.assertGreater(near["density_percent"], 80)
        self.assertAlmostEqual(near["scale_share"], near["axial_m"] / 0.6, places=9)
        self.assertIsNone(near["thesis"])
        self.assertEqual(far["thesis"], {"camera": "ZED", "axial_m": 0.018, "std_m": 0.0247})
        self.assertGreater(zed["distances"][1]["std_m"], 1.3 * far["std_m"], "zed must scatter more than ideal")
        for name in ("depth_accuracy.html", "depth_accuracy.csv", "axial_error.svg", "std.svg"):
            self.assertTrue((self.dir / "zed" / name).stat().st_size > 100, name)
        self.assertIn("thesis, DUO", (self.dir / "zed" / "std.svg").read_text())

    def test_a_board_nearer_than_the_search_range_has_no_error(self):
        """At 0.3 m its disparity is 274 px in images of 1280 x 720 px; the matcher searches 256."""
        found = self.json_of("depth-accuracy", "--rig", "zed_hd720", "--distances", "0.3", "--repeats", 1,
                             "--out", self.dir / "near")
        row, = found["distances"]
        self.assertLess(row["density_percent"], 5.0)
        self.assertIsNone(row.get("axial_m"))

    def test_a_fisheye_rig_and_its_focal_length(self):
        options = ["depth-accuracy", "--rig", "duo_mlx", "--distances", "0.6", "--repeats", 1]
        wide = self.json_of(*options, "--out", self.dir / "wide")["distances"][0]
        self.assertLess(abs(wide["axial_m"]), 0.006)
        long = self.json_of(*options, "--set", "camera.rectified_focal_px=600", "--out", self.dir / "long")
        # The longer focal length only enlarges the image, so the scatter stays about the same.
        self.assertNotEqual(long["distances"][0]["std_m"], wide["std_m"])
        self.assertAlmostEqual(long["distances"][0]["std_m"], wide["std_m"], delta=0.0005)
        process = surefoot(*options, "--set", "camera.rectified_focal_px=20", "--out", self.dir / "no")
        self.assertEqual(process.returncode, 2)
        self.assertIn("a plane image shows at most", process.stderr)

    def test_a_run_takes_another_focal_length_but_not_another_size(self):
        run = ["run", "sim:floor", "--max-frames", 3, "--out", self.dir / "run"]
        report = self.json_of(*run, "--set", "camera.rectified_focal_px=400")
        self.assertEqual(report["camera"]["focal_px"], [400, 400])
        self.assertGreater(report["map"]["known_cells"], 1000)
        for wrong in (["camera.rectified_width_px=600"],
                      ["camera.rectified_focal_px=400", "--set", "sim.sensor=analytic"]):
            process = surefoot(*run, "--set", *wrong)
            self.assertEqual(process.returncode, 2, wrong)
            self.assertIn("camera.rectified_width_px" if len(wrong) == 1 else "computes rectified depth", process.stderr)

    def test_large_images_are_matched_at_two_sizes(self):
        run = ["run", "sim:floor", "--rig", "zed_hd720", "--max-frames", 7, "--set", "sim.rate_hz=10", "--out", self.dir / "large"]
        report = self.json_of(*run)
        self.assertEqual((report["camera"]["width"], report["camera"]["height"]), (640, 360))
        self.assertEqual(report["fine"], {"scale": 2, "frames": 2})  # every 0.5 s
        self.assertGreater(report["truth"]["depth"]["pixels"], 100_000)
        self.assertGreater(report["map"]["known_cells"], 1000)
        whole = self.json_of(*run, "--set", "fine.scale=1", "--set", "stereo.disparities=128")
        self.assertEqual((whole["camera"]["width"], whole["fine"]), (1280, {"scale": 1, "frames": 0}))
        modelled = self.json_of(*run, "--set", "sim.sensor=analytic")
        self.assertEqual((modelled["camera"]["width"], modelled["fine"]), (1280, {"scale": 1, "frames": 0}))
        wrong = surefoot(*run, "--set", "fine.from_m=3")
        self.assertEqual(wrong.returncode, 2)
        self.assertIn("fine.from_m = 3 must be less than fine.to_m = 2.5", wrong.stderr)
        rig = self.json_of("doctor", "--rig", self.hd720_rig())["rig"]
        self.assertEqual((rig["width"], rig["coarse_width"], rig["coarse_height"]), (1280, 640, 360))

    def hd720_rig(self):
        self.json_of("sim", "floor", "--rig", "zed_hd720", "--frames", 1, "--out", self.dir / "hd720")
        return self.dir / "hd720"

    def test_real_images_with_their_distances(self):
        # A wall at 41.04 / 20 m: the whole image moves by 20 px.
        rows = speckle(672, 376)
        (self.dir / "l.png").write_bytes(png_of(rows))
        (self.dir / "r.png").write_bytes(png_of(shifted(rows, 20)))
        pairs = self.dir / "pairs.txt"
        pairs.write_text("# board at 2.052 m\nl.png r.png 2.052\n\n")
        answer = self.json_of("depth-accuracy", "--pairs", pairs, "--rig", "zed_vga", "--out", self.dir / "out")
        (row,) = answer["distances"]
        self.assertEqual((row["distance_m"], row["observations"]), (2.052, 1))
        self.assertLess(abs(row["axial_m"]), 0.003)
        for text, words in (("l.png r.png\n", ":1: expected LEFT RIGHT DISTANCE_M"),
                            ("l.png r.png 1 x\n", ":1: expected"), ("l.png r.png nan\n", ":1: "),
                            ("l.png r.png 50\n", "must be between"), ("# nothing\n", "no line"),
                            ("l.png gone.png 1\n", "gone.png")):
            pairs.write_text(text)
            process = surefoot("depth-accuracy", "--pairs", pairs, "--rig", "zed_vga", "--out", self.dir / "bad")
            self.assertEqual(process.returncode, 1, text)
            self.assertIn(words, process.stderr)
        process = surefoot("depth-accuracy", "--pairs", pairs, "--out", self.dir / "bad")
        self.assertEqual(process.returncode, 2, "real images without a rig must be refused")

    def test_design(self):
        out = self.dir / "design"
        answer = self.json_of("depth-accuracy", "--design", "--baseline", 0.12, "--focal", 342, "--size", "672x376",
                              "--sigma", 0.1, "--height", 1, "--pitch", 32, "--distances", "1,2", "--out", out)
        self.assertAlmostEqual(answer["nearest_floor_m"], 0.559, delta=0.002)
        one = answer["ranges"][0]
        # Z = cos(32 deg) + sin(32 deg); 3 sqrt(2) Z 0.1 / 41.04; 3 rows of 1 / 342 rad at sqrt(2) m, seen at 45 deg.
        self.assertAlmostEqual(one["depth_m"], 1.37797, places=4)
        self.assertAlmostEqual(one["noise_limit_m"], 0.014246, places=5)
        self.assertAlmostEqual(one["pixel_limit_m"], 3 * 2 / 342, places=5)
        self.assertEqual(one["height_m"], max(one["noise_limit_m"], one["pixel_limit_m"]))
        for name in ("depth_design.html", "depth_design.csv", "resolvable_height.svg"):
            self.assertTrue((out / name).exists(), name)
        for wrong in (["--baseline", "-1"], ["--size", "672"], ["--size", "672x376x"], ["--pitch", "95"]):
            process = surefoot("depth-accuracy", "--design", *wrong, "--out", out)
            self.assertEqual(process.returncode, 2, wrong)
        self.assertEqual(surefoot("depth-accuracy", "--baseline", 1, "--out", out).returncode, 2)


if __name__ == "__main__":
    unittest.main()
