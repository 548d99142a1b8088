"""Unreadable files, full disks, truncated videos: each gives a message and an exit code, and results are kept."""
import json
import os
import pathlib
import resource
import signal
import socket
import struct
import subprocess
import tempfile
import unittest

from surefoot_cli import BINARY, CliTest, png_of, read_tum, surefoot

RIG = ("layout: side_by_side\nresolution: [320, 200]\nrate_hz: 10\nbaseline_m: 0.12\nfocal_px: 160\n"
       "principal_px: [159.5, 99.5]\n")
FRAMES = 4


def little_memory():
    """Limits the address space to 3 GB, so that reading /dev/zero fails."""
    resource.setrlimit(resource.RLIMIT_AS, (3 << 30, 3 << 30))


def raw_avi(frames, width=640, height=200, rate=10):
    """An AVI 1.0 file of uncompressed 24-bit frames (chunks '00db') with an index, by Microsoft's format description."""
    image = bytes((x * 7 + y * 13 + x * y % 31) % 256 for y in range(height) for x in range(width) for _ in range(3))
    def chunk(name, body):
        return name + struct.pack("<I", len(body)) + body + b"\0" * (len(body) % 2)
    def listed(name, body):
        return chunk(b"LIST", name + body)
    header = struct.pack("<14I", 1000000 // rate, 0, 0, 0x10, frames, 0, 1, len(image), width, height, 0, 0, 0, 0)
    stream = b"vids" + b"DIB " + struct.pack("<IHHIIIIIIIIhhhh", 0, 0, 0, 0, 1, rate, 0, frames, len(image), 0, 0,
                                             0, 0, width, height)
    picture = struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, len(image), 0, 0, 0, 0)
    heads = listed(b"hdrl", chunk(b"avih", header) + listed(b"strl", chunk(b"strh", stream) + chunk(b"strf", picture)))
    one = chunk(b"00db", image)
    index = b"".join(b"00db" + struct.pack("<III", 0x10, 4 + i * len(one), len(image)) for i in range(frames))
    return chunk(b"RIFF", b"AVI " + heads + listed(b"movi", one * frames) + chunk(b"idx1", index))


class FilesThatAreNone(CliTest):
    """One case for every verb and option that reads a file."""

    def of_kind(self, kind, name):
        path = self.dir / kind / name
        path.parent.mkdir(exist_ok=True)
        if kind == "zero":
            path.symlink_to("/dev/zero")
        elif kind == "fifo":
            os.mkfifo(path)
        elif kind == "directory":
            path.mkdir()
        elif kind == "sparse":
            with open(path, "wb") as file:
                file.truncate(5 << 40)
        return path

    def calls(self, bad):
        """`bad(name)` makes an unreadable file with this name."""
        out = ["--out", self.dir / "out"]
        floor = ["sim:floor", "--max-frames", "1", "--set", "sim.sensor=analytic"]
        good = self.dir / "good.xyz"
        good.write_text("".join(f"{x} {y} 0\n" for x in range(9) for y in range(9)))
        grey = self.dir / "grey.png"
        grey.write_bytes(png_of([[128] * 64] * 48))
        return [["run", bad("v.avi"), *out], ["run", bad("v.mjpeg"), *out], ["info", bad("w.mp4")],
                ["run", *floor, *out, "--machine", bad("machine.yaml")], ["run", *floor, *out, "--config", bad("c.yaml")],
                ["run", *floor, *out, "--place", bad("f.place")], ["rate", bad("m.asc"), *out],
                ["rate", bad("m.png"), "--scale", "0.1", "--height", "1", *out], ["stairs", bad("n.asc")],
                ["stairs", bad("n.ply")], ["dem", bad("d.ply"), "--resolution", "0.1", "--out", self.dir / "d.asc"],
                ["dem", bad("d.txt"), "--resolution", "0.1", "--out", self.dir / "d.asc"],
                ["voxel", bad("d.pcd"), "--size", "0.1", "--out", self.dir / "v.ply"],
                ["sor", bad("d.las"), "--out", self.dir / "v.ply"], ["icp", good, bad("e.xyz")],
                ["icp", good, good, "--guess", bad("g.txt")], ["measure", bad("e.vtk")],
                ["eval", "clouds", good, bad("f.xyz")], ["ground", bad("g.ply")], ["map", "info", bad("m.region")],
                ["map", "export", bad("n.region"), *out], ["depth", grey, bad("r.png"), *out],
                ["eval", "depth", bad("a.pfm"), bad("b.pfm")], ["eval", "trajectory", bad("t.tum"), bad("u.tum")],
                ["eval", "stairs", bad("stairs.json"), bad("truth.json")], ["rig", bad("rig.yaml")],
                ["urdf", bad("model.yaml")], ["audit", "verify", bad("audit-1.log")], ["fuse", bad("steps.txt"), "--preset", "ethz", *out],
                ["sim", bad("scene.yaml"), "--frames", "1", *out], ["calibrate", "mono", bad("b.avi"), "--board",
                                                                   "chessboard:4x3:0.1", *out],
                ["rex-link", "--script", bad("s.csv")], ["depth-accuracy", "--pairs", bad("p.csv"), "--rig", bad("q.yaml"), *out]]

    def refused(self, kind, words):
        made = []

        def bad(name):
            made.append(self.of_kind(kind, name))
            return made[-1]
        for call in self.calls(bad):
            with self.subTest(call=" ".join(str(word) for word in call[:3])):
                process = surefoot(*call, timeout=60, preexec_fn=little_memory)
                self.assertIn(process.returncode, (1, 2), process.stderr)
                self.assertRegex(process.stderr, words)
                self.assertTrue(any(str(path) in process.stderr for path in made), process.stderr)

    def test_a_link_to_dev_zero(self):
        self.refused("zero", "this is a device")

    def test_a_fifo(self):
        self.refused("fifo", r"this is a FIFO")

    def test_a_sparse_file_of_five_terabytes(self):
        self.refused("sparse", "more than the limit")

    def test_a_snapshot_that_is_a_fifo_a_socket_or_a_directory(self):
        maps = self.dir / "maps"
        maps.mkdir()
        snapshot = maps / "map.snapshot"
        gate = ["gate", "--map", maps, "--pose", "0,0,0", "--command", "1"]
        os.mkfifo(snapshot)
        for words in ("this is a FIFO", "this is a socket", "has no map.snapshot and no elevation.asc"):
            process = surefoot(*gate, timeout=60)
            self.assertEqual(process.returncode, 4, process.stderr)
            self.assertIn(words, process.stdout + process.stderr)
            snapshot.rmdir() if snapshot.is_dir() else snapshot.unlink()
            if "FIFO" in words:
                listener = socket.socket(socket.AF_UNIX)
                self.addCleanup(listener.close)
                listener.bind(str(snapshot))
            else:
                snapshot.mkdir()
                if "directory" in words:
                    break

    def test_lists_and_images_of_a_recording(self):
        recording = self.dir / "recording"
        self.run_ok("sim", "floor", "--frames", 2, "--out", recording)
        for name in ("mav0/cam0/data.csv", "mav0/cam0/sensor.yaml",
                     sorted((recording / "mav0/cam0/data").iterdir())[1].relative_to(recording)):
            path = recording / name
            kept = path.read_bytes()
            path.unlink()
            os.mkfifo(path)
            process = surefoot("run", recording, "--out", self.dir / "out", timeout=60)
            self.assertEqual(process.returncode, 1)
            self.assertIn("this is a FIFO", process.stderr)
            path.unlink()
            path.write_bytes(kept)

    def test_results_do_not_wait_for_a_reader_of_a_fifo(self):
        out = self.dir / "out"
        out.mkdir()
        os.mkfifo(out / "report.html")
        process = surefoot("run", "sim:floor", "--max-frames", 1, "--set", "sim.sensor=analytic", "--out", out, timeout=120)
        self.assertEqual(process.returncode, 1)
        self.assertIn("report.html: cannot write", process.stderr)


