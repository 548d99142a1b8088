"""Tables of docs/lab/calibration.md: lenses and rigs against the truth, and real boards."""
import json
import math
import statistics
import subprocess

from lab_figures import fill, read, table

CALIBRATION_SEEDS = (70_001, 3)  # no setting was chosen with these
CALIBRATION_LENSES = ("pinhole4", "pinhole5", "rational", "fisheye")
CALIBRATION_REAL = (("chess_pinhole", "chessboard:9x6:1", "pinhole5", 13, 0.215, 0.165),
                    ("chess_pinhole", "chessboard:9x6:1", "rational", 13, 0.215, 0.165),
                    ("chess_fisheye", "chessboard:9x6:0.02423", "fisheye", 19, 0.336, 0.65))


def calibration(lab):
    """Lenses and rigs from pictures of boards against the truth, and real sets against the required limits."""
    lenses, rigs = [], []
    for lens in CALIBRATION_LENSES:
        folder = lab.folder(f"calibration/{lens}")
        if not (folder / "done").exists():  # a long run: its result is kept
            if lab.redraw:
                continue
            lab.run("calibration_truth", folder, *CALIBRATION_SEEDS, lens)
            (folder / "done").touch()
        lenses += read(folder / "lenses.csv")
        rigs += read(folder / "rigs.csv")
    missing = [lens for lens in CALIBRATION_LENSES if all(r["lens"] != lens for r in lenses)]
    unmeasured = ["Not measured yet: " + ", ".join(missing) + ".", ""] if missing else []
    fill("calibration", ["### Lenses", ""] + unmeasured + calibration_lenses(lenses) + ["", "### Rigs", ""] + calibration_rigs(rigs) +
         ["", "### Real pairs", ""] + calibration_real(lab) +
         ["", "### Boards that the calibration did not use", ""] + calibration_held_out(lab))


def calibration_lenses(rows):
    body = []
    for lens in CALIBRATION_LENSES:
        for board in dict.fromkeys(r["board"] for r in rows):
            mine = [r for r in rows if (r["lens"], r["board"]) == (lens, board)]
            total = lambda key: sum(int(r[key]) for r in mine)  # noqa: E731
            each = lambda key, digits: ", ".join(f"{float(r[key]):.{digits}f}" for r in mine)  # noqa: E731
            if mine:
                body.append([lens, board, f"{len(mine)} of {CALIBRATION_SEEDS[1]}", each("noise_px", 3),
                             f"{100 * total('beyond') / total('pixels'):.2f} %", each("largest_sigmas", 1), total("without"),
                             each("median_px", 2), each("mean_square", 1)])
    return table(["lens model", "board (kind:columns x rows:square side [m]:marker side [m])", "seeds calibrated", "corner noise of each seed [px]", "pixels beyond 3 sigma",
                  "largest error of each seed [sigma]", "pixels that the estimate does not map",
                  "median error of each seed [px]", "mean squared Mahalanobis distance of each seed (2 expected)"], body)


def calibration_rigs(rows):
    body = []
    for r in rows:
        baseline, sigma, turn, turn_sigma = (float(r[key]) for key in ("baseline_mm", "baseline_sigma_mm", "turn_mrad", "turn_sigma_mrad"))
        square = float(r["mahalanobis_sq"])
        within = abs(baseline) < 3 * sigma and turn < 3 * turn_sigma and square < 20.06
        body.append([r["lens"], r["seed"], f"{baseline:+.3f} ({sigma:.3f})", f"{turn:.3f} ({turn_sigma:.3f})", f"{square:.1f}",
                     "yes" if within else "**no**"])
    return table(["lens model", "seed", "baseline error (stated sigma) [mm]", "largest rotation error (stated sigma) [mrad]", "squared Mahalanobis distance (6 expected)",
                  "within 3 sigma"], body)


def calibration_real(lab):
    body = []
    for name, board, model, pairs, rms, rows in CALIBRATION_REAL:
        out = lab.folder(f"calibration/{name}_{model}")
        answer = out / "answer.json"
        if not answer.exists() and not lab.redraw:
            said = subprocess.run([str(lab.build / "bin/surefoot"), "calibrate", "stereo",
                                   str(lab.data / "calibration" / name), "--board", board, "--model", model, "--out", str(out),
                                   "--json"], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            answer.write_text(said.stdout)
        if not answer.exists():
            body.append([name, model, "not measured yet", "-", "-", "-", "-", "-"])
            continue
        found = json.loads(answer.read_text())
        left_out = [r["view"] for r in found["rejected"]]
        met = found["used"] >= pairs and found["rms_px"] <= rms and found["row_rms_px"] <= rows
        body.append([name, model, f"{found['used']} of {found['views']} ({pairs})", f"{found['rms_px']:.4f} ({rms})",
                     f"{found['row_rms_px']:.4f} ({rows})", f"{found['row_focal_px']:.0f}", ", ".join(map(str, left_out)) or "none",
                     "yes" if met else "**no**"])
    return table(["set", "lens model", "pairs used (at least)", "joint reprojection rms (at most) [px]", "row error rms (at most) [px]",
                  "mean focal length to which the row error refers [px]", "views left out", "limits met"], body)


def calibration_held_out(lab):
    """Depth and lengths of real boards, nearest third first. The reference thesis (Lange 2016) measured a length of 50 mm."""
    body = []
    for name, board, model, *_ in CALIBRATION_REAL:
        if model == "rational":
            continue
        out = lab.folder("calibration") / f"held_out_{name}.csv"
        if not out.exists() and not lab.redraw:
            part = out.with_suffix(".part")
            lab.run("held_out_boards", part, lab.data / "calibration" / name, board, model)
            part.rename(out)
        if not out.exists():
            body.append([name, "not measured yet"] + ["-"] * 7)
            continue
        rows = sorted(read(out), key=lambda r: float(r["distance"]))
        square = float(board.split(":")[2])
        ends = [round(len(rows) * k / 3) for k in range(4)]
        body += [held_out_row(name, rows[first:last], square, square != 1.0) for first, last in zip(ends, ends[1:])]
    return table(["set", "distance of the board", "pairs", "depth error, mean", "depth error, rms", "rms scatter of corner depths about the plane of the board",
                  "error of a length of 50 mm: mean [mm]", "error of a length of 50 mm: rms [mm]", "scatter of single lengths [mm]"], body)


def held_out_row(name, rows, square, in_metres):
    """`in_metres`: false for a board whose squares were not measured; its errors are relative only."""
    of = lambda key: [float(r[key]) for r in rows]  # noqa: E731
    rms = lambda values: math.sqrt(statistics.mean(v * v for v in values))  # noqa: E731
    distances = of("distance")

    def depth(summary, key, sign):
        share = f"{100 * summary([v / d for v, d in zip(of(key), distances)]):{sign}.2f} %"
        return f"{1e3 * summary(of(key)):{sign}.2f} mm ({share})" if in_metres else share

    lengths = lambda summary, key, sign: f"{50 * summary(of(key)) / square:{sign}.2f}"  # noqa: E731
    unit, factor = ("m", 1) if in_metres else ("squares", 1 / square)
    return [name, f"{factor * distances[0]:.2f}-{factor * distances[-1]:.2f} {unit}", len(rows),
            depth(statistics.mean, "axial", "+"), depth(rms, "axial", ""), depth(rms, "axial_std", ""),
            lengths(statistics.mean, "lateral", "+"), lengths(rms, "lateral", ""), lengths(rms, "lateral_std", "")]


EXPERIMENTS = {"calibration": calibration}
