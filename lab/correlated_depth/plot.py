"""Tables and pictures of docs/lab/correlated_depth.md: invented depth at edges, and correlated errors on flat floor."""
import collections
import math

import matplotlib.pyplot as plt

from lab_figures import COLOURS, fill, read, save, table


def shares(rows, key):
    """Sums over the rows of each key: hidden, invented, wrong, visible, known, invented with a small sigma."""
    sums = collections.defaultdict(lambda: [0] * 6)
    for row in rows:
        for i, name in enumerate(("hidden", "invented", "invented_wrong", "visible", "visible_known",
                                  "invented_sure")):
            sums[key(row)][i] += int(row[name])
    return sums


DEFAULT_RULE = "default"
CUT_TOP_MM = 80  # upper end of the picture of a kerb; an arrow marks each higher point
SEEDS = (10_001, 3)  # first seed, number of seeds; no tuning used them


def correlated_depth(lab):
    """Invented depth at drop edges, and correlated errors on flat floor."""
    lines = []
    for noise, matchers in ((1, ("census", "sgbm")), (2, ("census",))):
        folders = {matcher: lab.folder(f"correlated_depth/{matcher}{noise}") for matcher in matchers}
        lab.run("correlated_depth", folders["census"], *SEEDS, noise)
        for matcher, folder in folders.items():
            lab.run("invented_depth", folder, *SEEDS, noise, f"algorithm={matcher}")
        lines += ["", f"### Camera noise x {noise}", ""] + invented_part(folders, noise)
        lines += kerbs_part(folders["census"]) + cut_part(folders["census"], noise)
        lines += correlation_part(folders["census"], noise)
    fill("correlated_depth", lines)


def invented_part(folders, noise):
    """Every rule, with each matcher."""
    body, points = [], collections.defaultdict(dict)
    for matcher, folder in folders.items():
        rows = read(folder / "invented.csv")
        rules = list(dict.fromkeys(r["rule"] for r in rows))
        sums = shares(rows, lambda r: (r["rule"], r["motion"]))
        for rule in rules:
            row = [rule if rule != DEFAULT_RULE else f"**{rule}**", matcher]
            for motion in ("one frame", "approach"):
                hidden, invented, wrong, visible, known, _ = sums[rule, motion]
                row += [f"{100 * n / all_of:.1f} %" for n, all_of in ((invented, hidden), (wrong, hidden), (known, visible))]
            points[matcher][rule] = (100 * invented / hidden, 100 * known / visible)  # of the approach
            body.append(row)
    body.sort(key=lambda row: rules.index(row[0].strip("*")))
    lines = ["The table gives shares of the hidden cells (behind a drop edge) and of the visible cells (both cameras see them completely), "
             "for all drops and distances:", ""]
    lines += table(["pixels that the map uses", "matcher", *(f"{frames}: {cells}" for frames in ("one frame", "10 frames") for cells in
                    ("hidden cells invented", "hidden cells invented and more than 20 mm wrong", "visible cells known"))], body)
    return lines + ["", invented_picture(points, rules, noise), ""]


def invented_picture(points, rules, noise):
    figure, axis = plt.subplots(figsize=(7.5, 4.6))
    sweep = [rule for rule in rules if rule.startswith("incidence") or rule == DEFAULT_RULE]
    axis.axvspan(0.5, 5, ymin=0, ymax=1, color="#009e73", alpha=0.10, linewidth=0)
    axis.axhspan(95, 101, color="#009e73", alpha=0.10, linewidth=0)
    for (matcher, found), colour in zip(points.items(), (COLOURS[0], "#999999")):
        axis.plot(*zip(*sorted(found[rule] for rule in sweep)), "o-", color=colour, markersize=5,
                  label=f"{matcher}: limit on incidence")
        others = [found[rule] for rule in rules if rule not in sweep]
        axis.plot(*zip(*others), "s", color=colour, markersize=5, fillstyle="none", label=f"{matcher}: other rules")
        axis.plot(*found[DEFAULT_RULE], "*", color=colour, markersize=15, label=f"{matcher}: the defaults")
    for rule in rules:
        if rule in sweep or rule in ("every match", "likely right"):
            label = rule.split()[-2] + " deg" if rule.startswith("incidence") else rule
            axis.annotate(label, points["census"][rule], xytext=(-2, -13), textcoords="offset points", fontsize=7.5,
                          ha="right" if rule == "every match" else "left")
    lowest = min(known for found in points.values() for _, known in found.values())
    axis.set(xlabel="invented: share of the hidden cells that are known [%]", xscale="log", xlim=(0.9, 110),
             ylabel="kept: share of the visible cells that are known [%]", ylim=(lowest - 3, 101),
             title=f"Ten frames toward a drop, noise x {noise}: the dark green corner is the aim")
    axis.set_xticks([1, 2, 5, 10, 20, 50, 100], ["1", "2", "5", "10", "20", "50", "100"])
    axis.legend(fontsize=8, loc="lower right")
    return save(figure, f"invented_noise{noise}")


