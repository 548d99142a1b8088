"""Tables of docs/lab/fine_ground.md: the map from coarse frames with fine ground, against VGA and coarse frames alone."""
import hashlib
import json
import statistics
import subprocess

from lab_figures import fill, table

SEEDS = (50_011, 50_012)  # for reports only
SCENES = ("demo_stairs",)
NO_FINE_REGION = ("fine.from_m=-9", "fine.to_m=-8")
CASES = (  # name, rig, settings
    ("672 x 376", "zed_vga", ()),
    ("1280 x 720, coarse alone", "zed_hd720", NO_FINE_REGION),
    ("1280 x 720, fine ground every 0.5 s", "zed_hd720", ()),
)


def fine_ground(lab):
    """Errors of the map with coarse frames and fine ground, by size of the images."""
    body = [row(lab, scene, *case) for scene in SCENES for case in CASES]
    header = ["scene", "images", "median error", "90 % error", "cells off by over 50 mm", "points that reach the map",
              "within 1 / 3 sigma"]
    fill("fine_ground", [*table(header, body), ""])


def row(lab, scene, name, rig, settings):
    reports = [report_of(lab, scene, rig, settings, seed) for seed in SEEDS]
    mean = lambda get: statistics.mean(get(report) for report in reports)  # noqa: E731
    error = lambda key: mean(lambda r: 1e3 * r["truth"]["elevation"][key])  # noqa: E731
    sigma = lambda k: mean(lambda r: 100 * r["truth"]["sigma"][f"within_{k}_sigma"])  # noqa: E731
    return [scene, name, f"{error('median_abs_m'):.1f} mm", f"{error('p90_abs_m'):.1f} mm",
            f"{mean(lambda r: 100 * r['truth']['elevation']['share_over_50mm']):.1f} %", f"{mean(reaching_map):.0f} %",
            f"{sigma(1):.0f} / {sigma(3):.1f} %"]


def reaching_map(report):
    """Share of the points in range that are trusted and on no jump of the depth."""
    counts = report["counts"]
    return 100 * (1 - counts["gated_confidence"] / (counts["points"] - counts["gated_range"]))


def report_of(lab, scene, rig, settings, seed):
    """Runs the command line once, on one thread, and keeps its report for this build of the program."""
    program = lab.build / "bin/surefoot"
    build = hashlib.sha256(program.read_bytes()).hexdigest()[:8] if program.exists() else "none"
    name = "_".join([scene, rig, str(seed), *settings]).replace("=", "-")
    kept = lab.folder("fine_ground") / f"{name}.json"
    result = json.loads(kept.read_text()) if kept.exists() else {}
    if not lab.redraw and result.get("build") != build:
        words = ["sim.profile=zed", *settings]
        out = lab.folder("fine_ground") / "run"
        subprocess.run([str(program), "run", f"sim:{scene}", "--rig", rig, "--seed", str(seed), "--threads", "1", "--out", str(out),
                        *(word for setting in words for word in ("--set", setting))], check=True, stdout=subprocess.DEVNULL)
        report = json.loads((out / "report.json").read_text())
        result = {"build": build, **{key: report[key] for key in ("truth", "counts", "fine")}}
        kept.write_text(json.dumps(result))
    return result


EXPERIMENTS = {"fine_ground": fine_ground}
