"""Tables of docs/lab/memory_scripts.md: answers of the gate about ground that only its memory holds."""
import collections

from lab_figures import bound_of, fill, quantile, read, table

MEMORY_SEEDS = (75_301, 30)
STATED = {"own": "sound odometry", "told": "grows with the error"}


def memory_scripts(lab):
    """Answers of the gate about ground that was seen before a turn. The results are kept seed by seed, because a run takes hours."""
    rows = []
    first, seeds = MEMORY_SEEDS
    for seed in range(first, first + seeds):
        file = lab.folder("memory_scripts") / f"{seed}.csv"
        if not file.with_suffix(".done").exists() and not lab.redraw:
            lab.run("memory_scripts", file, seed, 1)
            file.with_suffix(".done").touch()
        if file.with_suffix(".done").exists():
            rows += read(file)
    fill("memory_scripts", memory_table(rows) + [""] + memory_reasons(rows))


def memory_table(rows):
    """Answers to the steps that the script tests, and to the steps on the way to them."""
    groups = collections.defaultdict(list)
    for r in rows:
        groups[r["script"], r["pitch_deg"], float(r["drift_percent"]), r["stated"]].append(r)
    body = []
    for (script, pitch, drift, stated), mine in sorted(groups.items()):
        clear = [r for r in mine if r["clear"] == "1"]
        way = [r for r in clear if r["asked"] == "0" and r["safe"] == "1"]
        allowed = lambda some: sum(r["verdict"] == "OK" for r in some)  # noqa: E731
        for holes in ("seen", "filled"):
            asked = [r for r in clear if r["asked"] == "1" and r["holes"] == holes]
            if not asked:
                continue
            danger, safe = [r for r in asked if r["safe"] == "0"], [r for r in asked if r["safe"] == "1"]
            away = [float(r["off_mm"]) for r in asked]
            body.append([script if holes == "seen" else f"{script}, filled", f"{pitch} deg", f"{drift:g} %",
                         STATED[stated] if drift else "-", len({r["seed"] for r in mine}),
                         bound_of(allowed(danger), len(danger)), f"{allowed(safe)} of {len(safe)}",
                         f"{allowed(way)} of {len(way)}" if holes == "seen" else "-", f"{quantile(away, 0.5):.0f} / {quantile(away, 1.0):.0f}"])
    return table(["script", "camera pitch, down", "drift of the odometry", "stated covariance (`-`: no drift)", "number of seeds",
                  "dangerous steps allowed (upper bound)", "safe steps allowed", "safe steps on the way allowed",
                  "pose error, median / largest [mm]"], body)


def memory_reasons(rows):
    """Reasons of the safe steps that were refused without drift, and the dangerous steps that were allowed."""
    cells = collections.defaultdict(list)
    for r in rows:
        if r["clear"] == "1" and r["safe"] == "1" and r["verdict"] != "OK" and float(r["drift_percent"]) == 0:
            script = r["script"] if r["holes"] == "seen" else r["script"] + ", filled"
            cells[script, r["pitch_deg"], "asked" if r["asked"] == "1" else "on the way", r["primary"]].append(r)
    body = [[script, f"{pitch} deg", step, reason, len(mine), memory_cell(mine[0])]
            for (script, pitch, step, reason), mine in sorted(cells.items(), key=lambda c: (c[0][:3], -len(c[1])))]
    missed = [r for r in rows if r["clear"] == "1" and r["safe"] == "0" and r["verdict"] == "OK"]
    lines = ["Safe steps that were refused without drift. *Asked* steps are those of the question; steps *on the way* lead there. "
             "The example gives the first cell that inhibits, from base_link:", ""]
    lines += table(["script", "camera pitch, down", "step asked or on the way", "first reason", "refused steps",
                    "example: seed, step, movement; cell; measured value and limit; all reasons"], body)
    if missed:
        lines += ["", "The table lists the dangerous steps that the gate allowed:", ""]
        lines += table(["script", "camera pitch, down [deg]", "seed", "step", "movement", "danger", "drift, stated covariance", "pose error [mm]", "stated drift [mm]"],
                       [[r["script"] if r["holes"] == "seen" else r["script"] + ", filled", r["pitch_deg"], r["seed"], r["step"], r["command"], r["danger"],
                         f"{float(r['drift_percent']):g} %, {STATED[r['stated']]}", r["off_mm"], r["stated_drift_mm"]] for r in missed])
    return lines


def memory_cell(row):
    where = "no cell" if row["forward_m"] == "nan" else f"cell {row['forward_m']} m ahead, {row['left_m']} m left"
    return f"seed {row['seed']}, step {row['step']}, movement {row['command']}: {where}; {row['value_mm']} mm, limit {row['limit_mm']} mm; {row['reasons']}"


EXPERIMENTS = {"memory_scripts": memory_scripts}
