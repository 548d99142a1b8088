"""Tables of docs/lab/boards.md: finders of chessboards, rigs of wide lenses, lens models suggested."""
import collections
import statistics

from lab_figures import fill, read, table

FINDER_SEEDS = (9_001,)  # no setting was chosen with these
RIG_SEEDS = (9_004, 9_005, 9_006)
IMAGE_SETS = (("chess_fisheye", "calibration/chess_fisheye", "chessboard:9x6:0.02423"),
              ("chess_pinhole", "calibration/chess_pinhole", "chessboard:9x6:1"),
              ("bumblebee_chess", "real/bumblebee_chess", "chessboard:4x6:0.03"),
              ("mrpt_boards", "real/mrpt_boards", "chessboard:9x6:0.03"))
FINDER_TITLES = {"ours": "our finder: boards correct (reported)", "SB": "OpenCV SB", "SB exhaustive": "OpenCV SB, exhaustive search",
                 "SB accuracy": "OpenCV SB, accuracy flag", "classic, fast check": "OpenCV classic, fast check", "classic": "OpenCV classic"}
EMPTY_SETS = (("garden_walk", "real/garden_walk", "chessboard:9x6:0.03"),
              ("bumblebee_pairs", "real/bumblebee_pairs", "chessboard:9x6:0.03"))


def measure(lab):
    """Runs the missing measurements. Returns the rows of the finders, of images without a board, of rigs and of suggestions."""
    folder = lab.folder("boards")

    def kept(name, *words):
        path = folder / f"{name}.csv"
        if not path.exists() and not lab.redraw:
            part = path.with_suffix(".part")
            lab.run("board_finders", part, *words)
            part.rename(path)
        return read(path) if path.exists() else []

    found = [row for seed in FINDER_SEEDS for row in kept(f"rendered_{seed}", "rendered", seed, 1)]
    for name, where, board in IMAGE_SETS:
        found += kept(name, "images", name, lab.data / where, board)
    empty = [row for name, where, board in EMPTY_SETS
             for row in kept(name, "images", name, lab.data / where, board, "ours")]
    rigs, advice = [], []
    for seed in RIG_SEEDS:
        own = folder / f"rigs_{seed}"
        if not (own / "done").exists() and not lab.redraw:
            lab.run("wide_rigs", own, seed, 1)
            (own / "done").touch()
        if (own / "done").exists():
            rigs += read(own / "rigs.csv")
            advice += read(own / "advice.csv")
    return found, empty, rigs, advice


def finder_rows(rows):
    """Boards found by each finder. A rendered board counts when every corner lies within 1.5 px of the true one; brackets: all found."""
    finders = list(dict.fromkeys(r["finder"] for r in rows))
    is_rendered = lambda name: " deg " in name  # noqa: E731
    groups = collections.OrderedDict()
    for row in rows:
        groups.setdefault(row["set"], []).append(row)
        if is_rendered(row["set"]):
            condition = row["image"].rsplit(" ", 1)[0]
            groups.setdefault(f"condition: {condition}", []).append(row)
            groups.setdefault("all rendered", []).append(row)
    order = sorted(groups, key=lambda name: (not is_rendered(name), not name.startswith("condition"), name != "all rendered"))
    body = []
    for name in order:
        mine = groups[name]
        cells = []
        for finder in finders:
            own = [r for r in mine if r["finder"] == finder]
            found, right = (sum(int(r[key]) for r in own) for key in ("found", "right"))
            rendered = is_rendered(own[0]["set"])
            cells.append(f"{right} ({found})" if rendered else str(found))
        body.append([name, sum(r["finder"] == finders[0] for r in mine)] + cells)
    times = []
    for finder in finders:
        ms = sorted(float(r["ms"]) for r in rows if r["finder"] == finder)
        times.append(f"{statistics.median(ms):.0f} / {ms[-1]:.0f}")
    body.append(["time per image [ms]: median / longest", len(rows) // len(finders)] + times)
    return ["set or image condition", "images"] + [FINDER_TITLES.get(finder, finder) for finder in finders], body


def empty_rows(rows):
    body = []
    for name in dict.fromkeys(r["set"] for r in rows):
        mine = [r for r in rows if r["set"] == name]
        ms = sorted(float(r["ms"]) for r in mine)
        body.append([name, len(mine), sum(int(r["found"]) for r in mine), f"{statistics.median(ms):.0f} / {ms[-1]:.0f}"])
    return ["image set without a board", "images", "boards reported", "time per image [ms]: median / longest"], body


def within(rows, error, sigma, times):
    known = [(abs(float(r[error])), float(r[sigma])) for r in rows if r[error] != "nan"]
    return f"{sum(e <= times * s for e, s in known)} of {len(known)}"


def rig_rows(rows):
    body = []
    for name in [*dict.fromkeys(r["lens"] for r in rows), "all"]:
        mine = [r for r in rows if name in (r["lens"], "all")]
        shares = [float(r["baseline_mm"]) / float(r["baseline_sigma_mm"]) for r in mine]
        depths = [float(r["depth_mm"]) / float(r["depth_sigma_mm"]) for r in mine if r["depth_mm"] != "nan"]
        body.append([name, len(mine), f"{sum(int(r['pairs']) for r in mine)} of {sum(int(r['shown']) for r in mine)}",
                     f"{statistics.median(float(r['baseline_sigma_mm']) for r in mine):.3f}",
                     within(mine, "baseline_mm", "baseline_sigma_mm", 3), f"{max(map(abs, shares)):.1f}",
                     f"{statistics.median(float(r['depth_sigma_mm']) for r in mine):.2f}",
                     within(mine, "depth_mm", "depth_sigma_mm", 3), f"{max(map(abs, depths)):.1f}"])
    return ["lens: angle of view and profile", "rigs", "image pairs used", "baseline: stated sigma, median [mm]", "baseline errors within 3 sigma", "largest baseline error [sigma]",
            "depth at 1 m: stated sigma, median [mm]", "depth errors within 3 sigma", "largest depth error [sigma]"], body


def advice_rows(rows):
    """One row per lens and chosen model: the suggested models, and the errors of both on boards that the fit did not use."""
    body = []
    for lens, chosen in dict.fromkeys((r["lens"], r["chosen"]) for r in rows):
        mine = [r for r in rows if (r["lens"], r["chosen"]) == (lens, chosen)]
        counts = collections.Counter(r["suggested"] or "none" for r in mine)
        pixels = [f"{float(r['better_px']):.2f} / {float(r['chosen_px']):.2f}" for r in mine if r["suggested"]]
        body.append([lens, mine[0]["kind"], chosen, ", ".join(f"{n} {name}" for name, n in counts.items()),
                     ", ".join(pixels) or "-", f"{sum(int(r['calibrated']) for r in mine)} of {len(mine)}"])
    return ["lens: angle of view and profile", "true model", "chosen model", "suggested model, number of rigs",
            "rms of the suggested / chosen model, one pair per suggestion [px]", "rigs calibrated with the chosen model"], body


def boards(lab):
    """Chessboards through wide lenses: finders, stated sigma, suggested lens models."""
    found, empty, rigs, advice = measure(lab)
    text = []
    for title, rows, make in (("Boards found", found, finder_rows), ("Images without a board", empty, empty_rows),
                              ("Rigs of wide lenses", rigs, rig_rows), ("Suggested lens models", advice, advice_rows)):
        text += ["", f"### {title}", ""]
        text += table(*make(rows)) if rows else ["Not measured yet."]
    fill("boards", text[1:])


EXPERIMENTS = {"boards": boards}
