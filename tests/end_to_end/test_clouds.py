"""Cloud tools: reference vectors of CloudCompare, one cloud in every format, large and invalid clouds."""
import json
import math
import struct
import unittest
from random import Random

from surefoot_cli import CliTest, read_asc, surefoot

AGREEMENT_M = 1e-6  # tolerance stated in the README of the vectors


def table(path):
    return [[float(word) for word in line.split()] for line in path.read_text().splitlines() if not line.startswith("//")]


def values(path):
    return [[float(word) for word in line.split(",")] for line in path.read_text().splitlines()]


def ply(points, kind="<", real="float", tail=""):
    code = {"float": "f", "double": "d"}[real]
    order = "little" if kind == "<" else "big"
    head = f"ply\nformat binary_{order}_endian 1.0\nelement vertex {len(points)}\n"
    head += "".join(f"property {real} {axis}\n" for axis in "xyz") + f"{tail}end_header\n"
    return head.encode() + b"".join(struct.pack(f"{kind}3{code}", *p) for p in points)


def grid_points(side=20, step=0.1):
    """A level square with a step of 0.2 m across its middle, in multiples of 1/1024 m."""
    on_lattice = lambda v: round(v * 1024) / 1024
    return [(on_lattice(i * step), on_lattice(j * step), on_lattice(0.2 if i * 2 >= side else 0.0))
            for i in range(side) for j in range(side)]


