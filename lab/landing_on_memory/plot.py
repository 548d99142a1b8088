"""Tables and pictures of docs/lab/landing.md: how wrong remembered ground is when a foot lands on it."""
import collections

import matplotlib.pyplot as plt

from lab_figures import fill, quantile, read, save, table


def landing(lab):
    """Errors of the remembered ground at the landing of a foot, by mount and number of cameras."""
    lines = []
    for noise in (1, 2):
        file = lab.folder("landing") / f"noise{noise}.csv"
        if not file.with_suffix(".done").exists():  # a long run: its result is kept
            if lab.redraw:
                lines += [f"Camera noise x {noise}: not measured yet.", ""]
                continue
            lab.run("landing_on_memory", file, 10_001, 1, noise)
            file.with_suffix(".done").touch()
        lines += [f"### Camera noise x {noise}", ""] + landing_part(read(file), noise)
    fill("landing", lines)


def landing_part(rows, noise):
    groups = collections.defaultdict(list)
    for row in rows:
        groups[row["script"], row["pitch_deg"], row["height_m"], row["cameras"]].append(row)
    body, points = [], collections.defaultdict(list)
    for (script, pitch, height, cameras), mine in sorted(groups.items(), key=lambda g: [g[0][0], *map(float, g[0][1:])]):
        known = [r for r in mine if r["known"] == "1"]
        heights = [1e3 * abs(float(r["height_error_m"])) for r in known]
        sideways = [1e3 * float(r["horizontal_m"]) for r in known]
        ages = [float(r["age_s"]) for r in known]
        share = 100 * len(known) / len(mine)
        body.append([script, f"{pitch} deg", f"{height} m", cameras, f"{share:.0f} %", f"{quantile(ages, 0.5):.1f} s",
                     f"{quantile(ages, 1.0):.1f} s", f"{quantile(heights, 0.5):.1f}", f"{quantile(heights, 0.99):.1f} mm",
                     f"{quantile(sideways, 0.5):.1f}", f"{quantile(sideways, 0.99):.1f} mm"])
        if script == "straight":
            points[height, cameras].append((float(pitch), share, quantile(heights, 0.99), quantile(sideways, 0.99)))
    figure, axes = plt.subplots(1, 3, figsize=(11, 3.4))
    for (height, cameras), mine in sorted(points.items()):
        mine.sort()
        label = f"{height} m, {cameras} camera{'s' if cameras == '2' else ''}"
        for axis, index in zip(axes, (1, 2, 3)):
            axis.plot([m[0] for m in mine], [m[index] for m in mine], "o-" if cameras == "1" else "s--", label=label)
    for axis, what, limit in zip(axes, ("landing feet with known ground [%]", "|height error|, p99 [mm]",
                                        "horizontal error, p99 [mm]"), (None, 10, 25)):
        axis.set(xlabel="camera pitch, down [deg]", ylabel=what, ylim=(0, None))
        if limit:
            axis.set_title(f"wanted: at most {limit} mm", fontsize=9)
    axes[0].legend(fontsize=8)
    return table(["walk", "camera pitch, down", "camera height", "number of cameras", "points under landing feet with known ground", "median age of the known ground",
                  "largest age of the known ground", "height error, median [mm]", "height error, 99th percentile", "horizontal error, median [mm]",
                  "horizontal error, 99th percentile"], body) + ["", save(figure, f"landing_noise{noise}"), ""]


LANDING_SEEDS = {"mounts": (20_001, 3), "conditions": (20_001, 2)}


def landing_conditions(lab):
    """The recommended mounts with three seeds, and the usual mount with worse images."""
    rows = []
    for kind, seeds in LANDING_SEEDS.items():
        file = lab.folder("landing") / f"{kind}1.csv"
        if not file.with_suffix(".done").exists():  # a long run: its result is kept
            lab.run("landing_on_memory", file, *seeds, 1, kind)
            file.with_suffix(".done").touch()
        rows += read(file)
    groups = collections.defaultdict(list)
    for row in rows:
        groups[row["condition"], row["pitch_deg"], row["cameras"]].append(row)
    body = []
    for (condition, pitch, cameras), mine in groups.items():
        known = [r for r in mine if r["known"] == "1"]
        first = [r for r in mine if r["step"] == "0"]
        unknown = lambda some: 100 * sum(r["known"] == "0" for r in some) / len(some)  # noqa: E731
        p99 = lambda key: quantile([1e3 * abs(float(r[key])) for r in known], 0.99)  # noqa: E731
        worst_of = lambda key: max(1e3 * abs(float(r[key])) for r in known)  # noqa: E731
        last = {seed: max(int(r["lost"]) for r in mine if r["seed"] == seed) for seed in {r["seed"] for r in mine}}
        body.append([condition, f"{pitch} deg", cameras, len(last), f"{unknown(mine):.1f} %", f"{unknown(first):.1f} %",
                     f"{unknown([r for r in mine if r['step'] != '0']):.1f} %", f"{p99('height_error_m'):.1f} mm",
                     f"{worst_of('height_error_m'):.1f}", f"{p99('horizontal_m'):.1f} mm", f"{worst_of('horizontal_m'):.1f}",
                     sum(last.values())])
    fill("landing", table(["condition of the images", "camera pitch, down", "number of cameras", "number of seeds", "points unknown, all steps",
                           "points unknown, first step", "points unknown, later steps", "height error, 99th percentile", "height error, largest [mm]",
                           "horizontal error, 99th percentile", "horizontal error, largest [mm]", "frames with lost odometry"], body), "conditions")


EXPERIMENTS = {"landing": landing, "landing_conditions": landing_conditions}
