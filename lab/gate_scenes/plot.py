"""Tables and picture of docs/lab/gate_scenes.md: hazards that the gate misses, and safe movements that it refuses."""
import collections
import concurrent.futures
import csv
import math
import statistics

import matplotlib
import matplotlib.pyplot as plt

from lab_figures import COLOURS, DOCS, ROOT, bound_of, fill, quantile, read, save_at, table

GATE_SEED, GATE_SCENES = 77_001, 30_000  # scenes of each kind on maps
# Runs: first seed, wanted number of hazards of all kinds together, title.
GATE_RUNS = {"depth": (86_001, 3_000, "Maps of runs on analytic depth"),
             "images": (86_503, 300, "Maps of runs of the whole chain, from images of 672 x 376 px"),
             "large": (86_701, 300, "Maps of runs of the whole chain, from images of 1280 x 720 px")}
EARLIER_MATCHER = "Maps of runs of the whole chain, from images of 672 x 376 px, with the matcher before the search from coarse to fine"
GATE_KEPT = DOCS / "gate_runs.csv"  # results of hours, from more than one computer
GATE_KEPT_MISSES = DOCS / "gate_runs_misses.csv"
GATE_CURVE_SEEDS, GATE_CURVE_SCENES = range(21, 25), 50
GATE_DRIFT = (21, 150)  # seed, scenes
GATE_KINDS = ["stairs_down", "stairs_up", "kerb", "hole", "platform", "wall", "table", "sill", "unseen", "person"]
NOISE_RUNS = ((1, 21, 8), (2, 31, 2))  # factor on the images' noise, first seed, seeds


def gate_scenes(lab):
    """Hazards that the gate misses, and safe movements that it refuses, on drawn maps."""
    folder = lab.folder("gate_scenes")
    for noise, first, seeds in NOISE_RUNS:
        file = folder / f"map_noise_{noise}.csv"
        if not file.exists():
            part = file.with_suffix(".part")
            lab.run("map_noise_fit", part, folder / "map_noise", first, seeds, noise)
            if not lab.redraw:
                part.rename(file)
    for seed in GATE_CURVE_SEEDS:
        lab.run("gate_scenes", "curve", folder, seed, GATE_CURVE_SCENES, ",".join(k for k in GATE_KINDS if k != "unseen"))
    lab.run("gate_scenes", "drift", folder, *GATE_DRIFT, ",".join(k for k in GATE_KINDS if k != "unseen"))
    lab.run("gate_scenes", "maps", folder, GATE_SEED, GATE_SCENES)  # hours; a stopped run is continued

    maps = gate_counts(folder / "maps")
    lines = ["### Map level: hazards that were allowed", ""] + gate_missed_table(maps, ("noise 0", "noise 1", "noise 2", "overconfident"))
    lines += ["", "### Map level: safe movements that were refused", ""] + gate_stops_table(maps, ("noise 0", "noise 1", "noise 2", "overconfident"))
    lines += ["", "Reasons of the refused safe movements at noise 1, without `unseen`. One refusal may have several reasons "
              "(`alone`: the only reason; `proof`: a proof that failed; `reason`: any reason):", ""]
    lines += gate_reasons_table(maps, "noise 1")
    lines += ["", "### All 26 movements, every hundredth scene", ""] + gate_all_table(maps, ("noise 0", "noise 1", "noise 2", "overconfident"))
    fill("gate_scenes", lines)
    fill("gate_scenes", gate_curve(gate_counts(folder / "curve")), "curve")
    fill("gate_scenes", gate_drift(gate_counts(folder / "drift")), "drift")
    fill("gate_scenes", map_noise_table(folder), "noise")
    fill("gate_scenes", gate_misses([("maps", *miss) for miss in misses_of(folder / "maps")]), "misses")


