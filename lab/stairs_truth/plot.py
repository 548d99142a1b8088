"""Tables of docs/lab/stairs.md: stairs, drops, kerbs and doors in the map against the geometry of the scenes."""
import collections
import math
import statistics

from lab_figures import ROOT, fill, quantile, read, table
import stairs_figures
from stairs_figures import errors_of, is_drop_near, is_flight_true, numbers, scatter, wilson

STAIRS_FIRST_SEED = 85_001  # no setting was chosen with these
OWN_POSES = "own poses"
STAIRS_AT_ONCE = 10
STAIRS_WAYS = {"tracked": "", "single": ", single observation"}


def stairs(lab):
    """Stairs, drops, kerbs and doors in the map, against the geometry of the scenes."""
    rows = {part: [row for mode in stairs_figures.MODES for row in stairs_rows(lab, part, mode)] for part in stairs_figures.PARTS}
    rows["up"] += [{**row, "mode": f"{row['mode']}, {OWN_POSES}"}
                   for row in stairs_rows(lab, "up", "images_0.25", OWN_POSES, "sim.known_motion=false")]
    noise = stairs_noise({part: [row for row in mine if row["way"] == "single"] for part, mine in rows.items()})
    for part, mine in rows.items():
        some = [(mode, f"{mode}, measured {most_px} or less", most_px) for mode, most_px in stairs_figures.MOST_PX.items()]
        rows[part] = [{**row, "mode": name + STAIRS_WAYS[row["way"]]}
                      for mode, name, most_px in sorted([(mode, mode, math.inf) for mode in dict.fromkeys(r["mode"] for r in mine)] + some)
                      for way in STAIRS_WAYS for row in mine
                      if (row["mode"], row["way"]) == (mode, way) and not float(row["noise_px"]) > most_px]
    lines = []
    for part, title, make in (("up", "Flights up of 4 to 8 steps", flights_table), ("few", "Flights up of 1, 2 and 3 steps", flights_table),
                              ("down_far", "Stairs down, first edge 1.5 m before the camera", drops_table),
                              ("down_near", "Stairs down, first edge 0.67-1.0 m before the camera", downs_table),
                              ("kerbs", "Kerbs down of 75-150 mm, 0.67-1.5 m before the camera", kerbs_table),
                              ("none", "Flights reported where there are no stairs", no_stairs_table),
                              ("thesis", "Stairs like those of the reference thesis (Lange 2016)", flights_table), ("doors", "Doors and sills", doors_table)):
        lines += [f"### {title}", ""]
        scenes, seeds, _ = stairs_figures.PARTS[part]
        missing = [f"{mode} ({len(done)} of {seeds * len(scenes)})" for mode in stairs_figures.MODES
                   if len(done := {(r["scene"], r["seed"]) for r in rows[part] if r["mode"] == mode}) < seeds * len(scenes)]
        lines += [f"Not measured yet: {', '.join(missing)}.", ""] if missing else []
        lines += make(rows[part]) + [""] if rows[part] else []
    fill("stairs", lines + ["### Noise and time", ""] + noise + [""])


def stairs_rows(lab, part, mode, variant="", *settings):
    """Runs the missing seeds. Results of the same program in the CSV files are kept. The maps are not kept: the 36 maps of a run
    take 110 MB."""
    scenes, seeds, every = stairs_figures.PARTS[part]
    folder = lab.folder(f"stairs/{variant.replace(' ', '_') or 'true_poses'}")
    lab.set_aside_older_results("stairs_truth", folder)
    for scene in [] if lab.redraw else scenes:
        named = str(ROOT / scene) if "/" in scene else scene
        file, few = stairs_figures.csv_of(folder, part, scene, mode), folder / "next.csv"
        done = len({row["seed"] for row in read(file)}) if file.exists() else 0  # in order, from the first seed on
        for first in range(done, seeds, STAIRS_AT_ONCE):
            lab.run("stairs_truth", few, named, STAIRS_FIRST_SEED + first, min(STAIRS_AT_ONCE, seeds - first), mode, every, "-", *settings)
            rows = few.read_text().splitlines(keepends=True)
            with open(file, "a") as whole:
                whole.writelines(rows if first == 0 else rows[1:])
    return stairs_figures.read_part(folder, part, mode)


def by_mode_and_scene(rows):
    """Rows of each mode: first all scenes together, if there are several, then each scene."""
    for mode in dict.fromkeys(r["mode"] for r in rows):
        mine = [r for r in rows if r["mode"] == mode]
        scenes = list(dict.fromkeys(r["scene"] for r in mine))
        if len(scenes) > 1:
            yield mode, "**all**", mine
        for scene in scenes if "," not in mode or len(scenes) == 1 else []:
            yield mode, scene, [r for r in mine if r["scene"] == scene]


def within_sigmas(rows):
    """Share of risers within 2 stated sigma; 95 % are wanted."""
    found = [r for r in rows if r["found"] == "1"]
    return wilson(sum(abs(float(r["found_riser"]) - float(r["riser"])) <= 2 * float(r["riser_sigma"]) for r in found), len(found))


def flights_table(rows):
    body = []
    for mode, scene, mine in by_mode_and_scene(rows):
        found = [r for r in mine if r["found"] == "1"]
        exact = sum(r["found_steps"] == r["steps"] for r in found)
        body.append([mode, scene, wilson(len(found), len(mine)), scatter(errors_of(found, "found_riser", "riser")),
                     scatter(errors_of(found, "found_going", "going")), wilson(exact, len(mine)), scatter(numbers(found, "across")),
                     within_sigmas(found)])
    return table(["input", "scene", "flights found", "riser: mean error / sd [mm]", "going: mean error / sd [mm]", "flights with the exact number of steps",
                  "first edge: mean error / sd [mm]", "risers within 2 stated sigma of the true riser"], body)


