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
             *(f"{r[f'within_{k}']} %" for k in (1, 2, 3)), f"{float(r['auc_sigma']):.3f}", f"{float(r['auc_peak']):.3f}",
             f"{100 * (1 - float(r['auc_sigma']) / float(r['auc_peak'])):+.0f} %"] for r in read(out / "sigma.csv")]
    return ["### Does the stated sigma agree with the errors?", "",
            "The table gives the share of trusted matches within 1, 2 and 3 stated sigma, of those that are right within 1 px; the rounding of the truth is added to sigma. "
            "Wanted are 63-73 % within 1 sigma, 90-97 % within 2 sigma and at least 97 % within 3 sigma. "
            "AUC is the area under the sparsification curve of all matches (0 = perfect order). Our order uses sigma and outlier probability; "
            "the other order uses the peak ratio. Rows with \"all\" take the matches of all images of a kind together. "
            "\"Zed x 2\" means the simulated ZED at twice its noise.", ""] + \
        table(["images", "share of pixels matched", "within 1 sigma", "within 2 sigma", "within 3 sigma", "AUC, our order",
               "AUC, order by peak ratio", "our order better by"], body) + [""]


EXPERIMENTS = {"matching_sigma": matching_sigma}