def kerbs_part(folder):
    """Cells that stay unknown with the default settings, by height and distance."""
    rows = [r for r in read(folder / "invented.csv") if r["rule"] == DEFAULT_RULE]
    drops = list(dict.fromkeys(r["drop"] for r in rows))
    distances = list(dict.fromkeys(r["distance_m"] for r in rows))
    lines = ["The table gives shares by drop and distance, for census with the default settings. Each entry holds the share of hidden "
             "cells that stay unknown, the number of hidden cells, and the share of visible cells that are known.",
             ""]
    body = []
    for motion, name in (("one frame", "one frame"), ("approach", "10 frames")):
        sums = shares([r for r in rows if r["motion"] == motion], lambda r: (r["drop"], r["distance_m"]))
        body += [[drop, name] + [percent_of(sums[drop, d]) for d in distances] for drop in drops]
    near = shares([r for r in rows if r["drop"].startswith("kerb") and float(r["distance_m"]) < 1.6],
                  lambda r: (r["drop"], r["motion"]))
    body.sort(key=lambda row: drops.index(row[0]))
    lines += table(["drop", "frames"] + [f"edge {d} m ahead: hidden cells unknown / visible cells known" for d in distances], body)
    together = [[drop, *(f"{share(near[drop, motion]):.1f} %" for share in (unknown_share, unsure_share) for motion in ("one frame", "approach"))]
                for drop in drops if drop.startswith("kerb")]
    lines += ["", "The next table gives shares of the hidden cells behind kerbs, for all distances of 0.67-1.5 m together:", ""]
    return lines + table(["drop", "unknown, one frame", "unknown, 10 frames", "unknown or sigma above 10 mm, one frame",
                          "unknown or sigma above 10 mm, 10 frames"], together) + [""]


def unknown_share(sums):
    return 100 - 100 * sums[1] / max(sums[0], 1)


def unsure_share(sums):
    return 100 - 100 * sums[5] / max(sums[0], 1)


def percent_of(sums):
    hidden, _, _, visible, known, _ = sums
    return f"{unknown_share(sums):.1f} % of {hidden} / {100 * known / max(visible, 1):.1f} %"


def cut_part(folder, noise):
    profile = read(folder / "profile.csv")
    figure, axis = plt.subplots(figsize=(7.5, 3.6))
    for rule, label, style in (("every match", "every match", {"color": "#999999", "markersize": 4}),
                               (DEFAULT_RULE, "matches that the defaults accept", {"color": COLOURS[0], "markersize": 7})):
        points = sorted((float(r["x_m"]), float(r["height_m"])) for r in profile
                        if r["rule"] == rule and r["height_m"] != "nan")
        axis.plot([p[0] for p in points], [1e3 * p[1] for p in points], ".", label=label, **style)
        for x_m, height_m in (p for p in points if 1e3 * p[1] > CUT_TOP_MM):
            axis.plot(x_m, CUT_TOP_MM - 6, "^", color=style["color"], markersize=6)
            if rule == DEFAULT_RULE:
                axis.annotate(f"{1e3 * height_m:.0f} mm", (x_m, CUT_TOP_MM - 8), xytext=(6, -4), fontsize=7.5,
                              textcoords="offset points")
    mine = [r for r in profile if r["rule"] == DEFAULT_RULE]
    truth = sorted((float(r["x_m"]), float(r["truth_m"])) for r in mine)
    axis.step([p[0] for p in truth], [1e3 * p[1] for p in truth], where="mid", color="black", linewidth=1, label="truth")
    hidden = [float(r["x_m"]) for r in mine if r["sight"] == "1"]
    if hidden:
        axis.axvspan(min(hidden) - 0.0125, max(hidden) + 0.0125, color="#d55e00", alpha=0.15, linewidth=0,
                     label="hidden from at least one camera")
    axis.set(xlabel="ahead of base_link [m]", ylabel="height [mm]", ylim=(-200, CUT_TOP_MM),
             title=f"A cut through a 150 mm kerb 1.5 m ahead, one frame, noise x {noise}")
    axis.legend(fontsize=8, loc="lower left")
    return [save(figure, f"kerb_cut_noise{noise}"), ""]