def gate_runs(lab):
    """The same scenes on maps of whole runs. Each computer has its own seed; the counts of all computers are kept."""
    lines, misses = [], []
    for tier, (first_seed, wanted, _) in reversed(GATE_RUNS.items()):  # the shorter tier first
        folder = lab.folder(f"gate_runs/{tier}")
        if not lab.redraw:
            lab.set_aside_older_results("gate_scenes", folder)
            run_gate_tier(lab, tier, folder, first_seed, wanted)
        keep_gate_runs(tier, folder)
    tables = [(title, kept_gate_runs(tier, first)) for tier, (first, _, title) in GATE_RUNS.items()]
    first_now = GATE_RUNS["images"][0]
    tables.append((EARLIER_MATCHER, [row for row in kept_gate_runs("images") if int(row["seed"]) < first_now]))
    for title, rows in tables:
        counts = collections.defaultdict(collections.Counter)
        for row in rows:
            counts[row["kind"], row["variant"]][row["what"]] += int(row["count"])
        lines += ["", f"### {title}", ""]
        if not rows:
            lines.append("Not run yet.")
            continue
        programs = len({row["program"] for row in rows})
        lines += [f"Seeds {', '.join(sorted({row['seed'] for row in rows}))}; {programs} program{'s' * (programs != 1)}.", ""]
        lines += gate_runs_table(counts)
        reasons = gate_reasons_table(counts, "noise 1")
        if len(reasons) > 2:  # more than the heading
            lines += ["", "Reasons of the refused safe movements above (movement of the scene, without `unseen`). "
                      "One refusal may have several reasons (`alone`: the only reason; `proof`: a proof that failed; `reason`: any reason):", ""] + reasons
    if GATE_KEPT_MISSES.exists():
        misses = [(row["tier"], *(row[name] for name in MISS)) for row in read(GATE_KEPT_MISSES)]
    fill("gate_scenes", lines[1:], "runs")
    fill("gate_scenes", gate_misses(misses), "run misses")


def run_gate_tier(lab, tier, folder, first_seed, wanted):
    """Runs half of the kinds on each of two cores."""
    mark = folder / "seed.txt"
    others = [row for row in kept_gate_runs(tier, first_seed) if not mark.exists() or row["seed"] != mark.read_text()]
    if not mark.exists():
        mark.write_text(str(max([first_seed - 1, *(int(row["seed"]) for row in others)]) + 1))
    of_kind = collections.Counter()
    for row in others:
        of_kind[row["kind"]] += int(row["count"]) * (row["what"] == "hazards")
    if sum(of_kind.values()) >= wanted:
        return
    # About one run in fifty ends where the hazard is no longer clear, so a few more are asked for.
    scenes = math.ceil(1.05 * wanted / len(GATE_KINDS)) - min(of_kind[kind] for kind in GATE_KINDS)
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        halves = [pool.submit(lab.run, "gate_scenes", tier, folder.parent, mark.read_text(), scenes, ",".join(GATE_KINDS[i::2])) for i in (0, 1)]
        for half in halves:
            half.result()


def kept_gate_runs(tier, first_seed=0):
    rows = read(GATE_KEPT) if GATE_KEPT.exists() else []
    return [row for row in rows if row["tier"] == tier and int(row["seed"]) >= first_seed]


def keep_gate_runs(tier, folder):
    """Replaces the kept counts of this computer; the counts of other computers stay."""
    if not (folder / "seed.txt").exists():
        return
    own = {"tier": tier, "seed": (folder / "seed.txt").read_text()}
    program = (folder / "program.txt").read_text()
    rows = [own | {"program": program, "kind": kind, "variant": variant, "what": what, "count": count}
            for (kind, variant), counts in sorted(gate_counts(folder).items()) for what, count in sorted(counts.items())]
    replace_rows(GATE_KEPT, own, rows)
    misses = [dict(zip(("tier", "seed", *MISS), (tier, own["seed"], *miss))) for miss in misses_of(folder)]
    if misses or GATE_KEPT_MISSES.exists():
        replace_rows(GATE_KEPT_MISSES, own, misses)


def replace_rows(path, own, rows):
    others = [row for row in read(path) if any(row[key] != value for key, value in own.items())] if path.exists() else []
    if not others + rows:
        return
    with open(path, "w", newline="") as file:
        lines = csv.DictWriter(file, (others + rows)[0], lineterminator="\n")
        lines.writeheader()
        lines.writerows(others + rows)


MISS = ("kind", "variant", "danger", "command", "scene_seed", "sentence")


def misses_of(folder):
    return [(row["kind"], row["variant"], row["danger"], row["command"], row["seed"], row["sentence"])
            for file in sorted(folder.glob("*.misses.csv")) for row in read(file)]


def gate_counts(folder):
    """{(kind, variant): {what: count}} of all CSV files of a folder."""
    counts = collections.defaultdict(collections.Counter)
    for file in sorted(folder.glob("*.csv")) if folder.exists() else ():
        if not file.name.endswith("misses.csv"):
            for row in read(file):
                counts[row["kind"], row["variant"]][row["what"]] += int(row["count"])
    return counts