class Conformance(CliTest):
    def setUp(self):
        super().setUp()
        self.vectors = self.data("conformance", "clouds")

    def test_c2c(self):
        out = self.dir / "c2c.csv"
        answer = self.json_of("eval", "clouds", self.vectors / "ref_e1.ply", self.vectors / "ref_e2.ply", "--values", out)
        expected = [row[-1] for row in table(self.vectors / "c2c_e2_vs_e1.asc")]
        found = [row[0] for row in values(out)]
        self.assertEqual(len(found), len(expected))
        worst = max(abs(a - b) for a, b in zip(found, expected))
        print(f"c2c: largest difference {worst:.2g} m")
        self.assertLess(worst, AGREEMENT_M)
        self.assertEqual(answer["count"], len(expected))
        self.assertAlmostEqual(answer["mean_m"], sum(expected) / len(expected), delta=AGREEMENT_M)

    def test_m3c2(self):
        out = self.dir / "m3c2.csv"
        settings = {"projection_diameter_m": 0.1, "half_length_m": 0.15, "registration_error_m": 0.001, "min_points": 5}
        answer = self.json_of("eval", "clouds", self.vectors / "ref_e1.ply", self.vectors / "ref_e2.ply", "--method", "m3c2",
                              "--core", self.vectors / "ref_core.ply", "--values", out,
                              *[word for key, value in settings.items() for word in ("--set", f"eval.m3c2.{key}={value}")])
        expected = table(self.vectors / "m3c2_vertical.asc")
        found = values(out)
        self.assertEqual(len(found), len(expected))
        worst = 0.0
        for i, (ours, theirs) in enumerate(zip(found, expected)):
            distance, lod, std1, std2, n1, n2, significant = ours
            self.assertEqual([n1, n2, significant], [theirs[3], theirs[4], theirs[7]], f"core point {i}")
            for a, b in ((distance, theirs[9]), (lod, theirs[8]), (std1, theirs[5]), (std2, theirs[6])):
                self.assertEqual(math.isnan(a), math.isnan(b), f"core point {i}: {ours}")
                worst = worst if math.isnan(a) else max(worst, abs(a - b))
        print(f"m3c2: largest difference {worst:.2g} m")
        self.assertLess(worst, AGREEMENT_M)
        self.assertEqual(answer["significant"], sum(row[7] for row in expected))

    def test_sor(self):
        for words in (["--neighbours", 7], ["--neighbours", 6, "--counting", "others"]):
            self.run_ok("sor", self.vectors / "ref_sor_in.ply", "--sigmas", 4, *words, "--out", self.dir / "kept.xyz")
            found, expected = table(self.dir / "kept.xyz"), table(self.vectors / "sor_7_4.asc")
            self.assertEqual(len(found), len(expected))
            for ours, theirs in zip(found, expected):
                for a, b in zip(ours, theirs):
                    self.assertAlmostEqual(a, b, delta=AGREEMENT_M)
        both = [self.json_of("sor", self.vectors / "ref_sor_in.ply", "--counting", counting, "--out", self.dir / "k.xyz")
                for counting in ("self", "others")]
        self.assertEqual([answer["others"] for answer in both], [6, 7])
        self.assertLess(both[0]["mean_m"], both[1]["mean_m"])

    def test_dem(self):
        self.run_ok("dem", self.vectors / "ref_e1.ply", "--resolution", 0.025, "--lattice", "node", "--out", self.dir / "d.asc")
        header, rows = read_asc(self.dir / "d.asc")
        expected = {}
        for x, y, z, _ in table(self.vectors / "dem_0.025_MAX.asc"):
            expected[round((x - header["xllcorner"]) / 0.025 - 0.5), round((y - header["yllcorner"]) / 0.025 - 0.5)] = z
        found = {(i, len(rows) - 1 - j): z for j, row in enumerate(rows) for i, z in enumerate(row) if z is not None}
        self.assertEqual(set(found), set(expected))
        self.assertLess(max(abs(found[cell] - expected[cell]) for cell in expected), AGREEMENT_M)

    def test_icp(self):
        out = self.dir / "T.txt"
        answer = self.json_of("icp", self.vectors / "ref_e1.ply", self.vectors / "ref_e3_misaligned.ply", "--transform", out,
                              "--out", self.dir / "aligned.ply")
        truth = table(self.vectors / "ref_e3_true_transform_e3_to_e1.txt")
        found = table(out)
        for ours, printed in zip(answer["T_reference_moved"], found):
            for a, b in zip(ours, printed):
                self.assertAlmostEqual(a, b, delta=1e-12)
        trace = sum(found[i][k] * truth[i][k] for i in range(3) for k in range(3))
        turn_deg = math.degrees(math.acos(min(1.0, (trace - 1.0) / 2.0)))
        place_mm = 1e3 * math.dist([row[3] for row in found[:3]], [row[3] for row in truth[:3]])
        print(f"icp: off by {turn_deg:.4f} deg, {place_mm:.2f} mm after {answer['iterations']} iterations")
        self.assertTrue(answer["converged"])
        self.assertLess(turn_deg, 0.05)
        self.assertLess(place_mm, 2.0)
        # Without side walls only the borders fix the position along the stairs; the answer says so.
        self.assertEqual((answer["border_directions"], answer["free_directions"]), (1, 0))
        after = self.json_of("eval", "clouds", self.vectors / "ref_e1.ply", self.dir / "aligned.ply")
        before = self.json_of("eval", "clouds", self.vectors / "ref_e1.ply", self.vectors / "ref_e3_misaligned.ply")
        self.assertLess(after["rms_m"], 0.6 * before["rms_m"])
        # A poor initial guess, given as a matrix and as numbers.
        (self.dir / "guess.txt").write_text("1 0 0 0.1\n0 1 0 0\n0 0 1 0\n0 0 0 1\n")
        for guess in ("0.1,0,0,0", self.dir / "guess.txt"):
            again = self.json_of("icp", self.vectors / "ref_e1.ply", self.vectors / "ref_e3_misaligned.ply", "--guess", guess)
            self.assertGreater(again["steps"][0]["rms_m"], answer["steps"][0]["rms_m"])