def drops_table(rows):
    body = []
    for mode, scene, mine in by_mode_and_scene(rows):
        found = [r for r in mine if r["drop"] == "1"]
        near = sum(map(is_drop_near, mine))
        body.append([mode, wilson(len(found), len(mine)), wilson(near, len(mine)), scatter(numbers(found, "drop_across")),
                     f"{sum(r['bottom_seen'] == '1' for r in found)}", f"{sum(int(r['drops']) for r in mine)}"])
    return table(["input", "drop found", "edge within 30 mm, of all cases", "edge: mean error / sd [mm]", "cases with observed ground behind the drop",
                  "other drops reported in all cases"], body)


def downs_table(rows):
    body = []
    for mode, scene, mine in by_mode_and_scene(rows):
        found = [r for r in mine if r["found"] == "1"]
        good = sum(map(is_flight_true, mine))
        body.append([mode, wilson(len(found), len(mine)), wilson(good, len(mine)), scatter(errors_of(found, "found_riser", "riser")),
                     scatter(errors_of(found, "found_going", "going")), scatter(numbers(found, "across")),
                     wilson(sum(r["drop"] == "1" for r in mine), len(mine))])
    return table(["input", "flight found", "riser within 10 mm and going within 30 mm, of all cases", "riser: mean error / sd [mm]",
                  "going: mean error / sd [mm]", "first edge: mean error / sd [mm]", "drop found"], body)


def kerbs_table(rows):
    body = []
    for mode in dict.fromkeys(r["mode"] for r in rows):
        mine = [r for r in rows if r["mode"] == mode]
        for name, some in [("**all**", mine)] + [
                (f"{low}-{high} mm", [r for r in mine if low <= float(r["riser"]) < high]) for low, high in ((75, 100), (100, 125), (125, 150))] + [
                (f"{low}-{high} m", [r for r in mine if low <= 1e-3 * float(r["ahead"]) < high]) for low, high in ((0.67, 0.95), (0.95, 1.22), (1.22, 1.5))]:
            found = [r for r in some if r["drop"] == "1"]
            near = sum(map(is_drop_near, some))
            body.append([mode, name, wilson(len(found), len(some)), wilson(near, len(some)), scatter(numbers(found, "drop_across")),
                         scatter(errors_of([r for r in found if r["bottom_seen"] == "1"], "drop_height", "riser"))])
    return table(["input", "height or distance of the kerb", "kerbs flagged as a drop", "edge within 30 mm, of all cases", "edge: mean error / sd [mm]",
                  "height if the ground below is observed: mean error / sd [mm]"], body)


def no_stairs_table(rows):
    body = []
    for mode, scene, mine in by_mode_and_scene(rows):
        runs = collections.defaultdict(int)
        for r in mine:
            runs[r["scene"], r["seed"]] += int(r["flights"])
        body.append([mode, scene, wilson(sum(r["flights"] != "0" for r in mine), len(mine)),
                     wilson(sum(r["of_2"] != "0" for r in mine), len(mine)), f"{sum(map(bool, runs.values()))} of {len(runs)}"])
    return table(["input", "scene", "observations with a flight", "observations with a flight of two steps or more", "runs with a flight"], body)


def doors_table(rows):
    body = []
    for mode, scene, mine in by_mode_and_scene(rows):
        found = [r for r in mine if r["door"] == "1"]
        sills = [r for r in mine if float(r["sill"]) >= 20]
        with_height = [r for r in sills if r["sill_height"] != "nan"]
        none = [r for r in mine if float(r["sill"]) == 0]
        body.append([mode, scene, wilson(len(found), len(mine)), scatter(errors_of(found, "door_width", "width")),
                     wilson(len(with_height), len(sills)), scatter(errors_of(with_height, "sill_height", "sill")),
                     wilson(sum(r["sill_height"] != "nan" for r in none), len(none))])
    return table(["input", "scene", "doors found", "width: mean error / sd [mm]", "sills of 20 mm or more found",
                  "sill height: mean error / sd [mm]", "sills reported in doors without a sill"], body)


def stairs_noise(rows):
    """Noise of the disparities of all observations, and the time of a call."""
    body = []
    every = [r for part in rows.values() for r in part]
    for mode in dict.fromkeys(r["mode"] for r in every):
        mine = [r for r in every if r["mode"] == mode]
        noise, took_us = numbers(mine, "noise_px"), numbers(mine, "find_us")
        body.append([mode, len(mine), " / ".join(f"{quantile(noise, share):.2f}" for share in (0.05, 0.5, 0.95)),
                     f"{statistics.median(numbers(mine, 'bias_px')):+.2f}", f"{statistics.median(numbers(mine, 'said_px')):.2f}",
                     " / ".join(f"{1e-3 * quantile(took_us, share):.1f}" for share in (0.5, 0.95))])
    return table(["input", "observations", "measured disparity noise on level floor [px]: 5 % / median / 95 %", "bias of these disparities, median [px]",
                  "stated sigma, median [px]", "one call of the finder [ms]: median / 95 %"], body)


EXPERIMENTS = {"stairs": stairs}
