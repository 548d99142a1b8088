"""Follows docs/get_started/own_camera.md step by step, with simulated frames instead of a camera."""
import re
import textwrap
import unittest
import zlib

from surefoot_cli import ROOT, CliTest, png_of, surefoot

PAGE = (ROOT / "docs" / "get_started" / "own_camera.md").read_text()


def grey_rows(png):
    """Reads the rows of an 8-bit grey PNG (W3C PNG specification, filters 0-4)."""
    data, width, at = b"", 0, 8
    while at < len(png):
        length, kind = int.from_bytes(png[at:at + 4], "big"), png[at + 4:at + 8]
        body = png[at + 8:at + 8 + length]
        width = int.from_bytes(body[:4], "big") if kind == b"IHDR" else width
        data += body if kind == b"IDAT" else b""
        at += length + 12
    raw, rows, above = zlib.decompress(data), [], bytes(width)
    for start in range(0, len(raw), width + 1):
        method, line = raw[start], bytearray(raw[start + 1:start + 1 + width])
        for i in range(width):
            left, up, corner = (line[i - 1] if i else 0), above[i], (above[i - 1] if i else 0)
            guess = left + up - corner
            nearest = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
            line[i] = (line[i] + (0, left, up, (left + up) // 2, nearest)[method]) & 255
        rows.append(bytes(line))
        above = line
    return rows


class OwnCamera(CliTest):
    def rigs_of_the_page(self):
        blocks = re.findall(r"(?:^ {6}\S.*\n)+", PAGE, re.M)
        return [textwrap.dedent(block) for block in blocks if "resolution:" in block]

    def test_all_rigs_of_the_page_are_whole(self):
        rigs = self.rigs_of_the_page()
        self.assertEqual(len(rigs), 3)
        for text in rigs:
            (self.dir / "rig.yaml").write_text(text)
            answer = self.json_of("rig", self.dir / "rig.yaml")
            expected = (640, 480, None) if "rgbd" in text else (672, 376, 0.12)
            self.assertEqual((answer["width"], answer["height"], answer["baseline_m"]), expected)

    def test_a_depth_camera_that_is_not_called_one_is_told_so(self):
        text = next(rig for rig in self.rigs_of_the_page() if "rgbd" in rig)
        (self.dir / "rig.yaml").write_text(text.replace("layout: rgbd\n", ""))
        process = surefoot("rig", self.dir / "rig.yaml")
        self.assertEqual(process.returncode, 1)
        self.assertIn("needs 'layout: rgbd'", process.stderr)

    def test_a_folder_of_side_by_side_frames_becomes_a_map(self):
        frames = 11  # 10 comes after 9: natural order
        recording, mine = self.dir / "recording", self.dir / "mine"
        self.run_ok("sim", "floor", "--frames", frames, "--out", recording)
        mine.mkdir()
        eyes = [sorted((recording / "mav0" / eye / "data").glob("*.png"), key=lambda file: int(file.stem))
                for eye in ("cam0", "cam1")]
        for index, pair in enumerate(zip(*eyes)):
            left, right = (grey_rows(file.read_bytes()) for file in pair)
            (mine / f"frame{index + 1}.png").write_bytes(png_of([a + b for a, b in zip(left, right)]))

        process = surefoot("run", mine, "--out", self.dir / "out")
        self.assertEqual(process.returncode, 1)
        self.assertIn("rig.yaml", process.stderr)  # the missing file

        # The simulator's rig, in the format of `calibrate stereo`.
        self.run_ok("rig", recording, "--out", mine / "rig.yaml")
        info = self.json_of("info", mine)
        self.assertEqual((info["kind"], info["frames"]), ("side_by_side", frames))
        report = self.json_of("run", mine, "--machine", "rex", "--out", self.dir / "out")
        self.assertEqual((report["frames"], report["gravity_source"]), (frames, "plane"))
        self.assertGreater(report["map"]["known_cells"], 1000)
        trajectory = (self.dir / "out" / "trajectory.tum").read_text().splitlines()
        along_m = [float(line.split()[1]) for line in trajectory if line[0] != "#"]
        # In natural order (frame10 after frame9) the trolley never rolls back by more than the noise.
        self.assertGreater(min(b - a for a, b in zip(along_m, along_m[1:])), -0.002)


if __name__ == "__main__":
    unittest.main()