def correlation_part(folder, noise):
    rows = read(folder / "correlation.csv")
    patterns = list(dict.fromkeys(r["pattern"] for r in rows))
    floors = {r["pattern"]: r for r in read(folder / "floors.csv")}
    drawn = [p for p in patterns if float(floors[p]["trusted"]) > 0.05]  # the others have too few pixels
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 3.6), sharey=True)
    lengths = {}
    for axis, name in zip(axes, ("row", "column")):
        for i, pattern in enumerate(patterns):
            points = [(int(r["lag_px"]), float(r["correlation"])) for r in rows
                      if r["pattern"] == pattern and r["axis"] == name]
            lengths[pattern, name] = next((lag for lag, c in points if c < math.exp(-1)), "-")
            if pattern in drawn:
                axis.plot(*zip(*points), color=COLOURS[i % len(COLOURS)], linestyle="-" if i < len(COLOURS) else "--",
                          label=pattern)
        axis.axhline(math.exp(-1), color="grey", linestyle=":")
        axis.set(xlabel=f"distance along a {name} [px]", xlim=(0, 60), ylim=(-0.1, 1))
    axes[0].set(ylabel="correlation of disparity errors")
    axes[0].annotate("1/e", (1, math.exp(-1) - 0.06), fontsize=8, color="grey")
    figure.suptitle(f"Flat floor, noise x {noise}")
    axes[1].legend(fontsize=8, loc="center left", bbox_to_anchor=(1.02, 0.5))
    cells = read(folder / "cells.csv")
    body = []
    for pattern in patterns:
        mine = [r for r in cells if r["pattern"] == pattern]
        sigma = next(float(r["sigma_px"]) for r in rows if r["pattern"] == pattern)
        floor = floors[pattern]
        is_drawn = pattern in drawn
        body.append([pattern, f"{100 * float(floor['matched']):.1f} %", f"{100 * float(floor['trusted']):.1f} %"] + (
            [f"{float(floor['median_sigma_px']):.2f}", f"{sigma:.2f}", lengths[pattern, "row"], lengths[pattern, "column"],
             *(f"{float(r['independent']):.1f} of {float(r['pixels_per_cell']):.0f}" for r in mine),
             f"{float(floor['correlation_between_frames']):.2f}"] if is_drawn else ["-"] * (5 + len(mine))))
    ranges = [r["range_m"] for r in cells if r["pattern"] == patterns[0]]
    return ["The next table is for flat floor nearer than about 3 m that both cameras see. The correlation length is the distance at which the "
            "correlation of the errors falls to 1/e. The columns of independent pixels state how many of the pixels of a 25 mm cell have "
            "independent errors.", ""] + table(
        ["floor pattern", "pixels with a disparity", "trusted pixels", "stated sigma of the disparity, median [px]",
         "true scatter of the disparity [px]", "correlation length along rows [px]",
         "correlation length along columns [px]", *(f"independent pixels at {r} m" for r in ranges), "correlation of the errors with those of the next frame"], body) + [
             "", save(figure, f"correlation_noise{noise}"), ""]


EXPERIMENTS = {"correlated_depth": correlated_depth}
