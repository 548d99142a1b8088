"""Table of the part "search" in docs/lab/ground.md: the ground plane without a known mount, on analytic depth."""
import statistics

from lab_figures import fill, read, table


def search_row(name, rows):
    right = [r for r in rows if r["accepted"] == "1" and r["wrong"] == "0"]
    wrong = sum(r["wrong"] == "1" for r in rows)
    nees = [float(r["nees_tilt"]) / 2 for r in right]
    both = [f"{statistics.mean(nees):.2f}", f"{statistics.median(nees):.2f}"] if nees else ["-", "-"]
    return [name, len(rows), len(right), wrong, len(rows) - len(right) - wrong, *both]


def ground_search(lab):
    """The ground plane found with a camera of unknown mounting, on analytic depth."""
    out = lab.folder("ground_search") / "views.csv"
    lab.run("ground_search", out, 1001, 200)
    rows = read(out)
    share = lambda r: float(r["floor_share"])  # noqa: E731
    of = lambda kind: [r for r in rows if r["kind"] == kind]  # noqa: E731
    within = lambda some, key, low, high: [r for r in some if low <= float(r[key]) < high]  # noqa: E731
    floors = of("floor")
    shown = [r for r in floors if share(r) >= 0.08]
    lines = [search_row("floor, 8 % of the image or more", shown)]
    lines += [search_row(f"tilt {a}-{b} deg", within(shown, "pitch_deg", a, b + (b == 60))) for a, b in ((0, 15), (15, 30), (30, 45), (45, 60))]
    lines += [search_row(f"height {a}-{b} m", within(shown, "height_m", a, b + (b == 2.0))) for a, b in ((0.3, 0.6), (0.6, 1.2), (1.2, 2.0))]
    lines += [search_row(f"floor share {a}-{b} %", within(floors, "floor_share", a / 100, b / 100 + (b == 100))) for a, b in ((0, 8), (8, 15), (15, 30), (30, 60), (60, 100))]
    lines += [search_row("uneven floor, 8 % or more", [r for r in shown if float(r["relief_mm"]) > 0]),
              search_row("even floor, 8 % or more", [r for r in shown if float(r["relief_mm"]) == 0])]
    lines += [search_row(f"{kind}, floor visible (4 % or more)", [r for r in of(kind) if share(r) >= 0.04]) for kind in ("table", "bed")]
    lines += [search_row("walls, no floor", of("wall")),
              search_row("a table or a bed hides the floor", of("full_table") + [r for r in of("table") + of("bed") if share(r) < 0.04])]
    fill("ground", table(["group of views", "number of views", "ground found", "wrong plane found", "no plane found",
                          "NEES of the tilt per degree of freedom (1 expected), mean", "NEES of the tilt per degree of freedom (1 expected), median"], lines), "search")


EXPERIMENTS = {"ground_search": ground_search}
