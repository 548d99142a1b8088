"""Finds open floor, edges and block tops of a height map from its heights alone, and evaluates their ratings.

Nothing is fitted to the ratings, and no height is given: the floor is the most common height, the noise is that of the
floor, and the definition of an edge and the reach of the filters come from the configuration of the run.

* noise: 1.4826 times the median difference from the median of the floor's neighbours, over sqrt(2);
* floor: cells within 5 sigma of the plane through the most common height (fitted repeatedly to its own cells);
* edge: a cell beside one (of eight) that is at least `step.critical_m` higher or lower: more than an impassable
  step within one cell;
* open floor: floor cells with only floor within the reach of the filters;
* flat top: a cell at least the critical step above the floor, with half of the cells within the reach of the filters
  known and all of these within 5 sigma of one plane; level if that plane leans at most LEVEL_DEG.
"""
import math
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "end_to_end"))
from surefoot_cli import read_asc  # noqa: E402

LEVEL_DEG = 8.0


def read_grid(path):
    """Reads cell size [m] and rows from the smallest y; NaN = unknown."""
    head, rows = read_asc(pathlib.Path(path))
    return head["cellsize"], [[math.nan if z is None else z for z in row] for row in reversed(rows)]


def setting(config, group, key):
    """A number of the configuration that the run wrote next to its layers."""
    found = re.search(rf"^  {group}:\n(?:    .*\n)*?    {key}: *([-0-9.e]+)", config, re.MULTILINE)
    return float(found.group(1))


def median(values):
    values = sorted(values)
    return values[len(values) // 2]


class Ground:
    def __init__(self, heights, cell_m, critical_m, reach_m):
        self.height = {(x, y): z for y, row in enumerate(heights) for x, z in enumerate(row) if not math.isnan(z)}
        self.cell_m, self.critical_m = cell_m, critical_m
        n = math.floor(reach_m / cell_m + 1e-6)
        self.disc = [(dx, dy) for dx in range(-n, n + 1) for dy in range(-n, n + 1) if dx * dx + dy * dy <= n * n]
        self.find_floor()
        self.edges = {c for c in self.height if any(abs(self.height[c] - self.height[d]) >= critical_m
                                                    for d in self.beside(c, 8))}

    def beside(self, cell, count):
        x, y = cell
        around = [(x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1), (x + 1, y + 1), (x - 1, y - 1), (x + 1, y - 1),
                  (x - 1, y + 1)]
        return [c for c in around[:count] if c in self.height]

    def find_floor(self):
        bins = {}
        for z in self.height.values():
            bins[round(100 * z)] = bins.get(round(100 * z), 0) + 1
        common = 0.01 * max(bins, key=lambda b: bins.get(b - 1, 0) + bins[b] + bins.get(b + 1, 0))
        floor = {c for c, z in self.height.items() if abs(z - common) <= 0.015}
        steps = [self.height[c] - self.height[d] for c in floor for d in self.beside(c, 4) if d in floor]
        self.sigma_m = 1.4826 * median([abs(step) for step in steps]) / math.sqrt(2)
        for _ in range(10):
            a, b, c0 = plane(floor, self.height)
            off = {c: z - (a * c[0] + b * c[1] + c0) for c, z in self.height.items()}
            floor = {c for c, z in off.items() if abs(z) <= 5 * self.sigma_m}
        self.floor, self.over_floor = floor, off

    def open_floor(self):
        return {c for c in self.floor if all(d in self.floor or d not in self.height for d in self.around(c))}

    def around(self, cell):
        return ((cell[0] + dx, cell[1] + dy) for dx, dy in self.disc)

    def flat_tops(self):
        """Maps a cell to the tilt [rad] of the plane around it."""
        tops = {}
        for cell, over in self.over_floor.items():
            near = [d for d in self.around(cell) if d in self.height]
            if over < self.critical_m or 2 * len(near) < len(self.disc):
                continue
            a, b, c = plane(near, self.height)
            if all(abs(self.height[d] - (a * d[0] + b * d[1] + c)) <= 5 * self.sigma_m for d in near):
                tops[cell] = math.atan(math.hypot(a, b) / self.cell_m)
        return tops


def plane(cells, height):
    """Least-squares plane z = a x + b y + c over cell indices."""
    n = len(cells)
    mx, my = sum(c[0] for c in cells) / n, sum(c[1] for c in cells) / n
    mz = sum(height[c] for c in cells) / n
    xx = sum((c[0] - mx) ** 2 for c in cells)
    yy = sum((c[1] - my) ** 2 for c in cells)
    xy = sum((c[0] - mx) * (c[1] - my) for c in cells)
    xz = sum((c[0] - mx) * (height[c] - mz) for c in cells)
    yz = sum((c[1] - my) * (height[c] - mz) for c in cells)
    det = xx * yy - xy * xy
    a, b = (xz * yy - yz * xy) / det, (yz * xx - xz * xy) / det
    return a, b, mz - a * mx - b * my


def measure(dem_path, rated):
    """Results of one height map and the folder of its ratings."""
    config = (pathlib.Path(rated) / "config.yaml").read_text()
    critical_m = setting(config, "step", "critical_m")
    reach_m = max(setting(config, "step", "first_radius_m") + setting(config, "step", "second_radius_m"),
                  setting(config, "normals", "radius_m"), setting(config, "roughness", "radius_m"))
    threshold = float(re.search(r"safe_threshold: *([0-9.]+)", config).group(1))
    cell_m, heights = read_grid(dem_path)
    _, ratings = read_grid(pathlib.Path(rated) / "traversability.asc")
    ground = Ground(heights, cell_m, critical_m, reach_m)
    safe = lambda cells: sum(1 for x, y in cells if ratings[y][x] >= threshold)  # NaN is not safe
    open_floor, tops = ground.open_floor(), ground.flat_tops()
    level = {c for c, lean in tops.items() if lean <= math.radians(LEVEL_DEG)}
    return {"sigma_m": ground.sigma_m, "floor": len(open_floor), "floor_safe": safe(open_floor),
            "edges": len(ground.edges), "edges_safe": safe(ground.edges),
            "level_tops": len(level), "level_tops_safe": safe(level),
            "leaning_tops": len(tops) - len(level), "leaning_tops_safe": safe(set(tops) - level)}
