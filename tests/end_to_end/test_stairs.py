"""`stairs` and stairs.json: flights, drops and kerbs of maps with exactly known steps."""
import json
import math
import re
import unittest

from surefoot_cli import CliTest, png_of, read_asc, surefoot

NAMES = {
    "flights": "kind steps riser_m riser_std_m riser_spread_m going_m going_std_m going_spread_m width_m landing_m "
               "turn_rad cut open left right pose log10_step_ratio",
    "drops": "pose height_m length_m sigma_m bottom_seen log10_step_ratio",
    "kerbs": "kind pose height_m length_m sigma_m bottom_seen log10_step_ratio",
    "sills": "pose height_m length_m sigma_m bottom_seen log10_step_ratio",
    "doors": "width_m width_std_m sill_m clearance_m pose",
    "edges": "from to upper_m lower_m lower_seen sigma_m log10_step_ratio",
}
CLASSES = "unknown floor tread riser ramp kerb sill drop wall table tunnel".split()
CELL_M = 0.025
RISER_M, GOING_CELLS = 0.17, 12  # 0.30 m
STEPS = 4


def height_of_stairs(x_cell, up=True, begin=60):
    """Height of steps along x that begin at cell `begin`."""
    step = min(max((x_cell - begin) // GOING_CELLS + 1, 0), STEPS)
    return (1 if up else -1) * step * RISER_M


def tread_cells(path, largest_x_m):
    """Cells (column, row) of a tread up to a given x."""
    header, rows = read_asc(path)
    columns = round((largest_x_m - header["xllcorner"]) / header["cellsize"])
    return {(u, v) for v, row in enumerate(rows) for u, value in enumerate(row[:columns]) if value is not None}


def write_grid(path, height_of, nx=160, ny=60, x0=0.0, y0=0.0, cell=CELL_M):
    """Writes an ESRI grid of height_of(ix, iy); None = unknown."""
    rows = []
    for iy in reversed(range(ny)):
        heights = [height_of(ix, iy) for ix in range(nx)]
        rows.append(" ".join("-9999" if z is None else f"{z:.4f}" for z in heights))
    path.write_text(f"ncols {nx}\nnrows {ny}\nxllcorner {x0}\nyllcorner {y0}\ncellsize {cell}\nNODATA_value -9999\n" +
                    "\n".join(rows) + "\n")
    return path


class Stairs(CliTest):
    def check_names(self, answer, of_run=False):
        self.assertEqual(list(answer), [*NAMES, "classes", "assumed", "gravity_source", *["unconfirmed"][:of_run]])
        self.assertEqual(list(answer["classes"]), CLASSES)
        gravity = ["gravity_assumed"] if answer["gravity_source"] == "assumed" else []
        followed = ["id", "observations", "last_seen_s", "in_final_map"] if of_run else []
        for kind, names in NAMES.items():
            for thing in answer[kind]:
                self.assertEqual(set(thing), {*names.split(), *followed, *gravity}, kind)
                self.assertEqual(len(thing.get("pose", [0] * 4)), 4)
                if of_run:
                    self.assertGreaterEqual(thing["observations"], 2, "a feature of one frame is not confirmed")
            for thing in answer["unconfirmed"][kind] if of_run else []:
                self.assertLess(thing["observations"], 2)
                self.assertIn("in_final_map", thing)

    def fails(self, code, *call):
        """Returns the only message of a failing call."""
        process = surefoot("stairs", *call)
        self.assertEqual(process.returncode, code, f"{call}\n{process.stdout}\n{process.stderr}")
        self.assertEqual(process.stdout, "")
        return process.stderr

    def test_steps_up_are_measured_exactly(self):
        file = write_grid(self.dir / "up.asc", lambda ix, iy: height_of_stairs(ix), y0=-0.75)
        answer = self.json_of("stairs", file, "--out", self.dir / "out")
        self.check_names(answer)
        self.assertEqual(len(answer["flights"]), 1, answer)
        flight = answer["flights"][0]
        print(f"steps up: {flight}")
        self.assertEqual((flight["kind"], flight["steps"]), ("up", STEPS))
        self.assertAlmostEqual(flight["riser_m"], RISER_M, delta=1e-3)
        self.assertAlmostEqual(flight["going_m"], GOING_CELLS * CELL_M, delta=2e-3)
        self.assertLess(flight["riser_spread_m"], 2e-3)
        self.assertLess(flight["going_spread_m"], 5e-3)
        self.assertAlmostEqual(flight["width_m"], 1.5, delta=0.1)
        self.assertAlmostEqual(flight["turn_rad"], 0.0, delta=0.02)
        x, y, z, yaw = flight["pose"]
        self.assertAlmostEqual(x, 60 * CELL_M, delta=0.5 * CELL_M)
        self.assertAlmostEqual(y, 0.0, delta=0.05)
        self.assertAlmostEqual(z, 0.0, delta=1e-3)
        self.assertAlmostEqual(yaw, 0.0, delta=0.02)
        self.assertEqual(answer["drops"], [])
        self.assertEqual(len(answer["edges"]), STEPS)
        self.assertTrue(any("origin (0, 0)" in line for line in answer["assumed"]), answer["assumed"])
        self.assertTrue(any("exact" in line for line in answer["assumed"]), answer["assumed"])
        self.assertEqual(json.loads((self.dir / "out" / "stairs.json").read_text()), answer)
        for picture in ("stairs.png", "classes.png"):
            self.assertTrue((self.dir / "out" / picture).read_bytes().startswith(b"\x89PNG"))
        self.assertTrue((self.dir / "out" / "config.yaml").exists())
        page = (self.dir / "out" / "report.html").read_text()
        self.assertTrue(f"flight up, {STEPS} steps" in page, "the table lacks the flight")
        self.assertEqual(page.count("data:image/png;base64,"), 2)
        cells = {name: of["cells"] for name, of in answer["classes"].items()}
        print(f"cells: {cells}")
        self.assertEqual(sum(cells.values()), 160 * 60)
        self.assertEqual(cells["tread"] + cells["riser"], (3 * GOING_CELLS + 1) * 60)
        self.assertEqual(cells["floor"], 160 * 60 - cells["tread"] - cells["riser"])
        self.assertAlmostEqual(answer["classes"]["floor"]["area_m2"], cells["floor"] * CELL_M**2, delta=1e-9)
        # Each tread's cells have its level. No written file contains the measured heights.
        lines = (self.dir / "out" / "treads.asc").read_text().splitlines()
        levels = [float(z) for line in lines if re.match(r"^-?[\d.]+ ", line) for z in line.split()]
        self.assertEqual(len(levels), 160 * 60)
        found = sorted({round(z, 3) for z in levels if z > -9000})
        self.assertEqual(found, [RISER_M, 2 * RISER_M, round(3 * RISER_M, 3)])

    def test_a_smooth_slope_is_no_stair_and_gravity_that_was_assumed_is_said(self):
        for slope_deg in (22, 26, 30):
            rise = CELL_M * math.tan(math.radians(slope_deg))
            file = write_grid(self.dir / "slope.asc", lambda ix, iy: max(0, ix - 32) * rise, nx=120, y0=-0.75)
            answer = self.json_of("stairs", file, "--from", "0.1,0", "--out", self.dir / "out")
            self.check_names(answer)
            self.assertEqual((answer["flights"], answer["kerbs"]), ([], []), slope_deg)
            self.assertEqual(answer["gravity_source"], "assumed")
            self.assertIn("gravity was assumed", (self.dir / "out" / "report.html").read_text())

    def test_the_same_steps_from_above_go_down_and_begin_with_a_drop(self):
        file = write_grid(self.dir / "up.asc", lambda ix, iy: height_of_stairs(ix), y0=-0.75)
        answer = self.json_of("stairs", file, "--from", "3.5,0")
        flight = answer["flights"][0]
        print(f"steps down: {flight}")
        self.assertEqual((flight["kind"], flight["steps"]), ("down", STEPS))
        self.assertAlmostEqual(flight["riser_m"], RISER_M, delta=1e-3)
        self.assertAlmostEqual(flight["going_m"], GOING_CELLS * CELL_M, delta=2e-3)
        x, _, z, yaw = flight["pose"]
        self.assertAlmostEqual(x, (60 + 3 * GOING_CELLS) * CELL_M, delta=0.5 * CELL_M)
        self.assertAlmostEqual(z, STEPS * RISER_M, delta=1e-3)
        self.assertAlmostEqual(abs(yaw), math.pi, delta=0.02)
        self.assertEqual(len(answer["drops"]), 1)
        self.assertAlmostEqual(answer["drops"][0]["height_m"], RISER_M, delta=1e-3)
        self.assertEqual(answer["drops"][0]["pose"][:2], flight["pose"][:2])

    def test_kerbs_and_drops_have_positive_heights(self):
        # A kerb of 0.12 m up at x = 1.5 m, then a platform that ends 0.5 m above the ground at x = 3 m.
        def height(ix, iy):
            return 0.0 if ix < 60 else 0.12 if ix < 120 else -0.38
        answer = self.json_of("stairs", write_grid(self.dir / "kerb.asc", height, y0=-0.75), "--from", "2.2,0")
        self.check_names(answer)
        kerbs = [(kerb["kind"], round(kerb["height_m"], 3)) for kerb in answer["kerbs"]]
        self.assertEqual(kerbs, [("down", 0.12)], answer)
        drops = sorted(round(drop["height_m"], 3) for drop in answer["drops"])
        self.assertEqual(drops, [0.12, 0.5], answer)
        for drop in answer["drops"]:
            self.assertEqual(drop["bottom_seen"], True)
            self.assertAlmostEqual(drop["pose"][2], 0.12, delta=1e-3)

    def test_a_height_image_a_cloud_and_a_grid_agree(self):
        write_grid(self.dir / "up.asc", lambda ix, iy: height_of_stairs(ix))
        # Rows of an image go from the largest y down; grey 255 is 0.68 m.
        image = [[round(255 * height_of_stairs(ix) / 0.68) for ix in range(160)] for _ in range(60)]
        (self.dir / "up.png").write_bytes(png_of(image))
        points = [f"{(ix + 0.5) * CELL_M:.4f} {(iy + 0.5) * CELL_M:.4f} {share * height_of_stairs(ix):.4f}"
                  for iy in range(60) for ix in range(160) for share in (1.0, 1.0, 1.0, 0.75)]  # one of four is a flying pixel
        (self.dir / "up.xyz").write_text("\n".join(points) + "\n")
        grid = self.json_of("stairs", self.dir / "up.asc")
        image = self.json_of("stairs", self.dir / "up.png", "--scale", CELL_M, "--height", 0.68)
        cloud = self.json_of("stairs", self.dir / "up.xyz")
        coarse = self.json_of("stairs", self.dir / "up.xyz", "--resolution", 0.05)
        for answer, word in ((image, "image"), (cloud, "cloud"), (coarse, "cloud")):
            self.assertTrue(any(word in line for line in answer["assumed"]), answer["assumed"])
            self.assertEqual([(f["kind"], f["steps"]) for f in answer["flights"]], [("up", STEPS)])
        for answer in (image, cloud):
            for name in ("riser_m", "going_m", "width_m"):
                self.assertAlmostEqual(answer["flights"][0][name], grid["flights"][0][name], delta=1e-3, msg=name)

    def test_where_one_stands_is_told_or_said(self):
        stance = lambda answer: [line for line in answer["assumed"] if "stands" in line]
        around = write_grid(self.dir / "around.asc", lambda ix, iy: 0.0, nx=80, ny=80, x0=-1, y0=-1)
        away = write_grid(self.dir / "away.asc", lambda ix, iy: None if ix < 3 else 0.0, nx=80, ny=80, x0=5, y0=4)
        self.assertIn("origin (0, 0)", stance(self.json_of("stairs", around))[0])
        self.assertRegex(stance(self.json_of("stairs", away))[0], r"\(5\.08[78], 4\.98[78]\): the known cell nearest")
        self.assertEqual(stance(self.json_of("stairs", away, "--from", "6,5")), [])
        hole = write_grid(self.dir / "hole.asc", lambda ix, iy: None if 38 < ix < 42 else 0.0, nx=80, ny=80, x0=-1, y0=-1)
        self.assertIn("border", stance(self.json_of("stairs", hole))[0])

    def test_flat_ground_is_an_answer_without_anything(self):
        flat = write_grid(self.dir / "flat.asc", lambda ix, iy: 0.25)
        answer = self.json_of("stairs", flat, "--out", self.dir / "flat")
        self.assertEqual({kind: answer[kind] for kind in NAMES}, {kind: [] for kind in NAMES})
        self.assertEqual(answer["classes"]["floor"]["cells"], 160 * 60)
        text = self.run_ok("stairs", flat).stdout
        self.assertIn("no flight, no drop, no kerb, no sill, no door; no edge", text)

    def test_the_text_names_each_thing_with_its_measures(self):
        file = write_grid(self.dir / "up.asc", lambda ix, iy: height_of_stairs(ix), y0=-0.75)
        text = self.run_ok("stairs", file).stdout
        self.assertRegex(text, r"(?m)^flight up, 4 steps: 1(70|69|71)(\.\d)? \+- [\d.]+ mm by (300|299|301)(\.\d)? "
                               r"\+- [\d.]+ mm, 1\.\d\d m wide at \(1\.5")
        self.assertIn("1 flight, no drop", text)
        self.assertIn("assumed: ", text)

    def test_what_is_no_map_is_a_sentence(self):
        self.assertIn("cannot", self.fails(1, self.dir / "nowhere.asc"))
        unknown = write_grid(self.dir / "unknown.asc", lambda ix, iy: None, nx=5, ny=4)
        self.assertIn("none of its 5 x 4 cells is known", self.fails(1, unknown))
        one = write_grid(self.dir / "one.asc", lambda ix, iy: 0.0, nx=1, ny=1)
        self.assertIn("1 x 1 cells; an edge needs at least 2 x 2", self.fails(1, one))
        row = write_grid(self.dir / "row.asc", lambda ix, iy: 0.0, nx=9, ny=1)
        self.assertIn("9 x 1 cells", self.fails(1, row))
        (self.dir / "grey.png").write_bytes(png_of([[7] * 9] * 9))
        self.assertIn("needs --scale (side of a pixel, in m) and --height", self.fails(2, self.dir / "grey.png"))
        self.assertIn("--scale", self.fails(2, self.dir / "grey.png", "--scale", 0.02))
        self.assertIn("has no elevation.asc", self.fails(1, self.dir))
        (self.dir / "empty.xyz").write_text("# nothing\n")
        self.assertIn("empty.xyz", self.fails(1, self.dir / "empty.xyz"))
        flat = write_grid(self.dir / "flat.asc", lambda ix, iy: 0.0, nx=40, ny=40)
        self.assertIn("outside the map, which extends from (0, 0) to (1, 1) m", self.fails(2, flat, "--from", "3,0"))
        for wrong in ("1", "1,2,3", "a,b", "nan,0"):
            self.assertIn("two finite numbers separated by commas: x,y (m)", self.fails(2, flat, "--from", wrong))
        self.assertIn("stairs.min_riser_m", self.fails(2, flat, "--set", "stairs.min_riser_m=0.5"))
        (self.dir / "file").write_text("x")
        self.assertIn("file", self.fails(1, flat, "--out", self.dir / "file"))

    def test_layers_that_do_not_belong_together_are_a_sentence(self):
        folder = self.dir / "run"
        folder.mkdir()
        write_grid(folder / "elevation.asc", lambda ix, iy: 0.0, nx=40, ny=40)
        write_grid(folder / "variance.asc", lambda ix, iy: 1e-6, nx=40, ny=41)
        self.assertRegex(self.fails(1, folder), r"variance\.asc: the layer has 40 x 41 cells .* height map in the same folder has 40 x 40")

    def test_what_a_folder_lacks_is_assumed(self):
        folder = self.dir / "run"
        folder.mkdir()
        write_grid(folder / "elevation.asc", lambda ix, iy: height_of_stairs(ix), y0=-0.75)
        assumed = " ".join(self.json_of("stairs", folder)["assumed"])
        for name in ("variance.asc", "free_above.asc", "clearance.asc", "density_ratio.asc", "count.asc"):
            self.assertIn(name, assumed)
        # With a sigma far larger than the edges, no edge is significant.
        write_grid(folder / "variance.asc", lambda ix, iy: 1.0, y0=-0.75)
        answer = self.json_of("stairs", folder)
        self.assertNotIn("variance.asc", " ".join(answer["assumed"]))
        self.assertEqual(answer["flights"], [])

    def test_layers_of_an_earlier_run_are_not_taken_for_those_of_this_one(self):
        out = self.dir / "out"
        walk = ("run", "sim:room", "--set", "sim.sensor=analytic", "--out", out)
        self.run_ok(*walk, "--max-frames", 14, "--layers")
        layers = {path.name for path in out.glob("*.asc")}
        self.assertIn("free_above.asc", layers)
        self.run_ok(*walk, "--max-frames", 12)
        left = {path.name for path in out.glob("*.asc")}
        self.assertEqual(left, {"elevation.asc", "ground.asc", "variance.asc", "traversability.asc", "treads.asc"})
        self.assertIn("no free_above.asc", " ".join(self.json_of("stairs", out)["assumed"]))

    def test_the_folder_of_a_run_says_about_the_same_as_the_run(self):
        # They may differ slightly: the run tracks its features and also uses the last observation.
        out = self.dir / "out"
        run = self.json_of("run", "sim:stairs_up_ada", "--set", "sim.sensor=analytic", "--max-frames", 60, "--layers",
                           "--out", out)
        self.assertTrue(run["complete"])
        of_run = json.loads((out / "stairs.json").read_text())
        self.check_names(of_run, of_run=True)
        self.assertGreater(of_run["flights"][0]["observations"], 1)
        self.assertEqual(of_run["flights"][0]["last_seen_s"], 0.0)
        again = self.json_of("stairs", out, "--out", self.dir / "again")
        self.check_names(again)
        self.assertEqual(of_run["gravity_source"], run["gravity_source"])
        self.assertEqual(again["gravity_source"], run["gravity_source"])
        for kind in NAMES:  # both results describe the same map
            in_map = sum(thing["in_final_map"] for thing in of_run[kind] + of_run["unconfirmed"][kind])
            self.assertEqual(in_map, len(again[kind]), kind)
        self.assertTrue(any("base_link of map.snapshot" in line for line in again["assumed"]), again["assumed"])
        print(f"run: {[(f['kind'], f['steps'], f['riser_m'], f['going_m']) for f in of_run['flights']]}")
        self.assertTrue(of_run["flights"], of_run)
        print(f"run: {of_run['classes']}")
        self.assertGreater(of_run["classes"]["tread"]["cells"], 100)
        self.assertGreater(of_run["classes"]["floor"]["cells"], 1000)
        floor = of_run["classes"]["floor"]["cells"]
        self.assertAlmostEqual(again["classes"]["floor"]["cells"], floor, delta=0.01 * floor)
        # One observation labels the near treads; the run has tracked those behind them.
        near_m = of_run["flights"][0]["pose"][0] + 2.3 * of_run["flights"][0]["going_m"]
        followed, looked = (tread_cells(folder / "treads.asc", near_m) for folder in (out, self.dir / "again"))
        self.assertGreater(len(followed & looked), 500)
        self.assertLess(len(followed ^ looked), 0.02 * len(followed & looked))
        for file in ("treads.asc", "classes.png"):
            self.assertTrue((out / file).exists(), file)
        one, other = again["flights"][0], of_run["flights"][0]
        self.assertEqual((one["kind"], one["steps"]), (other["kind"], other["steps"]))
        self.assertAlmostEqual(one["riser_m"], other["riser_m"], delta=3e-3)
        self.assertAlmostEqual(one["going_m"], other["going_m"], delta=8e-3)
        self.assertAlmostEqual(one["pose"][0], other["pose"][0], delta=0.01)
        report = (out / "report.html").read_text()
        section = report[report.index("<h2>Edges and stairs</h2>"):]
        section = section[:section.index("</section>")]
        self.assertIn("data:image/png;base64,", section)
        self.assertRegex(section, r"<td>(flight|step) up, \d+ steps?</td>")
        self.assertTrue((out / "stairs.png").read_bytes().startswith(b"\x89PNG"))

    def test_a_run_that_finds_nothing_writes_empty_lists(self):
        out = self.dir / "out"
        out.mkdir()
        (out / "stairs.json").write_text("of an earlier run")
        self.run_ok("run", "sim:floor", "--set", "sim.sensor=analytic", "--max-frames", 3, "--out", out)
        answer = json.loads((out / "stairs.json").read_text())
        self.check_names(answer, of_run=True)
        self.assertEqual({kind: answer[kind] for kind in NAMES}, {kind: [] for kind in NAMES})
        self.assertEqual(answer["assumed"], [])

    def test_height_images_of_others(self):
        """Images of elevation_mapping_cupy: three steps of 0.2 m, each eight pixels long, a slope, holes."""
        folder = self.data("terrain")
        flights = {}
        for image in sorted(folder.glob("*.png")):
            name = re.search(r"(\d+)cm", image.name)
            height_m = 0.01 * float(name.group(1)) if name else 1.0
            answer = self.json_of("stairs", image, "--scale", 0.02, "--height", height_m)
            self.check_names(answer)
            print(f"{image.name}: {[(f['kind'], f['steps'], f['riser_m'], f['going_m']) for f in answer['flights']]}, "
                  f"{len(answer['drops'])} drops, {len(answer['kerbs'])} kerbs, {len(answer['edges'])} edges")
            flights[image.name] = answer["flights"]
        stairs, = flights["straight_stairs_1m_1m_60cm.png"]
        self.assertEqual((stairs["kind"], stairs["steps"]), ("up", 3))
        self.assertAlmostEqual(stairs["riser_m"], 0.2, delta=1e-3)
        self.assertAlmostEqual(stairs["going_m"], 0.16, delta=1e-3)

    def test_scanned_block_steps(self):
        cloud = self.data("terrain", "lidar_steps.ply")
        answer = self.json_of("stairs", cloud, "--from", "0,0", "--out", self.dir / "out")
        self.check_names(answer)
        print(f"lidar_steps: {len(answer['flights'])} flights, {len(answer['drops'])} drops, "
              f"{len(answer['kerbs'])} kerbs, {len(answer['edges'])} edges")
        self.assertGreater(len(answer["edges"]), 5)


if __name__ == "__main__":
    unittest.main()
