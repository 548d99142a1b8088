"""Saved maps: the file of run --save-map, read by the rules of docs/reference/map_format.md; merge, export, errors."""
import math
import struct

from surefoot_cli import CliTest, read_asc, surefoot

FIXED = struct.Struct("<8sHHIqqQdqqii7d32sII")  # the header of version 1.0
FORMATS = {1: "f", 2: "I", 3: "q"}


def fnv1a(data):
    value = 0xCBF29CE484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 & (1 << 64) - 1
    return value


def read_region(path):
    """Returns the header as a dict and the layers as flat lists."""
    data = path.read_bytes()
    fields = FIXED.unpack_from(data)
    head = dict(zip(("magic", "major", "minor", "bytes", "stamp_ns", "frame_since_ns", "config_hash", "resolution_m",
                     "first_ix", "first_iy", "nx", "ny"), fields))
    head["body"], head["frame"], count = fields[12:19], fields[19].rstrip(b"\0").decode(), fields[20]
    assert struct.unpack("<Q", data[-8:])[0] == fnv1a(data[:-8])
    layers, cells_at, cells = {}, head["bytes"] + 64 * count, head["nx"] * head["ny"]
    for i in range(count):
        name, unit, kind, size = struct.unpack_from("<40s16sII", data, head["bytes"] + 64 * i)
        layers[name.rstrip(b"\0").decode()] = struct.unpack_from(f"<{cells}{FORMATS[kind]}", data, cells_at)
        cells_at += cells * size
    assert cells_at == len(data) - 8
    return head, layers


