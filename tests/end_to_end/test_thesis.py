"""Small versions of the experiments of the reference thesis (Lange 2016), and laser scans in tiles."""
import csv
import json
import unittest

from surefoot_cli import CliTest, read_asc, surefoot

SMALL = ["--runs", "demo_stairs_trolley", "--frames", 40, "--set", "sim.laser.step_deg=0.2"]


def without_speed(answer):
    """Removes values that depend on the speed of the computer."""
    for columns in answer["runs"].values():
        for figures in columns.values():
            figures.pop("update_hz")
    return [row for row in answer["rows"] if row["figure"] != "update_hz"], answer["runs"], answer["scans"]


class Thesis(CliTest):
    def suite(self, *more, timeout=240):
        return self.json_of("eval", "suite", "--lange2016", *SMALL, *more, "--out", self.dir / "thesis", timeout=timeout)

    def test_a_part_of_the_report(self):
        answer = self.suite("--threads", 2)
        out = self.dir / "thesis"
        self.assertEqual(answer["failures"], [])
        rows = {row["figure"]: row for row in answer["rows"]}
        riser = rows["riser_m"]
        self.assertEqual(riser["exact"], 0.18)
        self.assertAlmostEqual(riser["scan"], 0.18, delta=0.0005)
        self.assertAlmostEqual(riser["ours"], 0.18, delta=0.006)
        self.assertEqual(riser["thesis"], "150 +- 50")
        columns = answer["runs"]["demo_stairs_trolley"]
        # Forty frames are the first four seconds: near floor, and distant stairs.
        self.assertEqual(columns["ours"]["frames"], 40)
        self.assertLess(columns["ours"]["floor_spread_m"], columns["thesis_settings"]["floor_spread_m"])
        self.assertLess(columns["ours"]["m3c2_p50_m"], 0.004)
        self.assertGreater(answer["scans"]["thesis_i_demo_stairs"]["points_kept"], 100_000)
        print(f"thesis: riser {1e3 * riser['ours']:.1f} mm, its settings {1e3 * (riser['thesis_settings'] or 0):.1f} mm, "
              f"scan {1e3 * riser['scan']:.1f} mm")

        self.assertEqual(len(answer["datasets"]), 13)
        for place in answer["datasets"]:
            self.assertGreaterEqual(place["objects"], 30, place)
            self.assertGreater(place["points"], 0.6e6 * place["thesis_million_points"], place)
        with open(out / "thesis.csv", newline="") as file:
            self.assertEqual([row["figure"] for row in csv.DictReader(file)], [row["figure"] for row in answer["rows"]])
        page = (out / "thesis.html").read_text()
        self.assertGreater(page.count("data:image/png"), 8)
        self.assertNotIn("<script", page)
        for column in ("ours", "thesis_settings"):
            for name in ("camera.png", "confusion.png", "m3c2.png", "heights.svg"):
                self.assertTrue((out / "runs/demo_stairs_trolley" / column / name).stat().st_size > 1000, name)
        self.assertEqual(json.loads((out / "thesis.json").read_text()), answer)
        heights = read_asc(out / "scans/thesis_i_demo_stairs/elevation.asc")
        self.assertGreater(len(heights), 0)

        # Finished parts are not computed again; lost parts are, with the same figures.
        self.assertEqual(self.suite(timeout=60), answer)
        before = without_speed(answer)
        (out / "runs/demo_stairs_trolley/ours/figures.csv").unlink()
        self.assertEqual(without_speed(self.suite("--threads", 1)), before)

    def test_wrong_calls_are_told(self):
        process = surefoot("eval", "suite", "--lange2016", "--runs", "demo_stair_trolley", "--out", self.dir / "x")
        self.assertEqual(process.returncode, 2)
        self.assertIn("did you mean 'demo_stairs_trolley'?", process.stderr)
        process = surefoot("eval", "suite", "--runs", "flat_rex", "--out", self.dir / "x")
        self.assertEqual(process.returncode, 2)
        (self.dir / "thesis/scans/thesis_i_demo_stairs").mkdir(parents=True)
        (self.dir / "thesis/scans/thesis_i_demo_stairs/figures.csv").write_text("riser,1\n")
        process = surefoot("eval", "suite", "--lange2016", *SMALL, "--out", self.dir / "thesis")
        self.assertEqual(process.returncode, 1)
        self.assertIn("figures.csv: 'riser,1' is not a line of a figures file", process.stderr)


class Tiles(CliTest):
    SCAN = ["sim", "thesis_l_reception", "--set", "sim.laser.step_deg=0.5"]

    def points_of(self, path):
        """Number of points and their bounding box."""
        answer = self.json_of("eval", "clouds", path, path)
        return answer["count"]

    def test_tiles_hold_what_one_file_holds(self):
        whole = self.json_of(*self.SCAN, "--scan", self.dir / "whole.ply")
        for kind in ("ply", "pcd"):
            folder = self.dir / kind
            told = self.json_of(*self.SCAN, "--scan", folder, "--tile", 4, "--tile-format", kind)
            self.assertEqual(told["points"], whole["points"])
            index = json.loads((folder / "index.json").read_text())
            self.assertEqual((index["points"], index["complete"]), (whole["points"], True))
            self.assertEqual(len(index["stations_m"]), whole["stations"])
            self.assertEqual(sorted(path.name for path in folder.glob("tile_*")), sorted(t["file"] for t in index["tiles"]))
            self.assertEqual(sum(t["points"] for t in index["tiles"]), whole["points"])
            self.assertEqual(told["tiles"], 8, "11 m by 8 m, from (-2.5, -4) on")
            for tile in index["tiles"]:
                self.assertEqual(self.points_of(folder / tile["file"]), tile["points"], tile)

    def test_an_index_is_there_only_of_a_whole_folder(self):
        folder = self.dir / "tiles"
        folder.mkdir()
        (folder / "index.json").write_text("{}")
        process = surefoot("sim", "thesis_d_courtyard", "--set", "sim.laser.step_deg=1", "--scan", folder, "--tile", 0.5)
        self.assertEqual(process.returncode, 2)
        self.assertIn("more than 500 tiles; use larger tiles", process.stderr)
        self.assertFalse((folder / "index.json").read_text() == "{}")


if __name__ == "__main__":
    unittest.main()
