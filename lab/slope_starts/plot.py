"""Table of the part "slopes" in docs/lab/ground.md: whole runs that start on a slope."""
import json
import statistics
import subprocess

from lab_figures import ROOT, fill, table


def slope_starts(lab):
    """Height errors and their stated sigma in runs that start on a slope."""
    out = lab.folder("slope_starts")
    starts = {"cross-fall of 1:50": "cross_fall", "ramp of 1:12": str(ROOT / "lab/scenes/ramp_start.yaml")}
    body = []
    for number, (name, scene) in enumerate(starts.items()):
        medians_mm, within = [], []
        for seed in range(50_101, 50_117):
            folder = out / f"{number}_{seed}"
            if not (folder / "report.json").exists():  # a finished run is kept
                subprocess.run([str(lab.build / "bin/surefoot"), "run", f"sim:{scene}", "--seed", str(seed), "--max-frames", "60",
                                "--threads", "1", "--out", str(folder)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            truth = json.loads((folder / "report.json").read_text())["truth"]
            medians_mm.append(1e3 * truth["elevation_away_from_edges"]["median_abs_m"])
            within.append([truth["sigma"][f"within_{k}_sigma"] for k in (1, 2, 3)])
        shares = [statistics.mean(w) for w in zip(*within)]
        body.append([name, len(medians_mm), f"{statistics.median(medians_mm):.1f}", f"{max(medians_mm):.1f}",
                     *(f"{100 * s:.0f} %" for s in shares)])
    fill("ground", table(["slope at the start", "runs", "median height error of a run, median of the runs [mm]", "median height error of a run, worst run [mm]",
                          *(f"cells within {k} sigma" for k in (1, 2, 3))], body), "slopes")


EXPERIMENTS = {"slope_starts": slope_starts}