class Surface(CliTest):
    """Ground is the highest surface with enough points that is not an overhang."""

    def cloud(self, beam):
        """A floor and four steps of 0.17 m by 0.28 m, ten points per cell; behind each nosing there are flying pixels."""
        random = Random(1).random
        height = lambda x: 0.0 if x < 0.6 else 0.17 * min(4, int((x - 0.6) / 0.28) + 1)
        points = []
        for i in range(48000):
            x, y = 2.2 * random(), 1.2 * random() - 0.6
            points.append((x, y, height(x) + 0.006 * (random() - 0.5)))
        for i in range(6000):
            share, step = random(), i % 4  # flying pixels: from a nosing up and away from the camera
            points.append((0.6 + 0.28 * step + 0.25 * share, 1.2 * random() - 0.6, 0.17 * (step + 1) + 0.4 * share * (0.3 + random())))
        if beam:
            points += [(0.2 + 0.1 * random(), 1.2 * random() - 0.6, 1.8 + 0.1 * random()) for _ in range(8000)]
        path = self.dir / f"cloud{beam}.ply"
        path.write_bytes(ply(points))
        return path

    def test_stairs_of_a_cloud_with_pixels_in_flight_and_a_beam(self):
        for beam in (0, 1):
            answer = self.json_of("stairs", self.cloud(beam), "--from", "0.1,0")
            self.assertEqual([(flight["kind"], flight["steps"]) for flight in answer["flights"]], [("up", 4)])
            self.assertAlmostEqual(answer["flights"][0]["riser_m"], 0.17, delta=0.004)

    def test_dem_takes_surfaces_and_cuts(self):
        cloud = self.cloud(1)
        heights = {}
        for name, words in (("max", ["--reduce", "max"]), ("surface", ["--reduce", "surface"]),
                            ("cut", ["--reduce", "surface", "--max-height", 1.0])):
            self.run_ok("dem", cloud, "--resolution", 0.025, "--out", self.dir / "d.asc", *words)
            heights[name] = [z for row in read_asc(self.dir / "d.asc")[1] for z in row if z is not None]
        self.assertGreater(max(heights["max"]), 1.8)
        for name in ("surface", "cut"):
            self.assertLess(max(heights[name]), 1.0)  # the beam is not ground
            self.assertLess(sum(z > 0.7 for z in heights[name]), 0.01 * len(heights[name]))
        for words, why in ((["--reduce", "max", "--max-height", 1.0], "work with --reduce surface only"),
                           (["--reduce", "surface", "--min-height", 2, "--max-height", 1], "must be below")):
            process = surefoot("dem", cloud, "--resolution", 0.025, "--out", self.dir / "d.asc", *words)
            self.assertEqual(process.returncode, 2)
            self.assertIn(why, process.stderr)


