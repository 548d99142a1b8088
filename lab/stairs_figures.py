"""Results of `tools/experiments stairs`: shares and scatters with their intervals, and the required figures.

Rows are those of lab/stairs_truth/main, a dictionary a line. Used by the stairs experiments (tables) and tools/accuracy (page).
"""
import csv
import math
import pathlib
import statistics

STAIRS_UP = [f"lab/scenes/stairs_up.yaml#{name}" for name in ("up_service", "up_secondary", "up_common", "up_accessible", "up_ada")]
STAIRS_FEW = [f"lab/scenes/stairs_up.yaml#up_{steps}" for steps in (1, 2, 3)]
STAIRS_THESIS = ["demo_stairs", "flight_20_up", *(f"lab/scenes/stairs_up.yaml#{name}" for name in ("up_glass", "up_open"))]
STAIRS_DOORS = ["door_760", "door_810", "door_900", "door_1000", "sill_20",
                *(f"lab/scenes/door_ahead.yaml#{name}" for name in ("door_plain", "door_sill"))]
NO_STAIRS = ["floor", "cross_fall", "ramp_1_12_up", "ramp_1_12_down", "table", "room", "corridor", "overhang", "stripes_across",
             "shadow_railing", "lab/scenes/clutter.yaml", *(f"lab/scenes/rough_ground.yaml#{name}" for name in ("rough_grass", "rough_stones"))]
# Scenes, seeds of each, and after how many frames each map is judged (0: at the end).
PARTS = {"up": (STAIRS_UP, 40, 0), "few": (STAIRS_FEW, 200, 0), "down_far": (["lab/scenes/stairs_down.yaml#down_far"], 200, 0),
         "down_near": (["lab/scenes/stairs_down.yaml#down_near"], 200, 0), "kerbs": (["lab/scenes/kerb_ahead.yaml"], 1000, 0),
         "none": (NO_STAIRS, 10, 1), "thesis": (STAIRS_THESIS, 50, 0), "doors": (STAIRS_DOORS, 40, 0)}
MODES = ("analytic_0.25", "analytic_0.5", "images_0.25", "images_0.5")
MOST_PX = {"images_0.25": 0.3, "images_0.5": 0.6}  # the same image noise gives other disparity noise on other textures


def short_name(scene):
    return scene.split("#")[-1].split("/")[-1].split(".")[0]


def csv_of(folder, part, scene, mode):
    return pathlib.Path(folder) / f"{part}_{short_name(scene)}_{mode}.csv"


def read_part(folder, part, mode):
    """Rows of a part as far as they were measured; scenes by their short names."""
    rows = []
    for scene in PARTS[part][0]:
        file = csv_of(folder, part, scene, mode)
        if file.exists():
            with open(file, newline="") as lines:
                rows += [{**row, "scene": short_name(scene)} for row in csv.DictReader(lines)]
    return rows


def wilson(hits, trials):
    """Share in percent with its 95 % interval (Wilson 1927)."""
    if not trials:
        return "-"
    z, share = 1.96, hits / trials
    middle = (share + z * z / (2 * trials)) / (1 + z * z / trials)
    half = z / (1 + z * z / trials) * math.sqrt(share * (1 - share) / trials + z * z / (4 * trials * trials))
    digits = 1 if trials < 2000 else 2
    return (f"{100 * share:.{digits}f} % ({100 * max(middle - half, 0):.{digits}f}-{100 * min(middle + half, 1):.{digits}f}), "
            f"{hits} of {trials}")


def chi_square(share, freedom):
    """Quantile after Wilson and Hilferty (1931): within a percent from 5 degrees of freedom on."""
    part = 2 / (9 * freedom)
    return freedom * (1 - part + statistics.NormalDist().inv_cdf(share) * math.sqrt(part)) ** 3


def deviation(errors):
    """Standard deviation with its 95 % interval, as if the errors were normal."""
    sd, freedom = statistics.stdev(errors), len(errors) - 1
    low, high = (sd * math.sqrt(freedom / chi_square(share, freedom)) for share in (0.975, 0.025))
    return f"{sd:.1f} ({low:.1f}-{high:.1f})"


def scatter(errors):
    """Mean / standard deviation with its 95 % interval, as if the errors were normal."""
    return f"{statistics.mean(errors):+.1f} / {deviation(errors)}" if len(errors) > 5 else "-"