class SavedMaps(CliTest):
    def run_floor(self, *extra, frames=4):
        self.run_ok("run", "sim:floor", "--max-frames", frames, "--set", "sim.sensor=analytic", "--out", self.dir / "out",
                    "--save-map", self.dir / "floor.region", "--set", "elevation.length_m=2", *extra)
        return self.dir / "floor.region"

    def test_the_file_is_what_the_document_says_and_holds_what_the_run_wrote(self):
        head, layers = read_region(self.run_floor())
        self.assertEqual((head["magic"], head["major"], head["minor"], head["bytes"]), (b"SFREGION", 1, 0, 168))
        self.assertEqual((head["nx"], head["ny"], head["resolution_m"], head["frame"]), (80, 80, 0.025, "odom"))
        self.assertGreater(head["stamp_ns"], head["frame_since_ns"])
        for name in ("elevation", "variance"):
            grid, values = read_asc(self.dir / "out" / f"{name}.asc")
            self.assertAlmostEqual(grid["xllcorner"], head["first_ix"] * head["resolution_m"], places=9)
            rows = [layers[name][80 * iy:80 * iy + 80] for iy in reversed(range(80))]
            for row, written in zip(rows, values):
                for a, b in zip(row, written):  # written with nine digits
                    self.assertTrue(math.isnan(a) if b is None else abs(a - b) <= 1e-8 * abs(b), f"{name}: {a}, {b}")
        last = (self.dir / "out" / "trajectory.tum").read_text().split("\n")[-2].split()
        for a, b in zip(head["body"], map(float, last[1:])):
            self.assertAlmostEqual(a, b, places=6)

    def test_the_same_run_gives_the_same_bytes_for_any_number_of_threads(self):
        first = self.run_floor("--threads", 1).read_bytes()
        self.assertEqual(first, self.run_floor("--threads", 3).read_bytes())

    def test_a_map_merged_with_itself_is_itself(self):
        region = self.run_floor()
        both = self.dir / "both.region"
        answer = self.json_of("map", "merge", region, region, "--out", both)
        self.assertEqual((answer["taken"], answer["disagreed"], answer["agreed"]), (0, 0, answer["known_cells"]))
        self.assertEqual(both.read_bytes(), region.read_bytes())
        self.run_ok("map", "merge", region, region, "--independent", "--out", both)
        _, once = read_region(region)
        _, twice = read_region(both)
        # By equation 6.1 two equal variances fuse to half of one, but not below the floor of (3 mm)^2.
        for a, b in zip(once["variance"], twice["variance"]):
            self.assertTrue(math.isnan(a) or abs(b - max(a / 2, 9e-6)) < 1e-6 * a)

    def test_the_older_map_pays_for_the_way_to_the_younger(self):
        old = self.run_floor(frames=2)
        old = old.rename(self.dir / "old.region")
        young, both = self.run_floor(), self.dir / "both.region"
        free = self.run_ok("map", "merge", young, old, "--out", both)
        self.assertIn("old.region: this map is", free.stderr)
        self.assertIn("--motion-sigma", free.stderr)
        _, unpaid = read_region(both)
        paid = self.run_ok("map", "merge", young, old, "--motion-sigma", "0.1,0.1,1", "--out", both)
        self.assertNotIn("--motion-sigma", paid.stderr)
        head, result = read_region(both)
        self.assertEqual(head["stamp_ns"], read_region(young)[0]["stamp_ns"])
        # With 10 cm of motion sigma for the older map, the younger one is more certain and keeps its known cells.
        for known, cell in zip(read_region(young)[1]["variance"], result["variance"]):
            self.assertTrue(math.isnan(known) or known == cell)
        self.assertTrue(all(math.isnan(a) or b >= a for a, b in zip(unpaid["variance"], result["variance"])))

    def test_export_writes_every_layer_the_cloud_and_the_pictures(self):
        region = self.run_floor()
        answer = self.json_of("map", "export", region, "--out", self.dir / "files")
        names = {path.name for path in (self.dir / "files").iterdir()}
        self.assertEqual(names, set(answer["files"]))
        self.assertEqual(names, {"elevation.asc", "variance.asc", "count.asc", "age.asc", "drift.asc", "highest.asc",
                                 "lowest.asc", "clearance.asc", "confidence.asc", "density_ratio.asc", "map.ply",
                                 "elevation.png", "sigma.png"})
        for name in ("elevation.asc", "variance.asc"):
            self.assertEqual((self.dir / "files" / name).read_bytes(), (self.dir / "out" / name).read_bytes())
        head = (self.dir / "files" / "map.ply").read_bytes().split(b"end_header")[0].decode()
        self.assertIn(f"element vertex {answer['known_cells']}", head)
        for scalar in ("variance_m2", "count", "age_s", "drift_m", "clearance_m", "confidence"):
            self.assertIn(f" {scalar}\n", head)

    def test_what_cannot_be_used_is_said(self):
        region = self.run_floor()
        damaged = self.dir / "damaged.region"
        data = bytearray(region.read_bytes())
        data[5000] ^= 1
        damaged.write_bytes(data)
        other = self.dir / "other.region"
        data = bytearray(region.read_bytes()[:-8])
        data[24:32] = struct.pack("<q", 7)  # the id of another run
        other.write_bytes(data + struct.pack("<Q", fnv1a(data)))
        out = self.dir / "c.region"
        for words, said, code in (
                (["info", damaged], "damaged.region: truncated or damaged map region: its checksum is wrong", 1),
                (["info", self.dir / "none.region"], "none.region", 1),
                (["info", self.dir / "out" / "map.ply"], "not a map region", 1),
                (["export", damaged, "--out", self.dir / "x"], "checksum", 1),
                (["merge", region, other, "--out", out], "two runs", 1),
                (["merge", region, region, "--motion-sigma", "1,2", "--out", out], "--motion-sigma", 2),
                (["merge", region, region, "--motion-sigma", "1,2,-3", "--out", out], "negative", 2)):
            process = surefoot("map", *words)
            self.assertEqual(process.returncode, code, process.stderr)
            self.assertIn(said, process.stderr)
        self.assertFalse(out.exists())
        self.run_ok("map", "merge", region, other, "--independent", "--out", out)
