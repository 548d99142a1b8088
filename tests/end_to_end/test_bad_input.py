"""Bad input: a clear message, exit code 1 or 2; results computed before the error are kept and valid."""
import json
import math
import pathlib
import random
import resource
import shutil
import signal
import struct
import subprocess
import tempfile
import time
import unittest

from surefoot_cli import BINARY, CliTest, grey_png, png_of, read_tum, surefoot

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
        """Checks that the results of the frames before the fault exist and are valid."""
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
        # Results that fit on the disk are complete.
        self.assertEqual(len(read_tum(self.dir / "out" / "trajectory.tum")), FRAMES)
        self.assertEqual(list((self.dir / "out").glob("*.tmp*")), [])

    GRID = "ncols {n}\nnrows {n}\nxllcorner 0\nyllcorner 0\ncellsize {cell}\n{body}\n"

    def grid(self, n, cell, body):
        path = self.dir / "heights.asc"
        path.write_text(self.GRID.format(n=n, cell=cell, body=body))
        return path

    def test_height_maps_that_are_none(self):
        flat = "0 0 0\n0 0 0\n0 0 0"
        for n, cell, body, word in ((3, 0, flat, "cellsize 0"), (3, "nan", flat, "cellsize"), (3, -1, flat, "cellsize -1"),
                                    (3, "1e-12", flat, "cellsize 1e-12"), (3, "1e300", flat, "cellsize 1e+300"),
                                    (3, "1e400", flat, "heights.asc:5"), (0, 0.025, "", "ncols = 0"), (3, 0.025, "0 0", "3 x 3"),
                                    (3, 0.025, flat.replace("0 0 0", "0 inf 0", 1), "row 1"),
                                    (3, 0.025, flat.replace("0 0 0", "0 1e400 0", 1), "row 1")):
            process = surefoot("rate", self.grid(n, cell, body), "--out", self.dir / "rated")
            self.fails(process, "heights.asc", word)
            self.assertFalse((self.dir / "rated" / "traversability.asc").exists())
        self.fails(surefoot("rate", self.grid(3, 0.5, flat), "--out", self.dir / "rated"), "less than the cell size 0.5 m",
                   code=2)

    def test_heights_that_nobody_measures_are_never_traversable(self):
        for bad in ("nan", "1e30", "-1e30", "3e38", "-9999"):
            rows = [["0"] * 21 for _ in range(21)]
            rows[10][10] = bad
            heights = self.grid(21, 0.025, "\n".join(" ".join(row) for row in rows))
            self.json_of("rate", heights, "--out", self.dir / "rated")
            lines = (self.dir / "rated" / "traversability.asc").read_text().splitlines()[6:]
            ratings = [[float(word) for word in line.split()] for line in lines]
            self.assertLess(ratings[10][10], 0.8, bad)
            self.assertEqual(ratings[0][0], 1.0, bad)

    def test_a_void_is_unknown_however_it_is_spelt(self):
        for declared, written in (("-3.402823E+38", "-3.4028234663852886e+38"), ("-9999", "-32768"), ("-9999", "-999"),
                                  ("null", "null"), ("-9999", "1e6"), ("-9999", "-100")):
            rows = [[written if 10 <= x < 30 and 10 <= y < 30 else "0" for x in range(40)] for y in range(40)]
            body = f"NODATA_value {declared}\n" + "\n".join(" ".join(row) for row in rows)
            heights = self.grid(40, 0.025, body)
            self.json_of("rate", heights, "--preset", "rex_zed", "--out", self.dir / "rated")
            lines = (self.dir / "rated" / "traversability.asc").read_text().splitlines()[6:]
            ratings = [[float(word) for word in line.split()] for line in lines]
            void = [ratings[y][x] for y in range(10, 30) for x in range(10, 30)]
            self.assertEqual(set(void), {-9999.0}, written)
            self.assertEqual(ratings[0][0], 1.0, written)
            answer = self.json_of("stairs", heights)  # regression: used to crash
            self.assertEqual(answer["flights"], [], written)

    def test_clouds_that_make_no_height_map(self):
        cloud, out = self.dir / "c.xyz", self.dir / "d.asc"
        for text, word, code in (("", "no points", 1), ("nan nan nan\ninf 0 0\n", "no point with finite coordinates", 1),
                                 ("0 0 0\n1e30 0 0\n", "remove stray points", 2)):
            cloud.write_text(text)
            self.fails(surefoot("dem", cloud, "--resolution", 0.1, "--out", out), "c.xyz", word, code=code)
            self.assertFalse(out.exists())
        cloud.write_text("0 0 0\nnan 0 0\n0 inf 0\n0.05 0.02 0.5\n")
        answer = self.json_of("dem", cloud, "--resolution", 0.1, "--out", out)
        self.assertEqual((answer["points"], answer["skipped"]), (2, 2))
        for resolution in ("nan", "inf", "0", "-1"):
            self.fails(surefoot("dem", cloud, "--resolution", resolution, "--out", out), "--resolution", code=2)
        image = self.dir / "heights.png"
        image.write_bytes(grey_png(8, 8))
        for scale, height in (("nan", 1), ("inf", 1), (0.025, "nan"), (0.025, 0)):
            self.fails(surefoot("rate", image, "--scale", scale, "--height", height, "--out", self.dir / "rated"), "--",
                       code=2)

    def test_clouds_of_fuse_that_are_none(self):
        steps = self.dir / "steps.txt"
        good = [0.0, 0.0, 1.0, 1e-4]
        for place, value in ((0, math.nan), (1, math.inf), (2, -math.inf), (3, math.nan), (3, -1.0)):
            point = list(good)
            point[place] = value
            (self.dir / "cloud0.f32").write_bytes(struct.pack("<8f", *good, *point))
            steps.write_text("0 time 1000 move_to 0 0\n")
            self.fails(surefoot("fuse", steps, "--preset", "ethz", "--out", self.dir / "f"), "cloud0.f32", "point 1")
        (self.dir / "cloud0.f32").write_bytes(struct.pack("<4f", *good))
        for line in ("0 time nan move_to 0 0", "0 time 1 move_to inf 0", "0 time 1 move_to 0 nan", "x time 1 move_to 0 0"):
            steps.write_text(line + "\n")
            self.fails(surefoot("fuse", steps, "--preset", "ethz", "--out", self.dir / "f"), "steps.txt:1")
        steps.write_text("0 time 1000 move_to 0 0\n0 time 999 move_to 1e30 0\n")  # earlier time, and very far away
        self.assertEqual(self.json_of("fuse", steps, "--preset", "ethz", "--out", self.dir / "f")["steps"], 2)

    def test_a_camera_that_froze_is_an_error_of_its_own(self):
        recording = self.broken_copy()
        for camera in ("cam0", "cam1"):
            for index in range(3, FRAMES):
                shutil.copy(self.image(recording, camera, 2), self.image(recording, camera, index))
        report = self.json_of("run", recording, "--machine", "rex", "--out", self.dir / "out")
        self.assertEqual(report["frame_status"]["longest_freeze_frames"], FRAMES - 3)
        frames = json.loads((self.dir / "out" / "report.json").read_text())["per_frame"]
        self.assertEqual([f["camera"] for f in frames], ["OK"] * 4 + ["FROZEN"] * (FRAMES - 4))
        process = surefoot("gate", "--map", self.dir / "out", "--pose", "0,0,0", "--command", 1, "--machine", "rex",
                           "--json")
        self.assertEqual(process.returncode, 4)
        verdict = json.loads(process.stdout)
        self.assertIn("FRAME_FROZEN", verdict["reasons"])
        self.assertIn("the camera image stands still", verdict["text"])

    def test_interrupt_in_the_middle(self):
        out = self.dir / "out"
        process = subprocess.Popen([str(BINARY), "run", "sim:demo_stairs", "--out", str(out)],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        while not out.exists() and process.poll() is None:  # the run has begun; its signal handler is installed
            time.sleep(0.05)
        time.sleep(3.0)
        process.send_signal(signal.SIGINT)
        _, log = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 1, log)
        self.assertIn("interrupted", log)
        report = json.loads((out / "report.json").read_text())
        self.assertFalse(report["complete"])
        self.kept(report["frames"])