def percent(part, whole):
    return f"{100 * part / whole:.1f} %" if whole else "-"


def gate_missed_table(counts, variants):
    body = []
    for kind in GATE_KINDS:
        row = [kind] + [bound_of(counts[kind, v]["missed"], counts[kind, v]["hazards"]) for v in variants]
        clean, noisy = counts[kind, "noise 0"], counts[kind, "noise 1"]
        row += [percent(noisy["hazards_unknown"], noisy["hazards"])]
        body.append(row + [percent(c["thesis_missed"], c["hazards"]) for c in (clean, noisy)])
    return table(["kind of hazard", *(f"missed, {v} (upper bound)" for v in variants), "noise 1: share refused only because of unknown cells",
                  "policy of the thesis, noise 0: share missed", "policy of the thesis, noise 1: share missed"], body)


def gate_stops_table(counts, variants):
    body = []
    for kind in [k for k in GATE_KINDS if k != "unseen"] + ["unseen"]:
        of = [counts[kind, v] for v in variants]
        body.append([kind, of[0]["safe"], *(percent(c["refused"], c["safe"]) for c in of), *(percent(c["thesis_refused"], c["safe"]) for c in of[:3])])
    total = [sum((counts[k, v] for k in GATE_KINDS if k != "unseen"), collections.Counter()) for v in variants]
    body.append(["**all but unseen**", total[0]["safe"], *(percent(c["refused"], c["safe"]) for c in total), *(percent(c["thesis_refused"], c["safe"]) for c in total[:3])])
    return table(["kind of scene", "safe movements asked", *(f"refused, {v}" for v in variants), *(f"refused by the policy of the thesis, {v}" for v in variants[:3])], body)


def gate_reasons_table(counts, variant):
    total = sum((counts[k, variant] for k in GATE_KINDS if k != "unseen"), collections.Counter())
    names = sorted((n for n in total if n.startswith(("reason:", "proof:", "alone:"))), key=lambda n: (n.split(":")[0], -total[n]))
    return table(["`alone`, `proof` or `reason`", "reason or failed proof", "refused movements (share of the refused)"], [[*n.split(":"), f"{total[n]} ({percent(total[n], total['refused'])})"] for n in names])


def gate_all_table(counts, variants):
    body = []
    for variant in variants:
        total = sum((counts[k, variant] for k in GATE_KINDS if k != "unseen"), collections.Counter())
        body.append([variant, bound_of(total["all_missed"], total["all_hazards"]), total["all_safe"], percent(total["all_refused"], total["all_safe"])])
    return table(["kind of map", "hazards missed (upper bound)", "safe movements asked", "share of the safe movements refused"], body)


def gate_runs_table(counts):
    body = []
    for kind in GATE_KINDS:
        c = counts[kind, "noise 1"]
        body.append([kind, bound_of(c["missed"], c["hazards"]), f"{c['refused']} of {c['safe']}", bound_of(c["all_missed"], c["all_hazards"]),
                     f"{percent(c['all_refused'], c['all_safe'])} of {c['all_safe']}", f"{c['thesis_missed']} of {c['hazards']}"])
    total = sum((counts[k, "noise 1"] for k in GATE_KINDS if k != "unseen"), collections.Counter())
    body.append(["**all but unseen**", bound_of(total["missed"], total["hazards"]), f"{total['refused']} of {total['safe']}",
                 bound_of(total["all_missed"], total["all_hazards"]), f"{percent(total['all_refused'], total['all_safe'])} of {total['all_safe']}",
                 f"{total['thesis_missed']} of {total['hazards']}"])
    return table(["kind of hazard", "movement of the scene: hazards missed (upper bound)", "movement of the scene: safe movements refused",
                  "all 26 movements: hazards missed (upper bound)", "all 26 movements: safe movements refused", "policy of the thesis: hazards missed"], body)


