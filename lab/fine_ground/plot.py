"""Tables of docs/lab/fine_ground.md: the map from coarse frames with fine ground, against VGA, coarse frames alone and full size."""
import concurrent.futures
import hashlib
import itertools
import json
import statistics
import subprocess

from lab_figures import fill, table

SEEDS = (50_011, 50_012)  # for reports only
SCENES = ("demo_stairs", "ramp_1_12_up", "cross_fall")
NOISES = (1, 2)
TRUE_POSES = "sim.known_motion=true"
# The vertical of odom is then the normal of the floor, without the accelerometer. The floors of the simulator are exactly level.
VERTICAL_OF_FLOOR = "mount.gravity.level_floor_deg=0.001"
CASES = {  # name: rig, settings
    "672 x 376": ("zed_vga", ()),
    "1280 x 720, coarse alone": ("zed_hd720", ("fine.from_m=-9", "fine.to_m=-8")),
    "1280 x 720, fine ground every 0.5 s": ("zed_hd720", ()),
    "1280 x 720, all of every frame at full size": ("zed_hd720", ("fine.scale=1", "stereo.disparities=128")),
}


def fine_ground(lab):
    """Errors of the map with coarse frames and fine ground, by size of the images."""
    own = list(itertools.product(SCENES, NOISES, CASES, [()]))
    true = [("demo_stairs", 1, case, (TRUE_POSES,)) for case in CASES]
    floor = [("demo_stairs", noise, case, (VERTICAL_OF_FLOOR,)) for noise in NOISES for case in CASES]
    cases = own + true + floor
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        reports = dict(zip(cases, pool.map(lambda case: reports_of(lab, *case), cases)))
    fill("fine_ground", [*errors_table(reports, own), ""])
    fill("fine_ground", [*errors_table(reports, floor), ""], "vertical of the floor")
    fill("fine_ground", [*ranges_table(reports, true), ""], "true poses")


def errors_table(reports, cases):
    body = [[*case[:3], *errors(reports[case])] for case in cases]
    return table(["scene", "noise", "images", "median error", "90 % error", "cells off by over 50 mm", "points that reach the map",
                  "within 1 / 3 sigma"], body)


def errors(runs):
    mean = lambda get: statistics.mean(get(report) for report in runs)  # noqa: E731
    error = lambda key: mean(lambda r: 1e3 * r["truth"]["elevation"][key])  # noqa: E731
    sigma = lambda k: mean(lambda r: 100 * r["truth"]["sigma"][f"within_{k}_sigma"])  # noqa: E731
    return [f"{error('median_abs_m'):.1f} mm", f"{error('p90_abs_m'):.1f} mm",
            f"{mean(lambda r: 100 * r['truth']['elevation']['share_over_50mm']):.1f} %", f"{mean(reaching_map):.0f} %",
            f"{sigma(1):.0f} / {sigma(3):.1f} %"]


def ranges_table(reports, cases):
    """Median / 90 % error of the cells by the range from which they were seen last."""
    bins = [(0.5, 1.0), (1.0, 1.5), (1.5, 2.0), (2.0, 2.5), (2.5, 3.0), (3.0, 4.0)]
    body = []
    for case in cases:
        row = [case[2]]
        for low, high in bins:
            found = [b for report in reports[case] for b in report["truth"]["by_range"] if (b["from_m"], b["to_m"]) == (low, high)]
            row.append(" / ".join(f"{1e3 * statistics.mean(b[key] for b in found):.1f}" for key in ("median_abs_m", "p90_abs_m")))
        body.append(row)
    return table(["images", *(f"{low:g}-{high:g} m [mm]" for low, high in bins)], body)


def reaching_map(report):
    """Share of the points in range that are trusted and on no jump of the depth."""
    counts = report["counts"]
    return 100 * (1 - counts["gated_confidence"] / (counts["points"] - counts["gated_range"]))


def reports_of(lab, scene, noise, images, more):
    rig, settings = CASES[images]
    return [report_of(lab, scene, rig, (f"sim.noise={noise}", *settings, *more), seed) for seed in SEEDS]


def report_of(lab, scene, rig, settings, seed):
    """Runs the command line once, on one thread, and keeps its report for this build of the program."""
    program = lab.build / "bin/surefoot"
    build = hashlib.sha256(program.read_bytes()).hexdigest()[:8] if program.exists() else "none"
    name = "_".join([scene, rig, str(seed), *settings]).replace("=", "-")
    kept = lab.folder("fine_ground") / f"{name}.json"
    result = json.loads(kept.read_text()) if kept.exists() else {}
    if not lab.redraw and result.get("build") != build:
        words = ["sim.profile=zed", *settings]
        out = lab.folder("fine_ground") / name
        subprocess.run([str(program), "run", f"sim:{scene}", "--rig", rig, "--seed", str(seed), "--threads", "1", "--out", str(out),
                        *(word for setting in words for word in ("--set", setting))], check=True, stdout=subprocess.DEVNULL)
        report = json.loads((out / "report.json").read_text())
        result = {"build": build, **{key: report[key] for key in ("truth", "counts", "fine")}}
        kept.write_text(json.dumps(result))
    return result


EXPERIMENTS = {"fine_ground": fine_ground}
