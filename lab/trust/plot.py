"""Table and picture of the part "trust measured" in docs/lab/matching.md: is the outlier probability true?"""
import matplotlib.pyplot as plt

from lab_figures import COLOURS, fill, read, save, table

FIRST_SEED = 75_001  # no fit used it


def trust(lab):
    """The outlier probability of our matcher against its wrong matches."""
    out = lab.folder("trust")
    lab.run("trust", lab.data, out, FIRST_SEED)
    rows = read(out / "trust.csv")
    body = [[r["image"], "fitted to" if r["use"] == "fit" else "report only", f"{r['kept']} %", f"{r['wrong']} %", f"{r['wrong_trusted']} %"]
            for r in rows]
    fill("matching", ["### Are right matches trusted, and trusted matches right?", "",
                      "A match is right if its error is at most 1 px, and wrong here if it is above 2 px. The truth of pairs without ground truth is the "
                      "match of OpenCV's HH4 where two of its settings agree within 1 px (so OpenCV's own errors count against us). Wanted on each "
                      "real pair: at least 85 % of the right matches trusted (goal 92 %), at most 1.0 % of the trusted wrong (goal 0.5 %).", ""] +
         table(["image", "use", "right matches that are trusted", "matches that are wrong", "trusted matches that are wrong"], body) +
         ["", "The picture compares the stated outlier probability with the share of matches that are wrong by more than 1 px. On the diagonal both "
              "are equal. Below the diagonal the matcher is too cautious.", "", picture(read(out / "reliability.csv")), ""], "trust measured")


def picture(rows):
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4.4), sharey=True, constrained_layout=True)
    kinds = list(dict.fromkeys(r["kind"] for r in rows))
    for axis, (use, words) in zip(axes, {"fit": "images of the fit", "report": "images that took no part in the fit"}.items()):
        axis.plot([0, 100], [0, 100], color="black", linewidth=0.8)
        for kind in kinds:
            mine = [r for r in rows if (r["kind"], r["use"]) == (kind, use)]
            if mine:
                axis.plot([float(r["stated"]) for r in mine], [float(r["wrong"]) for r in mine], marker="o", markersize=4,
                          color=COLOURS[kinds.index(kind) % len(COLOURS)], label=kind)
        axis.set(title=words, xlabel="stated outlier probability [%]", xlim=(0, 70), ylim=(0, 70))
        axis.axvline(20, color="grey", linestyle=":", linewidth=1)
    axes[0].text(20.5, 66, "limit of trust", fontsize=8, color="grey")
    axes[0].set(ylabel="matches wrong by more than 1 px [%]")
    axes[1].legend(fontsize=8)
    return save(figure, "trust_reliability")


EXPERIMENTS = {"trust": trust}