class Formats(CliTest):
    def test_the_same_cloud_from_every_format(self):
        points = grid_points()
        text = "".join(f"{x} {y} {z}\n" for x, y, z in points)
        head = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n" + f"WIDTH {len(points)}\nHEIGHT 1\nPOINTS {len(points)}\n"
        las = bytearray(227)
        las[0:4], las[24:26], las[94:96] = b"LASF", bytes([1, 2]), struct.pack("<H", 227)
        las[96:100], las[105:107], las[107:111] = struct.pack("<I", 227), struct.pack("<H", 20), struct.pack("<I", len(points))
        las[131:179] = struct.pack("<6d", *[1 / 1024] * 3, 0, 0, 0)
        las += b"".join(struct.pack("<3i8x", *(round(c * 1024) for c in p)) for p in points)
        ascii_head = ply(points).split(b"end_header\n")[0].replace(b"binary_little_endian", b"ascii")
        files = {"le.ply": ply(points), "be.ply": ply(points, ">", "double"), "a.ply": ascii_head + b"end_header\n" + text.encode(),
                 "b.pcd": (head + "DATA binary\n").encode() + b"".join(struct.pack("<3f", *p) for p in points),
                 "a.pcd": (head + "DATA ascii\n" + text).encode(), "a.xyz": text.encode(),
                 "crlf.csv": text.replace(" ", ",").replace("\n", "\r\n").encode(), "a.las": bytes(las),
                 "a.vtk": f"# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\nPOINTS {len(points)} float\n{text}".encode()}
        for name, content in files.items():
            (self.dir / name).write_bytes(content)
            answer = self.json_of("eval", "clouds", self.dir / "le.ply", self.dir / name)
            self.assertEqual((answer["count"], answer["max_m"]), (len(points), 0.0), name)
            thinned = self.json_of("voxel", self.dir / name, "--size", 0.25, "--out", self.dir / "v.xyz")
            self.assertEqual((thinned["points"], thinned["skipped"]), (len(points), 0), name)
            self.assertEqual(table(self.dir / "v.xyz"), table(self.dir / "v.xyz"))

    def test_large_coordinates_keep_their_millimetres(self):
        far = [(x + 637012.25, y + 5403400.5, z + 431.0) for x, y, z in grid_points()]
        moved = [(x, y, z + 1 / 256) for x, y, z in far]
        (self.dir / "a.ply").write_bytes(ply(far, real="double"))
        (self.dir / "b.ply").write_bytes(ply(moved, real="double"))
        answer = self.json_of("eval", "clouds", self.dir / "a.ply", self.dir / "b.ply", "--out", self.dir / "pictures")
        self.assertEqual(answer["shift_m"], [637000.0, 5403400.0, 0.0])
        self.assertAlmostEqual(answer["p50_m"], 1 / 256, delta=1e-6)
        self.assertAlmostEqual(answer["max_m"], 1 / 256, delta=1e-6)
        self.assertEqual({path.name for path in (self.dir / "pictures").iterdir()}, {"distances.png", "distances.ply", "histogram.svg"})
        back = self.json_of("icp", self.dir / "a.ply", self.dir / "b.ply")["T_reference_moved"]
        place = [sum(row[k] * (637013.25, 5403401.5, 431.0, 1.0)[k] for k in range(4)) for row in back[:3]]
        self.assertAlmostEqual(place[2], 431.0 - 1 / 256, delta=1e-5)
        kept = self.json_of("sor", self.dir / "a.ply", "--out", self.dir / "kept.ply")
        same = self.json_of("eval", "clouds", self.dir / "a.ply", self.dir / "kept.ply")
        self.assertEqual((same["count"], same["max_m"]), (kept["kept"], 0.0))

    def test_sor_keeps_all_that_is_known_of_a_point(self):
        lines = [f"{x} {y} {z} {i}" for i, (x, y, z) in enumerate(grid_points())] + ["0.5 0.5 9 1e4"]
        (self.dir / "a.xyz").write_text("//X Y Z intensity\n" + "\n".join(lines) + "\n")
        self.run_ok("sor", self.dir / "a.xyz", "--out", self.dir / "k.xyz")
        self.assertEqual([row[3] for row in table(self.dir / "k.xyz")], list(range(len(lines) - 1)))
        self.assertTrue((self.dir / "k.xyz").read_text().startswith("//X Y Z intensity\n"))


    def test_sor_keeps_types_viewpoint_and_says_what_is_lost(self):
        points = grid_points()
        head = ("VERSION 0.7\nFIELDS x y z timestamp id\nSIZE 4 4 4 8 4\nTYPE F F F F U\nCOUNT 1 1 1 1 1\n"
                f"WIDTH {len(points)}\nHEIGHT 1\nVIEWPOINT 0 -1 0 0.6 0.8 0 0\nPOINTS {len(points)}\nDATA binary\n")
        rows = [struct.pack("<3fdI", *p, 1688000000.0 + 0.01 * i, 4000000000 + i) for i, p in enumerate(points)]
        (self.dir / "a.pcd").write_bytes(head.encode() + b"".join(rows))
        answer = self.json_of("sor", self.dir / "a.pcd", "--sigmas", 100, "--out", self.dir / "b.pcd")
        self.assertEqual((answer["kept"], answer["notes"]), (len(points), []))
        written, body = (self.dir / "b.pcd").read_bytes().split(b"DATA binary\n")
        self.assertIn(b"SIZE 4 4 4 8 4\nTYPE F F F F U\n", written)
        self.assertIn(b"VIEWPOINT 0 -1 0 0.6 0.8 0 0\n", written)
        self.assertEqual(body, b"".join(rows))
        answer = self.json_of("sor", self.dir / "a.pcd", "--sigmas", 100, "--out", self.dir / "b.ply")
        self.assertEqual(len(answer["notes"]), 1)
        self.assertIn("viewpoint", answer["notes"][0])
        written, body = (self.dir / "b.ply").read_bytes().split(b"end_header\n")
        self.assertIn(b"property double timestamp\nproperty uint id\n", written)
        self.assertEqual(body, b"".join(rows))
        answer = self.json_of("voxel", self.dir / "a.pcd", "--size", 0.1, "--out", self.dir / "v.pcd")
        self.assertEqual(answer["notes"], ["only positions are kept; the output lacks: timestamp, id, viewpoint"])

    def test_columns_by_name_and_points_that_are_not_finite(self):
        (self.dir / "a.csv").write_text("id,Y,X,Z\n7,0,0,0.1\n8,0,1,0.2\n9,5,0,0.3\n10,,,\n")
        process = self.run_ok("sor", self.dir / "a.csv", "--neighbours", 2, "--sigmas", 100, "--out", self.dir / "b.xyz")
        self.assertIn("3 points of 4 kept (1 are not finite)", process.stdout)
        self.assertEqual((self.dir / "b.xyz").read_text(), "//X Y Z id\n0 0 0.1 7\n1 0 0.2 8\n0 5 0.3 9\n")

    def test_marks_for_no_data_are_no_ground(self):
        rows = "".join(f"{x} {y} {z}\n" for x, y, z in grid_points())
        (self.dir / "a.xyz").write_text(rows + "3.05 0.05 -9999\n3.25 0.05 1e12\n")
        process = self.run_ok("dem", self.dir / "a.xyz", "--resolution", 0.1, "--out", self.dir / "d.asc")
        self.assertIn("1 cells hold -9999 m", process.stderr)
        heights = [z for row in read_asc(self.dir / "d.asc")[1] for z in row if z is not None]
        self.assertEqual(min(heights), 0.0)
        self.assertLess(max(heights), 0.21)
        process = surefoot("stairs", self.dir / "a.xyz")  # regression: 1e12 used to crash
        self.assertEqual(process.returncode, 1)
        self.assertIn("none of its", process.stderr)