def numbers(rows, key):
    """The values that exist."""
    return [value for r in rows if r[key] and not math.isnan(value := float(r[key]))]


def errors_of(rows, found, true):
    return [float(r[found]) - float(r[true]) for r in rows if r[found] not in ("", "nan")]


def is_near(row, found, true, most_mm):
    return row[found] not in ("", "nan") and abs(float(row[found]) - float(row[true])) <= most_mm


def is_drop_near(row):
    return row["drop"] == "1" and abs(float(row["drop_across"])) <= 30


def is_flight_true(row):
    """Riser within 10 mm, going within 30."""
    return row["found"] == "1" and is_near(row, "found_riser", "riser", 10) and is_near(row, "found_going", "going", 30)


def is_thesis_flight_true(row):
    """Riser within 5 mm, the first edge within 0.1 m; every step counted where all are below the camera."""
    low = float(row["steps"]) * float(row["riser"]) < 900
    return row["found"] == "1" and is_near(row, "found_riser", "riser", 5) and (not low or row["found_steps"] == row["steps"])


def required(folder):
    """(what, found, required, met) for each measured figure, from the results after all observations.

    `required` is None for a figure without a required value.
    """
    rows = {(part, mode): [r for r in read_part(folder, part, mode) if r["way"] == "tracked"] for part in PARTS for mode in MODES}
    figures = []

    def share(what, mine, is_good, least_percent):
        if mine:
            good = sum(map(is_good, mine))
            figures.append((what, wilson(good, len(mine)), f"at least {least_percent} %", 100 * good >= least_percent * len(mine)))

    def sizes(mode, riser_mm, going_mm):
        mine = [r for r in rows["up", mode] if r["found"] == "1"]
        for name, most_mm in (("riser", riser_mm), ("going", going_mm)):
            errors = errors_of(mine, f"found_{name}", name)
            if len(errors) > 5:
                what = f"flights up of 4 to 8 steps, {mode.replace('_', ' ')} px, {name}"
                figures.append((f"{what}: mean error", f"{statistics.mean(errors):+.1f} mm, {len(errors)} flights", None, True))
                figures.append((f"{what}: standard deviation of the error", f"{deviation(errors)} mm, {len(errors)} flights",
                                f"at most {most_mm} mm", statistics.stdev(errors) <= most_mm))

    sizes("analytic_0.25", 1.0, 2.0)
    sizes("images_0.25", 2.4, 2.7)
    for mode in ("images_0.25", "images_0.5"):
        px = mode.replace("_", " ") + " px"
        for steps in (1, 2, 3):
            share(f"flights up of {steps} step{'s' if steps > 1 else ''}, {px}: found", [r for r in rows["few", mode] if r["scene"] == f"up_{steps}"],
                  lambda r: r["found"] == "1", 95)
        share(f"stairs down, 1.5 m ahead, {px}: drop found with its edge within 30 mm", rows["down_far", mode], is_drop_near, 90)
        share(f"stairs down, 0.67-1.0 m ahead, {px}: riser within 10 mm and going within 30 mm", rows["down_near", mode], is_flight_true, 90)
        share(f"kerbs down of 75-150 mm, 0.67-1.5 m ahead, {px}: flagged as a drop", rows["kerbs", mode], lambda r: r["drop"] == "1", 99)
        if mine := rows["none", mode]:
            false = sum(r["flights"] != "0" for r in mine)
            figures.append((f"frames without stairs in which a flight is reported, {px}", wilson(false, len(mine)), "at most 1 %", 100 * false <= len(mine)))
    exact, first = "number of steps exact", "number of steps not judged (the last steps lie above the camera)"
    for scene, what, steps in (("demo_stairs", "demonstration stairs", exact), ("flight_20_up", "flight of 20 steps", first),
                               ("up_glass", "carpeted stairs between panes of glass", exact), ("up_open", "steep stairs of boards without risers", exact)):
        share(f"thesis, {what}, images 0.25 px: riser within 5 mm, {steps}",
              [r for r in rows["thesis", "images_0.25"] if r["scene"] == scene], is_thesis_flight_true, 95)
    doors = rows["doors", "images_0.25"]
    share("doors, images 0.25 px: width within 30 mm", doors, lambda r: r["door"] == "1" and is_near(r, "door_width", "width", 30), 95)
    share("sills of 20 mm or more, images 0.25 px: found", [r for r in doors if float(r["sill"]) >= 20], lambda r: r["sill_height"] != "nan", 95)
    return figures
