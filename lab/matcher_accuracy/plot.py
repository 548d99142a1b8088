"""Tables of docs/lab/matching.md: our matcher and those of OpenCV on pairs with true disparities."""
import math
import statistics

import matplotlib.pyplot as plt

from lab_figures import COLOURS, fill, read, save, table

HELD_OUT_SEED, LOCKING_SEED = 60_001, 60_101  # first seeds; no tuning used them
OPENCV = "OpenCV"


def matching(lab):
    """Our matcher and those of OpenCV: settings as they come, tuned, under image faults, and near whole pixels."""
    out = lab.folder("matching")
    lab.run("matcher_accuracy", lab.data / "stereo", out)
    lab.run("matcher_tuning", lab.data / "stereo", out, HELD_OUT_SEED)
    lab.run("pixel_locking", out / "locking.csv", LOCKING_SEED)
    held_out = read(out / "held_out.csv")
    fill("matching", ["### Offset of adirondack's truth", ""] + truth_table(read(out / "truth.csv")) +
         ["", "### Default settings", ""] + pairs_table(read(out / "pairs.csv")) + [""] +
         tuned_part(read(out / "chosen.csv"), held_out) + robustness_part(held_out) + locking_part(read(out / "locking.csv")))


def truth_table(rows):
    return table(["pair and matcher: matched minus stored disparity [px]", "number of matches", "10th percentile", "25th percentile", "median",
                  "75th percentile", "90th percentile", "median of the far half", "median of the near half"],
                 [[f"{r['pair']}, {r['matcher']}", r["count"]] + [f"{float(r[key]):+.2f}" for key in
                  ("q10", "q25", "q50", "q75", "q90", "q50_far", "q50_near")] for r in rows])


def pairs_table(rows):
    """Bad-1 and bad-2 of Middlebury's pairs; where the truth has an offset, with and without it."""
    of = {(r["matcher"], r["pair"], r["truth"]): r for r in rows}
    pairs = list(dict.fromkeys(r["pair"] for r in rows))
    four = pairs[:4]
    columns = [(p, t) for p in pairs for t in ("as published", "centred") if t == "as published" or "adirondack" in p]
    body = []
    for matcher in dict.fromkeys(r["matcher"] for r in rows):
        mean = lambda key, truth: statistics.mean(float(of[matcher, p, truth][key]) for p in four)  # noqa: E731
        body.append([matcher] + [f"{float(of[matcher, p, t]['bad_1']):.1f} / {float(of[matcher, p, t]['bad_2']):.1f}"
                                 for p, t in columns] +
                    [f"{mean('bad_1', t):.2f} / {mean('bad_2', t):.2f}" for t in ("as published", "centred")] +
                    [f"{mean('density', 'centred'):.1f} %"])
    return table(["bad-1 / bad-2 [%]"] + [p if t == "as published" else f"{p}, truth + 0.5" for p, t in columns] +
                 ["mean of the first four pairs, as published", "mean of the first four pairs, truth + 0.5", "share of pixels matched"], body)


AIMS = {"chosen": "pairs and simulated images", "for pairs": "pairs alone", "for simulated": "simulated images alone"}


def tuned_part(choices, rows):
    """Every matcher after the same budget of tuning, image by image."""
    of = {(r["matcher"], r["set"]): r for r in choices}
    matchers = list(dict.fromkeys(r["matcher"] for r in choices))
    lines = ["### The best of 36 settings of each, chosen on cones, cloth3 and four simulated images", ""]
    lines += table(["matcher"] + [f"settings chosen on {words}" for words in AIMS.values()] + ["loss of the settings chosen on both", "loss of the default settings"],
                   [[m] + [of[m, aim]["words"] for aim in AIMS] + [f"{float(of[m, 'chosen'][key]):.1f}" for key in ("loss", "loss_as_it_comes")]
                    for m in matchers])
    truths = {"as published": "pairs, truth as published", "centred": "pairs, truth + 0.5 for adirondack"}
    pair, simulated = ("pair",), ("simulated",)
    parts = [(("tuned on",), "chosen", "as published", "tuned on")]
    parts += [(pair, "chosen", truth, name) for truth, name in truths.items()]
    parts += [(simulated, "chosen", "as published", "simulated"), (pair + simulated, "chosen", "centred", "all images outside the tuning, truth + 0.5")]
    parts += [(pair, "for pairs", "centred", f"{truths['centred']}; settings for pairs")]
    parts += [(simulated, "for simulated", "as published", "simulated; settings for simulated images")]
    body = []
    for kinds, aim, truth, name in parts:
        mine = [r for r in rows if r["kind"] in kinds and (r["set"], r["truth"]) == (aim, truth)]
        means_alone = len(kinds) > 1 or aim == "for simulated"
        body += held_out_rows(mine, matchers, name)[-1 if means_alone else 0:]
    return lines + ["", "The next table gives bad-1 / bad-2 [%] after filling. The last column is bad-2 of our whole matcher minus bad-2 of the best OpenCV mode on "
                    "that image (at most +0.5 is wanted). In the rows of means it is the difference to the best mean of one mode.",
                    ""] + table(["bad-1 / bad-2 [%] after filling, by image"] + matchers + ["bad-2 of ours minus bad-2 of OpenCV's best mode (its name)"], body) + [""]