class Measure(CliTest):
    def scan(self, scene, *words):
        path = self.dir / f"{scene}.ply"
        self.run_ok("sim", scene, "--scan", path, "--set", "sim.laser.step_deg=0.2", *words)
        return path

    def test_the_demonstration_stairs(self):
        answer = self.json_of("measure", self.scan("demo_stairs"), "--box", "3,-0.55,5.5,0.55", "--histogram", self.dir / "h.svg")
        self.assertEqual(len(answer["riser"]["values_m"]), 3)
        self.assertAlmostEqual(answer["riser"]["mean_m"], 0.18, delta=0.0005)
        self.assertAlmostEqual(answer["going"]["mean_m"], 0.31, delta=0.005)
        self.assertAlmostEqual(answer["uphill_deg"], 0.0, delta=3.0)
        self.assertAlmostEqual(answer["levels"][0]["height_m"], 0.0, delta=0.0005)
        self.assertTrue((self.dir / "h.svg").read_text().startswith("<svg"))

    def test_a_door(self):
        steps = lambda low, high, step: [low + i * step for i in range(round((high - low) / step) + 1)]
        floor = [(x, y, 0.0) for x in steps(-1.0, 1.0, 0.02) for y in steps(-1.5, 1.5, 0.02)]
        wall = [(side, y, z) for side in (-0.06, 0.06) for y in steps(-1.5, 1.5, 0.02) if abs(y) > 0.45 for z in steps(0.0, 2.0, 0.02)]
        jambs = [(x, y, z) for x in steps(-0.06, 0.06, 0.02) for y in (-0.45, 0.45) for z in steps(0.0, 2.0, 0.02)]
        # Turned by 30 deg about (5, 2): the passage is not parallel to an axis.
        c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
        points = [(5 + c * x - s * y, 2 + s * x + c * y, z) for x, y, z in floor + wall + jambs]
        (self.dir / "door.ply").write_bytes(ply(points))
        answer = self.json_of("measure", self.dir / "door.ply", "--door", "5,2,30")
        self.assertAlmostEqual(answer["door"]["width_m"], 0.9, delta=0.001)
        beside = surefoot("measure", self.dir / "door.ply", "--door", f"{5 - c},{2 - s},30", "--json")
        self.assertIsNone(json.loads(beside.stdout)["door"]["width_m"])
        self.assertIn("has too few points within 3 m", beside.stderr)

    def test_nothing_to_measure(self):
        (self.dir / "noise.xyz").write_text("".join(f"{i % 7} {i % 11} {i % 13}\n" for i in range(200)))
        answer = self.json_of("measure", self.dir / "noise.xyz")
        self.assertEqual((answer["levels"], answer["riser"]["mean_m"], answer["uphill_deg"]), ([], None, None))
        (self.dir / "wide.ply").write_bytes(ply([(0, 0, 0), (90000, 90000, 90000)]))
        process = surefoot("measure", self.dir / "wide.ply")
        self.assertEqual(process.returncode, 2)
        self.assertIn("too large for voxels", process.stderr)
        for why, words in (("four finite numbers", ["--box", "1,2"]), ("contains no point of the cloud", ["--box", "90,90,99,99"]),
                           ("three finite numbers", ["--door", "1,2"]), ("no level surface", ["--door", "1,2,3"])):
            process = surefoot("measure", self.dir / "noise.xyz", *words)
            self.assertIn(process.returncode, (1, 2))
            self.assertIn(why, process.stderr)