def small_files(limit):
    """Makes every write beyond `limit` bytes of a file fail, as on a full disk."""
    def apply():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
    return apply


class FullDisks(CliTest):
    @classmethod
    def setUpClass(cls):
        cls.shared = tempfile.TemporaryDirectory(prefix="surefoot-full-disk-")
        cls.good = pathlib.Path(cls.shared.name) / "good"
        cls.region = pathlib.Path(cls.shared.name) / "a.region"
        for call in (["sim", "floor", "--frames", FRAMES, "--out", cls.good],
                     ["run", "sim:floor", "--max-frames", FRAMES, "--set", "sim.sensor=analytic", "--out",
                      pathlib.Path(cls.shared.name) / "run", "--save-map", cls.region]):
            process = surefoot(*call)
            assert process.returncode == 0, process.stderr

    @classmethod
    def tearDownClass(cls):
        cls.shared.cleanup()

    def lines(self, *call, limit=20_000):
        """All lines of stdout and stderr in the order of a log file or terminal."""
        process = subprocess.run([str(BINARY), *map(str, call)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                 timeout=300, env={**os.environ, "NO_COLOR": "1"}, preexec_fn=small_files(limit))
        self.assertEqual(process.returncode, 1, process.stdout)
        return process.stdout.splitlines()

    def test_the_last_line_is_the_error(self):
        out = self.dir / "out"
        for call in (["run", self.good, "--out", out], ["record", self.good, "--out", self.dir / "copy"],
                     ["sim", "floor", "--frames", 2, "--out", self.dir / "sim"],
                     ["map", "export", self.region, "--out", self.dir / "export"],
                     ["sim", "floor", "--scan", self.dir / "scan.ply", "--set", "sim.laser.step_deg=2"],
                     ["rate", pathlib.Path(self.shared.name) / "run" / "elevation.asc", "--out", self.dir / "rated"]):
            lines = self.lines(*call)
            self.assertRegex(lines[-1], r"^error: .*(File too large|cannot write)", "\n".join(lines))
            self.assertFalse([line for line in lines if line.startswith("the results are in")], lines)

    def test_run_says_how_much_is_missing_and_keeps_what_fits(self):
        out = self.dir / "out"
        process = surefoot("run", self.good, "--out", out, "--json", preexec_fn=small_files(20_000))
        self.assertEqual(process.returncode, 1)
        answer = json.loads(process.stdout)
        self.assertFalse(answer["complete"])
        self.assertRegex(answer["error"], r"File too large.*\(and \d+ other results could not be written\)")
        self.assertEqual(answer["output_error"], answer["error"])
        self.assertEqual(answer["frames"], FRAMES)
        self.assertRegex(process.stderr, "contains only a part of the results")
        self.assertEqual(len(read_tum(out / "trajectory.tum")), FRAMES)
        self.assertEqual(list(out.glob("*.tmp*")), [])

    def test_a_recording_that_met_a_full_disk_can_be_played(self):
        copy = self.dir / "copy"
        process = surefoot("record", self.good, "--out", copy, "--json", preexec_fn=small_files(20_000))
        self.assertFalse(json.loads(process.stdout)["complete"])
        # A disk with room for two frames keeps the first two.
        mount = self.dir / "disk"
        mount.mkdir()
        sizes = [path.stat().st_size for path in (self.good / "mav0").rglob("*.png")]
        room = int(sum(sizes) * 2.6 / FRAMES) // 4096 * 4096
        if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={room}", "tmpfs", mount], capture_output=True).returncode:
            print("skipped 1 check: mounting a small disk is not permitted here", flush=True)
            return
        self.addCleanup(subprocess.run, ["umount", mount])
        process = surefoot("record", self.good, "--out", mount / "copy")
        self.assertEqual(process.returncode, 1)
        self.assertIn("No space left on device", process.stderr)
        self.assertIn("before the error", process.stdout)
        frames = self.json_of("info", mount / "copy")["frames"]
        self.assertGreater(frames, 0)
        self.assertEqual(self.json_of("info", mount / "copy")["missing_images"], 0)

    def test_an_answer_that_does_not_reach_stdout_is_an_error(self):
        with open("/dev/full", "wb") as full:
            for call, code in ((["info", self.good, "--json"], 1), (["config"], 1),
                               (["gate", "--map", self.good, "--pose", "0,0,0", "--command", "1"], 4)):
                process = subprocess.run([str(BINARY), *map(str, call)], stdout=full, stderr=subprocess.PIPE, text=True)
                self.assertEqual(process.returncode, code, process.stderr)
                if code == 1:
                    self.assertIn("stdout: cannot write", process.stderr)


class Videos(CliTest):
    """A truncated video of uncompressed frames."""

    def video(self, frames, whole):
        (self.dir / "rig.yaml").write_text(RIG)
        path = self.dir / "walk.avi"
        bytes_ = raw_avi(frames)
        path.write_bytes(bytes_ if whole else bytes_[:len(bytes_) // 2])
        return path

    def test_a_whole_video_is_complete(self):
        video = self.video(6, whole=True)
        answer = self.json_of("run", video, "--out", self.dir / "out")
        self.assertTrue(answer["complete"])
        self.assertEqual((answer["frames"] + answer["waited_frames"], answer["source"]["announced_frames"]), (6, 6))

    def test_half_a_video_is_not(self):
        video = self.video(8, whole=False)
        process = surefoot("run", video, "--out", self.dir / "out", "--json")
        self.assertEqual(process.returncode, 1)
        answer = json.loads(process.stdout)
        self.assertFalse(answer["complete"])
        self.assertRegex(answer["error"], "breaks off here: . of the 8 frames that its container announces")
        self.assertEqual(answer["source"]["announced_frames"], 8)
        info = self.json_of("info", video)
        self.assertEqual(info["announced_frames"], 8)
        self.assertIn(info["frames"], (2, 3, 4))
        self.assertRegex(info["incomplete"], "breaks off")
        skipped = self.json_of("run", video, "--out", self.dir / "out", "--skip-broken")
        self.assertEqual(skipped["source"]["broken_frames"], 1)
        self.assertRegex(skipped["source"]["first_broken"], "breaks off")


class SkipBroken(CliTest):
    def test_a_run_goes_on_past_a_broken_frame_and_counts_it(self):
        recording = self.dir / "recording"
        self.run_ok("sim", "floor", "--frames", FRAMES, "--out", recording)
        victim = sorted((recording / "mav0/cam0/data").iterdir())[2]
        victim.write_bytes(victim.read_bytes()[:2000])
        process = surefoot("run", recording, "--out", self.dir / "out")
        self.assertEqual(process.returncode, 1)
        process = self.run_ok("run", recording, "--out", self.dir / "out", "--skip-broken")
        self.assertIn("1 broken frame was skipped (--skip-broken); the first: frame 2", process.stdout)
        report = json.loads((self.dir / "out" / "report.json").read_text())
        self.assertEqual((report["frames"], report["source"]["broken_frames"], report["frame_status"]["damaged_frames"]),
                         (FRAMES - 1, 1, 1))
        self.assertTrue(report["complete"])
        self.assertIn("was skipped", (self.dir / "out" / "report.html").read_text())


if __name__ == "__main__":
    unittest.main()