def held_out_rows(rows, matchers, name):
    """One row per image, and their mean."""
    of = {(r["image"], r["matcher"]): r for r in rows}
    images = list(dict.fromkeys(r["image"] for r in rows))
    figures = {image: [[float(of[image, m][key]) for key in ("bad_1", "bad_2")] for m in matchers] for image in images}
    figures[f"**mean: {name}**"] = [[statistics.mean(column) for column in zip(*(figures[image][k] for image in images))]
                                    for k in range(len(matchers))]
    rivals = [k for k, m in enumerate(matchers) if m.startswith(OPENCV)]
    name_of = {i: f"{i}; settings for pairs" for i in images if rows[0]["set"] == "for pairs"}
    body = []
    for image, found in figures.items():
        best = min(rivals, key=lambda k: found[k][1])  # noqa: B023
        digits = 1 if image in images else 2
        body.append([name_of.get(image, image)] + [f"{bad_1:.{digits}f} / {bad_2:.{digits}f}" for bad_1, bad_2 in found] +
                    [f"{found[0][1] - found[best][1]:+.2f} ({matchers[best].removeprefix(OPENCV + ' ')})"])
    return body


IMAGE_FAULTS = {"smear": "2 px more blur in both cameras", "finger mark": "a finger mark on the left lens (4 px)", "glass": "glass",
            "sun": "sun in stripes, shadows", "sun and over-exposed": "images 2.5 times too bright",
            "right camera brighter": "right camera 1.3 times as bright", "right camera darker": "right camera 0.6 times as bright"}


def robustness_part(rows):
    """Image faults: means over the images of each fault."""
    matchers = list(dict.fromkeys((r["matcher"], r["set"]) for r in rows if not r["set"].startswith("for ")))
    matchers.sort(key=lambda m: m != ("our whole matcher", "as it comes"))
    header = ["bad-1 / bad-2 [%]"] + [name if which == "chosen" else f"{name}, default settings" for name, which in matchers]
    filled, matched = [], []
    for kind, words in IMAGE_FAULTS.items():
        of = lambda m, key: statistics.mean(float(r[key]) for r in rows if (r["kind"], r["truth"], r["matcher"], r["set"])  # noqa: E731
                                            == (kind, "as published", *m))  # noqa: B023
        filled.append([words] + [f"{of(m, 'bad_1'):.1f} / {of(m, 'bad_2'):.1f}" for m in matchers])
        matched.append([words] + [f"{of(m, 'matched_bad_1'):.1f} / {of(m, 'matched_bad_2'):.1f} of {of(m, 'density'):.0f} %" for m in matchers])
    images = {kind: list(dict.fromkeys(r["image"] for r in rows if r["kind"] == kind)) for kind in IMAGE_FAULTS}
    return ["### Image faults", "",
            "The tables give means over the images of each fault, with the simulated ZED and the settings chosen above, after filling. Every fault "
            "has its own seeds, so compare only within a row.", ""] + \
        table(["image fault", "simulated scenes"], [[words, ", ".join(images[kind])] for kind, words in IMAGE_FAULTS.items()]) + [""] + \
        table(header, filled) + ["", "The next table gives bad-1 / bad-2 of the matched pixels alone, and their share of the pixels that both cameras see:", ""] + \
        table(header, matched) + [""]


def locking_part(rows):
    """Mean errors by the fraction of a pixel."""
    matchers = list(dict.fromkeys(r["matcher"] for r in rows))
    cameras = {"ideal": "ideal camera", "zed": "noise and smear of the ZED"}
    body = []
    for camera, words in cameras.items():
        for matcher in matchers:
            mine = [r for r in rows if (r["camera"], r["matcher"]) == (camera, matcher)]
            means = [float(r["mean_px"]) for r in mine]
            counts = [int(r["count"]) for r in mine]
            rms = math.sqrt(sum(n * float(r["rms_px"]) ** 2 for n, r in zip(counts, mine)) / sum(counts))
            body.append([f"{matcher}, {words}", sum(counts)] + [f"{1e3 * mean:+.0f}" for mean in means] +
                        [f"**{1e3 * (max(means) - min(means)) / 2:.0f}**", f"{1e3 * rms:.0f}"])
    return ["### Whole pixels", "",
            "The table is for planes of rendered floors, matches within 1 px and default settings. The columns of fractions give the mean error "
            "by the fraction of the true disparity (0.0: within 0.05 px of a whole pixel).", "",
            locking_picture(rows, cameras), ""] + \
        table(["matcher and camera", "number of pixels", "mean error at fraction 0.0 [1/1000 px]"] + [f"at {k / 10:.1f} [1/1000 px]" for k in range(1, 10)] +
              ["half of the range of these means [1/1000 px]", "rms error [1/1000 px]"], body) + [""]


def locking_picture(rows, cameras):
    shown = {"our whole matcher": (COLOURS[0], "-", 2.4), "our search alone": (COLOURS[0], "--", 1.4), "OpenCV SGBM 3-way": (COLOURS[1], "-", 1.4),
             "OpenCV SGBM HH": (COLOURS[4], "-", 1.4), "OpenCV BM": (COLOURS[2], "-", 1.4)}
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 3.8), sharey=True, constrained_layout=True)
    for axis, (camera, words) in zip(axes, cameras.items()):
        axis.axhline(0, color="black", linewidth=0.8)
        for matcher, (colour, style, width) in shown.items():
            means = {int(r["tenth"]): float(r["mean_px"]) for r in rows if (r["camera"], r["matcher"]) == (camera, matcher)}
            axis.plot([k / 10 for k in range(-5, 6)], [1e3 * means[k % 10] for k in range(-5, 6)], style, color=colour,
                      linewidth=width, marker="o", markersize=3, label=matcher)
        axis.set(title=words, xlabel="true disparity minus the nearest whole pixel [px]")
    axes[0].set(ylabel="mean error of the match [1/1000 px]")
    axes[1].legend(fontsize=8, ncols=2, loc="lower center")
    figure.suptitle("A flat line means no preference for a fraction of a pixel")
    return save(figure, "pixel_locking")


EXPERIMENTS = {"matching": matching}