class BadInput(CliTest):
    def refused(self, why, *words):
        before = {path: path.read_bytes() for path in self.dir.rglob("*") if path.is_file()}
        process = surefoot(*words)
        self.assertIn(process.returncode, (1, 2), process.stderr)
        sentences = [line for line in process.stderr.splitlines() if line.startswith("error")]
        self.assertEqual(len(sentences), 1, process.stderr)
        self.assertIn(why, sentences[0])
        self.assertEqual(before, {path: path.read_bytes() for path in self.dir.rglob("*") if path.is_file()}, "no new file")

    def test_a_sentence_each_and_nothing_left(self):
        points = grid_points()
        good = self.dir / "good.ply"
        good.write_bytes(ply(points))
        nan = float("nan")
        bad = {"empty.ply": (ply([]), "no point with finite"), "nan.ply": (ply([(nan, nan, nan)] * 5), "5 points in the file"),
               "cut.ply": (ply(points)[:-1], "truncated"), "head.ply": (ply(points).split(b"property")[0], "truncated"),
               "lies.ply": (ply(points).replace(b"vertex 400", b"vertex 4000000000"), "announces 4000000000 'vertex'"),
               "far.ply": (ply([*points, (1e30, 0, 0)]), "100 km"), "text.xyz": (b"1 2\n", "2 numbers"),
               "decimal.csv": (b"1,5;2,5;3,5\n1,5;2,5\n", "'1,5' has a decimal comma"), "nothing.las": (b"", "not a LAS file"),
               "what.dat": (b"x", "unknown cloud format '.dat'"), "packed.laz": (b"LASF", "pdal")}
        for name, (content, why) in bad.items():
            (self.dir / name).write_bytes(content)
        for name, (_, why) in bad.items():
            path = self.dir / name
            for words in (["voxel", path, "--size", 0.01, "--out", self.dir / "o.ply"], ["sor", path, "--out", self.dir / "o.ply"],
                          ["icp", good, path, "--out", self.dir / "o.ply"], ["icp", path, good],
                          ["eval", "clouds", path, good], ["eval", "clouds", good, path, "--values", self.dir / "o.csv"],
                          ["eval", "clouds", good, good, "--method", "m3c2", "--core", path]):
                self.refused(why, *words)

    def test_one_point_duplicates_and_noise_are_answered(self):
        one = self.dir / "one.ply"
        one.write_bytes(ply([(1.0, 2.0, 3.0)]))
        same = self.dir / "same.ply"
        same.write_bytes(ply([(1.0, 2.0, 3.0)] * 20000))
        for path, count in ((one, 1), (same, 20000)):
            self.assertEqual(self.json_of("sor", path, "--out", self.dir / "s.ply")["kept"], count)
            self.assertEqual(self.json_of("voxel", path, "--out", self.dir / "v.ply")["voxels"], 1)
            self.assertEqual(self.json_of("eval", "clouds", path, one)["max_m"], 0.0)
            process = surefoot("icp", path, one, "--json")
            self.assertEqual(process.returncode, 1)
            self.assertEqual(json.loads(process.stdout)["free_directions"], 6)
            self.assertIn("no pair of points can be used", process.stderr)

    def test_200_000_equal_points_are_as_fast_as_others(self):
        same = self.dir / "same.ply"
        same.write_bytes(ply([(1.0, 2.0, 3.0)] * 200000))
        self.assertEqual(self.json_of("sor", same, "--out", self.dir / "s.ply")["kept"], 200000)
        self.assertEqual(self.json_of("eval", "clouds", same, same)["max_m"], 0.0)
        answer = self.json_of("eval", "clouds", same, same, "--method", "m3c2", "--set", "eval.m3c2.normals=vertical")
        self.assertEqual((answer["count"], answer["p99_m"]), (200000, 0.0))
        self.assertEqual(surefoot("icp", same, same).returncode, 1)

    def test_five_points_are_no_alignment(self):
        points = [(87.7, 242.5, 820.5), (596.1, 96.4, 443.5), (490.5, 163.6, 752.2), (116.4, 400.6, 529.1), (441.0, 600.9, 755.5)]
        (self.dir / "a.ply").write_bytes(ply(points))
        (self.dir / "b.ply").write_bytes(ply([(x + 0.7, y, z) for x, y, z in points]))
        process = surefoot("icp", self.dir / "a.ply", self.dir / "b.ply", "--json")
        self.assertEqual(process.returncode, 1)
        answer = json.loads(process.stdout)
        self.assertEqual((answer["converged"], answer["outcome"]), (False, "too_few_points"))
        self.assertIn("too few points", process.stderr)

    def test_clouds_apart_are_no_alignment(self):
        floor = lambda x0: [(x0 + 0.05 * (i % 40), 0.05 * (i // 40), 0.001 * (i * 7 % 5)) for i in range(1600)]
        (self.dir / "a.ply").write_bytes(ply(floor(0.0)))
        (self.dir / "b.ply").write_bytes(ply(floor(100.0)))
        process = surefoot("icp", self.dir / "a.ply", self.dir / "b.ply", "--json")
        self.assertEqual(process.returncode, 1)
        answer = json.loads(process.stdout)
        self.assertEqual((answer["converged"], answer["outcome"], answer["overlap"]), (False, "no_overlap", 0.0))
        self.assertIn("do not overlap", process.stderr)

    def test_the_sigma_of_a_lattice_covers_its_error(self):
        """Four levels (two by two), points 50 mm apart, rotated by 2 deg; nearest points alone give only 1.5 deg."""
        turn = math.radians(2.0)
        points = [(0.05 * i, 0.05 * k, (0.2 if i > 20 else 0.0) + (0.3 if k > 26 else 0.0)) for k in range(40) for i in range(40)]
        moved = [(0.065 + math.cos(turn) * x - math.sin(turn) * y, -0.053 + math.sin(turn) * x + math.cos(turn) * y, 0.01 + z)
                 for x, y, z in points]
        (self.dir / "a.ply").write_bytes(ply(points))
        (self.dir / "b.ply").write_bytes(ply(moved))
        answer = self.json_of("icp", self.dir / "a.ply", self.dir / "b.ply")
        row = answer["T_reference_moved"]
        yaw_deg = math.degrees(math.atan2(row[1][0], row[0][0]))
        self.assertLess(abs(yaw_deg + 2.0), 2.0 * answer["sigma_deg"])
        self.assertLess(answer["sigma_deg"], 3.0)
        self.assertGreater(answer["edge_directions"] + answer["border_directions"], 0)

    def test_wrong_calls(self):
        good = self.dir / "good.ply"
        good.write_bytes(ply(grid_points()))
        for why, words in (("there is no", ["sor", good, "--neighbors", 3, "--out", self.dir / "o.ply"]),
                           ("--neighbours", ["sor", good, "--neighbours", 1, "--out", self.dir / "o.ply"]),
                           ("not '.las'", ["voxel", good, "--out", self.dir / "o.las"]),
                           ("--guess", ["icp", good, good, "--guess", "1,2"]),
                           ("m3c2 only", ["eval", "clouds", good, good, "--core", good]),
                           ("too large for voxels", ["voxel", good, "--size", "1e-5", "--out", self.dir / "o.ply"])):
            if why == "too large for voxels":
                (self.dir / "wide.ply").write_bytes(ply([(0, 0, 0), (90000, 90000, 90000)]))
                words[1] = self.dir / "wide.ply"
            self.refused(why, *words)


if __name__ == "__main__":
    unittest.main()