def grainy(rows, draw):
    """A textured picture with sensor noise of one grey level."""
    return [bytes(min(255, max(0, value + draw.randrange(-1, 2))) for value in row) for row in rows]


def blobs(width, height, seed=1):
    draw = random.Random(seed)
    coarse = [[draw.randrange(256) for _ in range(width // 4 + 2)] for _ in range(height // 4 + 2)]
    return [bytes(coarse[v // 4][u // 4] for u in range(width)) for v in range(height)]


def moved(rows, columns, down=0):
    return [(rows[max(0, v - down)] + rows[v][-1:] * columns)[columns:] for v in range(len(rows))]


class BadImages(CliTest):
    """Pictures from which calibration, depth or map cannot be computed, or only with other options."""
    SIZE = 320, 200
    RIG = ("layout: side_by_side\nresolution: [320, 200]\nrate_hz: 15\nbaseline_m: 0.12\nfocal_px: 200\n"
           "principal_px: [160, 100]\ndistortion: none\n")

    def write(self, name, rows):
        path = self.dir / name
        path.write_bytes(png_of(rows))
        return path

    def source(self, left, right, frames=3):
        """A folder of side-by-side frames that differ only in noise."""
        folder, draw = self.dir / "source", random.Random(5)
        folder.mkdir(exist_ok=True)
        (folder / "rig.yaml").write_text(self.RIG)
        for index in range(frames):
            (folder / f"{index}.png").write_bytes(
                png_of([a + b for a, b in zip(grainy(left, draw), grainy(right, draw))]))
        return folder

    def verdict_of(self, folder):
        process = surefoot("gate", "--map", folder, "--pose", "0,0,0", "--command", 1, "--machine", "rex", "--json")
        self.assertEqual(process.returncode, 4, "the verdict must not be OK")
        return json.loads(process.stdout)["verdict"]

    def test_pictures_without_anything_to_see_give_an_empty_map(self):
        width, height = self.SIZE
        draw = random.Random(7)
        noise = [[draw.randbytes(width) for _ in range(height)] for _ in range(2)]
        black, white = [bytes(width)] * height, [b"\xff" * width] * height
        for left, right in ((black, black), (white, white), noise):
            report = self.json_of("run", self.source(left, right), "--out", self.dir / "out")
            self.assertEqual(report["map"]["known_cells"], 0)
            self.assertIn("odometry was lost", report["map"]["reason"])
            self.assertEqual(self.verdict_of(self.dir / "out"), "ERROR")

    def test_noise_alone_is_not_trusted(self):
        width, height = self.SIZE
        draw = random.Random(8)
        left, right = (self.write(name, [draw.randbytes(width) for _ in range(height)]) for name in ("l.png", "r.png"))
        answer = self.json_of("depth", left, right, "--out", self.dir / "out")
        self.assertLess(answer["trusted_percent"], 0.1)
        self.assertIsNone(answer["row_error"]["median_abs_px"])

    def test_a_saturated_picture_keeps_what_it_shows(self):
        rows = [bytes(255 if value > 60 else value for value in row) for row in blobs(*self.SIZE)]
        answer = self.json_of("depth", self.write("l.png", rows), self.write("r.png", moved(rows, 20)),
                              "--out", self.dir / "out")
        self.assertLess(answer["row_error"]["median_abs_px"], 0.1)
        self.assertGreater(answer["trusted_percent"], 50)

    def test_exchanged_and_crooked_eyes_are_said_by_a_run(self):
        rows = blobs(*self.SIZE)
        process = surefoot("run", self.source(moved(rows, 20), rows), "--out", self.dir / "out")
        self.assertEqual(process.returncode, 1)
        self.assertRegex(process.stderr, r"frame 0: left and right camera seem to be swapped: \d+ of \d+ corners")
        self.assertFalse(json.loads((self.dir / "out" / "report.json").read_text())["complete"])
        process = surefoot("serve", self.source(moved(rows, 20), rows), "--once", "--port", 0)
        self.assertEqual(process.returncode, 1)
        self.assertRegex(process.stderr, r"frame 0: left and right camera seem to be swapped: \d+ of \d+ corners")
        process = self.run_ok("run", self.source(rows, moved(rows, 20, down=3)), "--out", self.dir / "out")
        self.assertRegex(process.stderr, r"frame 0: rows differ by (2\.9|3\.0)\d px .*calibration does not fit")
        process = self.run_ok("run", self.source(rows, moved(rows, 20)), "--out", self.dir / "out")
        self.assertNotIn("rows differ", process.stderr)

    def test_pixels_of_16_bits_have_no_known_scale(self):
        deep = self.dir / "deep.pgm"
        deep.write_bytes(b"P5 320 200 65535\n" + bytes(2 * 320 * 200))
        flat = self.write("flat.png", [bytes(320)] * 200)
        for left, right in ((deep, flat), (flat, deep)):
            process = surefoot("depth", left, right, "--out", self.dir / "out")
            self.assertEqual(process.returncode, 1)
            self.assertIn("deep.pgm: 16 bits per channel", process.stderr)

    def test_a_picture_as_wide_as_8k_is_only_large(self):
        flat = self.write("flat.png", [bytes(7680)] * 1080)
        answer = self.json_of("depth", flat, flat, "--set", "stereo.disparities=16", "--out", self.dir / "out")
        self.assertEqual((answer["width"], answer["trusted_percent"]), (7680, 0))

    def test_nan_and_giants_in_a_rig(self):
        flat = self.write("flat.png", [bytes(320)] * 200)
        for line, word in (("baseline_m: .nan", "baseline_m"), ("focal_px: nan", "focal_px"),
                           ("principal_px: [.inf, 100]", "principal_px"), ("resolution: [99999, 1]", "resolution")):
            key = line.split(":")[0]
            rig = self.dir / "rig.yaml"
            rig.write_text("".join(line + "\n" if old.startswith(key) else old for old in self.RIG.splitlines(True)))
            for call in (["depth", flat, flat, "--rig", rig], ["run", "sim:floor", "--rig", rig],
                         ["depth-accuracy", "--rig", rig]):
                process = surefoot(*call, "--out", self.dir / "out")
                self.assertNotEqual(process.returncode, 0)
                self.assertRegex(process.stderr, rf"rig\.yaml:\d+: {word}")

    def test_pairs_of_depth_accuracy(self):
        rows = blobs(*self.SIZE)
        (self.dir / "rig.yaml").write_text(self.RIG)
        self.write("l.png", rows)
        self.write("r.png", moved(rows, 20))
        self.write("small.png", [bytes(160)] * 100)
        pairs = self.dir / "pairs.txt"
        for line, words in (("l.png small.png 1", "differ in size"), ("small.png small.png 1", "160x100 px, but rig"),
                            ("r.png l.png 1", "swapped")):
            pairs.write_text(line + "\n")
            process = surefoot("depth-accuracy", "--pairs", pairs, "--rig", self.dir / "rig.yaml",
                               "--out", self.dir / "out")
            self.assertEqual(process.returncode, 1, process.stderr)
            self.assertIn(words, process.stderr)


class BadBoards(CliTest):
    BOARD = "chessboard:7x5:0.03"

    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.TemporaryDirectory(prefix="surefoot-bad-boards-")
        cls.good = pathlib.Path(cls.shared.name) / "good"
        process = surefoot("calibrate", "render", "--board", cls.BOARD, "--rig", "zed_vga", "--views", 4,
                           "--out", cls.good)
        assert process.returncode == 0, process.stderr

    @classmethod
    def tearDownClass(cls):
        cls.shared.cleanup()

    def refused(self, words, verb, names, board=BOARD):
        """`names` maps the name of each new image to the good image that it copies."""
        folder = self.dir / "images"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        for name, good in names.items():
            shutil.copy(self.good / good, folder / name)
        process = surefoot("calibrate", verb, folder, "--board", board, "--out", self.dir / "out")
        self.assertEqual(process.returncode, 1, process.stderr)
        self.assertIn(words, process.stderr)
        self.assertFalse((self.dir / "out").exists(), "a failed calibration must not write a rig")

    def test_too_little_is_said(self):
        self.refused("1 usable and different views", "mono", {"a.png": "left000.png"})
        self.refused("the same as view 0", "mono", {f"{i}.png": "left000.png" for i in range(5)})
        self.refused("no chessboard of 9 x 9 inner corners", "mono", {"a.png": "left000.png"}, "chessboard:9x9:0.03")
        self.refused("left camera: calibration: only 1 usable", "stereo",
                     {"left0.png": "left000.png", "right0.png": "right000.png"})

    def test_exchanged_cameras_are_said(self):
        self.refused("to the left of the left one; swap the cameras", "stereo",
                     {f"{side}{i}.png": f"{other}00{i}.png" for i in range(4)
                      for side, other in (("left", "right"), ("right", "left"))})

    def test_other_sizes_and_nothing_to_see(self):
        folder = self.dir / "images"
        folder.mkdir()
        shutil.copy(self.good / "left000.png", folder / "a.png")
        (folder / "b.png").write_bytes(grey_png(1, 1))
        process = surefoot("calibrate", "mono", folder, "--board", self.BOARD, "--out", self.dir / "out")
        self.assertEqual(process.returncode, 1)
        self.assertIn("b.png: the image has 1 x 1 px, but the first image has 672 x 376", process.stderr)
        (folder / "a.png").write_bytes(grey_png(672, 376))
        (folder / "b.png").write_bytes(png_of([random.Random(1).randbytes(672) for _ in range(376)]))
        process = surefoot("calibrate", "mono", folder, "--board", self.BOARD, "--out", self.dir / "out")
        self.assertEqual(process.returncode, 1)
        self.assertIn("none of 2 images shows the board", process.stderr)

    def test_impossible_boards(self):
        for board in ("chessboard:1x1:0.03", "chessboard:7x5:nan", "chessboard:7x5:-1", "circles:7x5",
                      "chessboard:99999x5:0.03", "charuco:8x5:0.03:0.04"):
            process = surefoot("calibrate", "mono", self.good, "--board", board, "--out", self.dir / "out")
            self.assertEqual(process.returncode, 2, board)
            self.assertIn("board", process.stderr)


if __name__ == "__main__":
    unittest.main()
