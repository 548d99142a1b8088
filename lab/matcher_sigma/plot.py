"""Table of the part "sigma measured" in docs/lab/matching.md: the stated sigma against the errors."""

from lab_figures import fill, read, table

FIRST_SEED = 70_101  # no tuning used it


def matching_sigma(lab):
    """The stated sigma of our matcher against its errors."""
    out = lab.folder("matching")
    lab.run("matcher_sigma", lab.data / "stereo", out, FIRST_SEED)
    fill("matching", sigma_part(out), "sigma measured")


def sigma_part(out):
    body = [[r["source"] if r["kind"] == "image" else f"**all: {r['source']}**", f"{float(r['density']):.1f} %",
             f"{r['within_1']} / {r['within_2']} / {r['within_3']} %", f"{float(r['auc_sigma']):.3f}", f"{float(r['auc_peak']):.3f}",
             f"{100 * (1 - float(r['auc_sigma']) / float(r['auc_peak'])):+.0f} %"] for r in read(out / "sigma.csv")]
    return ["### Does it know?", "",
            "Trusted matches within one, two and three sigma (63-73 / 90-97 / at least 97 % are wanted; the truth's rounding is "
            "added to sigma), and the sparsification of all matches (0 = perfect order) by sigma and outlier probability, and by "
            "the peak ratio; \"all\": the matches of all images of a kind in one order:", ""] + \
        table(["images", "density", "within 1 / 2 / 3 sigma", "AUC, ours", "AUC, peak ratio", "better by"], body) + [""]


EXPERIMENTS = {"matching_sigma": matching_sigma}
