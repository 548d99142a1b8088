"""Compares `surefoot depth` and its stated sigma with real rectified pairs of known disparity.

Only pixels that both cameras see are judged. If the truth of the right camera exists, both truths must agree within 1 px; else
the pair's mask decides. Errors above 2 px are counted as in the benchmark of these pairs: pixels without a match take the
smaller neighbour in their row. Trusted = outlier probability of at most 0.2; all trusted pixels count. The rounding of
the truth (uniform over a step) is added to sigma.
"""
import dataclasses

import cv2
import numpy as np

TRUSTED = 0.2
SIGMA_LIMITS = ((63, 73), (90, 97), (97, 100))  # % of the trusted pixels within one, two, three sigma


@dataclasses.dataclass
class Pair:
    name: str
    folder: str
    right: str
    truth: str
    scale: float  # stored truth / disparity
    disparities: int
    right_truth: str = ""
    mask: str = ""
    judges_sigma: bool = True  # False for a truth that is truncated to whole pixels


PAIRS = (
    Pair("cones", "cones", "right.png", "disp_left_x4.png", 4, 64, right_truth="disp_right_x4.png"),
    Pair("teddy", "teddy", "right.png", "disp_left_x4.png", 4, 64, right_truth="disp_right_x4.png"),
    Pair("cloth3", "cloth3", "right.png", "disp_left.png", 2, 96, right_truth="disp_right.png"),
    Pair("adirondack", "adirondack", "right.png", "gt.png", 1, 96, mask="mask.png",
         judges_sigma=False),
    Pair("adirondack, right camera exposed differently", "adirondack", "rightE.png", "gt.png", 1, 96, mask="mask.png",
         judges_sigma=False),
)


def read_pfm(path):
    """Reads the rows from the top; unknown = +inf."""
    with open(path, "rb") as file:
        kind, size, scale = file.readline().strip(), file.readline().split(), float(file.readline())
        width, height = map(int, size)
        if kind != b"Pf" or scale >= 0:
            raise SystemExit(f"{path}: not a grey little-endian PFM")
        return np.frombuffer(file.read(), "<f4").reshape(height, width)[::-1]


def grey(path):
    image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise SystemExit(f"{path}: not a readable image")
    return image


def true_disparity(pair, folder):
    """True disparities [px]; NaN = unknown or not seen by both cameras."""
    values = grey(folder / pair.truth)
    truth = np.where(values > 0, values / pair.scale, np.nan)
    if pair.mask:
        return np.where(grey(folder / pair.mask) > 200, truth, np.nan)
    other = grey(folder / pair.right_truth) / pair.scale
    v, u = np.indices(truth.shape)
    x = np.floor(u - np.nan_to_num(truth) + 0.5).astype(int)
    inside = (x >= 0) & (x < truth.shape[1])
    seen = np.where(inside, other[v, np.where(inside, x, 0)], 0)
    return np.where((seen > 0) & (np.abs(seen - truth) <= 1), truth, np.nan)


def filled(disparity):
    """Fills unknown pixels with the smaller of the nearest known neighbours in the row."""
    def from_left(image):
        u = np.where(np.isfinite(image), np.arange(image.shape[1]), 0)
        u = np.maximum.accumulate(u, axis=1)
        return np.take_along_axis(image, u, axis=1)
    return np.minimum(from_left(disparity), from_left(disparity[:, ::-1])[:, ::-1])


def measure(pair, folder, out):
    """Results for the output folder `out` of `surefoot depth`, in percent of the judged pixels."""
    truth = true_disparity(pair, folder)
    disparity, sigma, outlier = (read_pfm(out / f"{name}.pfm") for name in ("disparity", "sigma", "outlier_probability"))
    judged, known = np.isfinite(truth), np.isfinite(disparity)
    trusted = judged & known & (outlier <= TRUSTED)
    sigma_px = np.hypot(sigma[trusted], 1 / pair.scale / np.sqrt(12))
    sigmas = np.abs(disparity[trusted] - truth[trusted]) / sigma_px
    wrong = ~(np.abs(filled(disparity)[judged] - truth[judged]) <= 2)
    return {"density": 100 * np.mean(known[judged]), "bad_2": 100 * np.mean(wrong),
            "trusted": 100 * np.mean(trusted[judged]),
            "within": [100 * np.mean(sigmas <= k) for k in (1, 2, 3)]}
