"""`rate` and `fuse` reproduce the reference vectors of tests/conformance (see the ref.json of each)."""
import array
import json
import math
import unittest

from surefoot_cli import ROOT, CliTest, read_asc

TOLERANCE = 1e-5
VECTORS = ROOT / "tests" / "conformance"


def read_f32(path):
    values = array.array("f")
    values.frombytes(path.read_bytes())
    return values


def in_reference_order(rows):
    """Converts ESRI rows (largest y first, x grows) to the reference's order: rows by falling x, columns by falling y."""
    height, width = len(rows), len(rows[0])
    return [rows[column][width - 1 - row] for row in range(width) for column in range(height)]


def esri_text(values, side, cell, low):
    """Writes values in the reference's order as an ESRI grid with 9 significant digits."""
    lines = [f"ncols {side}", f"nrows {side}", f"xllcorner {low}", f"yllcorner {low}", f"cellsize {cell}",
             "NODATA_value -9999"]
    for column in range(side):
        lines.append(" ".join("-9999" if math.isnan(v) else f"{v:.9g}"
                              for v in (values[(side - 1 - ix) * side + column] for ix in range(side))))
    return "\n".join(lines) + "\n"


class Conformance(CliTest):
    def compare(self, name, rows, expected, relative=False):
        found = in_reference_order(rows)
        self.assertEqual(len(found), len(expected), name)
        worst = 0.0
        for index, (value, truth) in enumerate(zip(found, expected)):
            if math.isnan(truth) or value is None:
                self.assertTrue(value is None and math.isnan(truth), f"{name}[{index}]: {value}, expected {truth}")
                continue
            if math.isinf(truth):
                self.assertEqual(value, truth, f"{name}[{index}]")
                continue
            error = abs(value - truth)
            if relative and truth != 0.0:
                error /= abs(truth)
            worst = max(worst, error)
        print(f"{name}: largest difference {worst:.2g}")
        self.assertLessEqual(worst, TOLERANCE, name)

    def rated(self, combine):
        folder = VECTORS / "traversability"
        reference = json.loads((folder / "ref.json").read_text())
        p = reference["sets"]["tiefree"]
        dem = self.dir / "dem.asc"
        dem.write_text(esri_text(read_f32(folder / "elevation.f32"), reference["rows"], reference["resolution_m"], -3))
        settings = {"normals.radius_m": p["normals_radius"], "slope.critical_rad": p["slope_critical"],
                    "step.critical_m": p["step_critical"], "step.first_radius_m": p["step_r1"],
                    "step.second_radius_m": p["step_r2"], "step.critical_cells": p["step_cells"],
                    "roughness.critical_m": p["roughness_critical"], "roughness.radius_m": p["roughness_radius"],
                    "weights.slope": 1, "weights.step": 1, "weights.roughness": 1, "combine": combine}
        arguments = [f"--set=traversability.{key}={value}" for key, value in settings.items()]
        out = self.dir / combine
        self.run_ok("rate", dem, "--out", out, *arguments)
        return out, folder / "tiefree"

    def test_rate_reproduces_every_layer(self):
        out, reference = self.rated("mean_nan")
        for layer, file in (("normal_x", "surface_normal_x"), ("normal_y", "surface_normal_y"),
                            ("normal_z", "surface_normal_z"), ("slope", "traversability_slope"),
                            ("step", "traversability_step"), ("roughness", "traversability_roughness"),
                            ("traversability", "traversability")):
            self.compare(layer, read_asc(out / f"{layer}.asc")[1], read_f32(reference / f"{file}.f32"))

    def test_rate_reproduces_the_zero_rule(self):
        out, reference = self.rated("zero_dominates")
        self.compare("traversability, zero rule", read_asc(out / "traversability.asc")[1],
                     read_f32(reference / "traversability_weightedsum2017.f32"))

    def test_fuse_reproduces_every_step(self):
        folder = VECTORS / "elevation"
        out = self.dir / "fused"
        self.run_ok("fuse", folder / "steps.txt", "--preset", "ethz", "--out", out)
        for step in range(3):
            for layer in ("elevation", "variance", "time"):
                self.compare(f"step{step} {layer}", read_asc(out / f"step{step}_{layer}.asc")[1],
                             read_f32(folder / f"step{step}_{layer}.f32"), relative=True)


if __name__ == "__main__":
    unittest.main()