def gate_curve(counts):
    """Hazards missed and safe movements refused, with other noise and other limits of the gate."""
    total = collections.defaultdict(collections.Counter)
    for (_, variant), count in counts.items():
        total[variant] += count
    share = lambda c, part, whole: 100 * c[part] / max(c[whole], 1)  # noqa: E731
    figure, axis = plt.subplots(figsize=(7.5, 4.6))
    noises = sorted((float(v.split()[1]), v) for v in total if v.startswith("noise "))
    sweeps = {"noise of the map": [(f"x {n:g}", total[v]) for n, v in noises]}
    overconfident = sorted((float(v.split()[1]), v) for v in total if v.startswith("overconfident "))
    sweeps["noise, the map states 3 mm everywhere"] = [(f"x {n:g}", total[v]) for n, v in overconfident]
    own = {"every_limit": (1, "noise 1"), "sigma_factor": (3.4, "noise 1"), "patch_residual_mm": (25, "noise 1"), "patch_sigma_mm": (3, "noise 1"),
           "step_mm": (20, "overconfident 1"), "drop_mm": (50, "overconfident 1"), "swing_clearance_mm": (40, "overconfident 1")}
    for name, (limit, base) in own.items():
        mine = sorted([(float(v.split()[1]), v) for v in total if v.startswith(name + " ")] + [(limit, base)])
        sweeps[f"{name}, {base[:-2] if base.startswith('o') else base}"] = [(f"**{n:g}**" if n == limit else f"{n:g}", total[v]) for n, v in mine]
    body = []
    for (name, points), colour in zip(sweeps.items(), COLOURS + ["#8b4513", "#808000", "#4b0082"]):
        xy = [(share(c, "refused", "safe"), share(c, "missed", "hazards")) for _, c in points]
        if name.split(",")[0] not in ("patch_residual_mm", "step_mm", "drop_mm", "patch_sigma_mm"):  # they have no misses: only the table shows them
            axis.plot(*zip(*xy), "o-", color=colour, markersize=4, label=f"gate: {name.replace('_', ' ')}")
        if name.startswith("every_limit"):
            labels = collections.defaultdict(list)  # of all points at the same position
            for (x, y), (value, _) in zip(xy, points):
                labels[round(x, 1), round(y, 1)].append(f"x {value.strip('*')}")
            for at, values in labels.items():
                axis.annotate(", ".join(values), at, textcoords="offset points", xytext=(5, 6), fontsize=8, color=colour)
        body += [[name, value, bound_of(c["missed"], c["hazards"]), percent(c["refused"], c["safe"])] for value, c in points]
    xy = [(share(total[v], "thesis_refused", "safe"), share(total[v], "thesis_missed", "hazards")) for _, v in noises]
    axis.plot(*zip(*xy), "s--", color="#999999", markersize=5, label="policy of the thesis: noise of the map")
    axis.annotate("policy of the thesis", xy[-1], textcoords="offset points", xytext=(10, -3), fontsize=9, color="#666666")
    axis.set_xscale("symlog", linthresh=0.5, linscale=0.5)
    axis.set_yscale("symlog", linthresh=0.1, linscale=0.6)
    axis.set(xlabel="safe movements refused [%]", ylabel="hazards allowed [%]", xlim=(-0.08, 130), ylim=(-0.02, 130))
    for scale, ticks in ((axis.xaxis, (0, 0.5, 1, 2, 5, 10, 20, 50, 100)), (axis.yaxis, (0, 0.1, 1, 10, 100))):
        scale.set_ticks(ticks, [f"{tick:g}" for tick in ticks])
        scale.set_minor_locator(matplotlib.ticker.NullLocator())
    axis.legend(fontsize=8, loc="center right")
    save_at(figure, ROOT / "docs" / "img" / "gate_trade_off.png")
    body += [["policy of the thesis, noise", f"x {n:g}", bound_of(total[v]["thesis_missed"], total[v]["hazards"]), percent(total[v]["thesis_refused"], total[v]["safe"])]
             for n, v in noises]
    return ["![hazards missed and safe movements refused](../img/gate_trade_off.png)", ""] + table(["changed quantity, kind of map", "value (bold: value of the gate)", "hazards missed (upper bound)", "safe movements refused"], body)


def gate_drift(counts):
    """Misses when the true pose differs from the estimated pose."""
    drifts = sorted({float(v.split()[-1]) for _, v in counts if "drift" in v})
    body = []
    for drift in drifts:
        row = [f"{drift:g} mm"]
        for name in ("drift", "overconfident drift"):
            total = sum((counts[k, f"{name} {drift:g}"] for k in GATE_KINDS), collections.Counter())
            kinds = ", ".join(f"{k} {counts[k, f'{name} {drift:g}']['missed']}" for k in GATE_KINDS if counts[k, f"{name} {drift:g}"]["missed"])
            row += [bound_of(total["missed"], total["hazards"]), kinds or "-", percent(total["refused"], total["safe"])]
        body.append(row)
    return table(["drift, 1 sigma of each axis, true and stated", "noise 1: hazards missed (upper bound)", "noise 1: kinds of missed hazards", "noise 1: safe movements refused",
                  "overconfident: hazards missed (upper bound)", "overconfident: kinds of missed hazards", "overconfident: safe movements refused"], body)


def map_noise_table(folder):
    """Errors on level ground in whole runs. scenes/map_noise.hpp draws from them."""
    body = []
    for noise, _, _ in NOISE_RUNS:
        file = folder / f"map_noise_{noise}.csv"
        if not file.exists():
            body.append([f"x {noise}"] + ["not measured yet"] + ["-"] * 6)
            continue
        body.append([f"x {noise}"] + level_ground(read(file)))
    return table(["image noise", "runs used", "cells seen from 3 poses or more", "share of these cells that are unknown", "stated sigma: percentiles 10 / 50 / 90 / 99 / 99.9 [mm]",
                  "standard deviation of the errors [stated sigma]", "share of cells with an error of 20 mm or more", "correlation of errors at a distance of 1 / 2 / 3 / 6 cells"], body)


def level_ground(rows):
    runs = collections.defaultdict(list)
    for r in rows:
        level = float(r["high_mm"]) - float(r["low_mm"]) < 0.5 and abs(float(r["high_mm"])) < 0.5 and abs(float(r["floor_mm"])) < 0.6
        near = math.hypot(float(r["dx_m"]), float(r["dy_m"])) < 0.9 and float(r["along_m"]) < -0.15
        if level and near and int(r["looks"]) >= 3:
            runs[r["kind"], r["seed"]].append((float(r["dx_m"]), float(r["dy_m"]), float(r["map_mm"]), float(r["sigma_mm"])))
    # A run whose odom lies on another level is left out.
    kept = {k: c for k, c in runs.items() if len(c) > 100 and abs(statistics.median(z for *_, z, _ in c if not math.isnan(z))) < 50}
    sigma, errors, seen, unknown, sums = [], [], 0, 0, collections.defaultdict(lambda: [0.0, 0])
    far = 0
    for cells in kept.values():
        seen += len(cells)
        known = [c for c in cells if not math.isnan(c[2])]
        unknown += len(cells) - len(known)
        middle = statistics.median(z for _, _, z, _ in known)
        far += sum(abs(z - middle) > 20 for _, _, z, _ in known)
        grid = {(round(x / 0.025), round(y / 0.025)): max(-6, min(6, (z - middle) / s)) for x, y, z, s in known}
        sigma += [s for *_, s in known]
        errors += grid.values()
        for lag in (0, 1, 2, 3, 6):
            for (x, y), value in grid.items():
                for other in ((x + lag, y), (x, y + lag)):
                    if other in grid:
                        sums[lag][0] += value * grid[other]
                        sums[lag][1] += 1
    mean = {lag: total / max(n, 1) for lag, (total, n) in sums.items()}
    return [f"{len(kept)} of {len(runs)}", seen, f"{100 * unknown / seen:.2f} %", " / ".join(f"{quantile(sigma, q):.2f}" for q in (0.1, 0.5, 0.9, 0.99, 0.999)),
            f"{statistics.pstdev(errors):.2f}", f"{far / (seen - unknown):.1e}", " / ".join(f"{mean[lag] / mean[0]:.2f}" for lag in (1, 2, 3, 6))]


def gate_misses(misses):
    """Every kind of miss, its number, and one example to run again. `misses`: the tier, then the columns of MISS."""
    groups = collections.defaultdict(list)
    for tier, *miss in sorted(misses):
        kind, variant, danger = miss[:3]
        groups[tier, kind, variant, danger].append(miss)
    if not groups:
        return ["No hazard was missed so far."]
    body = [[*group, len(some), some[0][3], f"`{some[0][0]} {some[0][4]}`", some[0][5]] for group, some in sorted(groups.items())]
    return table(["tier", "scene", "map", "danger", "misses", "movement", "an example (`gate_scenes again`)", "truth"], body)


EXPERIMENTS = {"gate_scenes": gate_scenes, "gate_runs": gate_runs}
