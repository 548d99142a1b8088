"""Tables of docs/lab/terrain.md: the map and its footholds with true poses, against the geometry of the scenes."""
import statistics

from lab_figures import fill, read, table

LOOKED_BACK = ("walk_look_pivot_reverse", "walk_look_pivot_reverse_edge")
TERRAIN_SCENES = ("floor", "demo_stairs", "kerb_down_100", "kerb_up_100", "platform_edge", "hole", "ramp_1_12_up",
                  "door_900", "table", "stairs_up_nz_common", "room", "walk_pivot_reverse", *LOOKED_BACK)
TERRAIN_FIRST_SEED = 70_201  # no choice and no inspection used these seeds
TERRAIN_RUNS = (("zed_calibrated", 1, 1), ("zed_calibrated", 2, 1), ("zed", 1, 1), ("ideal", 1, 1))


def terrain(lab):
    """The map and its footholds with true poses, against the geometry of the scenes."""
    lines = []
    for profile, noise, seeds in TERRAIN_RUNS:
        rows = []
        for scene in TERRAIN_SCENES:
            file = lab.folder(f"terrain/{profile}_noise{noise}") / f"{scene}.csv"
            if not file.with_suffix(".done").exists():  # a long run: its result is kept
                if lab.redraw:
                    continue
                lab.run("terrain_truth", file, scene, TERRAIN_FIRST_SEED, seeds, profile, noise)
                file.with_suffix(".done").touch()
            rows += read(file)
        lines += [f"### {profile}, noise x {noise}, {seeds} seed{'s' * (seeds > 1)}", ""]
        missing = [scene for scene in TERRAIN_SCENES if all(r["scene"] != scene for r in rows)]
        if missing:
            lines += ["Not measured yet: " + ", ".join(missing) + ".", ""]
        if rows:
            lines += terrain_table(rows) + [""] + near_feet(rows) + [""]
    fill("terrain", lines)


def terrain_table(rows):
    def total(mine, name):
        return sum(int(r[name]) for r in mine)

    def figures(name, mine):
        of = lambda key: [float(r[key]) for r in mine]
        sigma = " / ".join(f"{100 * statistics.mean(of(f'sigma_{k}')):.0f}" for k in (1, 2, 3))
        unsafe, safe = total(mine, "truly_unsafe"), total(mine, "truly_safe")
        share = lambda key, all_of: f"{100 * total(mine, key) / all_of:.2f} %" if all_of else "-"
        return [name, f"{statistics.median(of('median_mm')):.1f}", f"{statistics.median(of('p90_mm')):.1f}",
                f"{100 * statistics.mean(of('coverage')):.1f} %", sigma, unsafe, share("called_safe", unsafe),
                max(int(r["cluster"]) for r in mine), total(mine, "hazards_called_safe"),
                max(int(r["hazard_cluster"]) for r in mine), share("called_unsafe", safe), share("unsure", safe),
                share("unknown", safe)]

    by_scene = {scene: [r for r in rows if r["scene"] == scene] for scene in TERRAIN_SCENES}
    body = [figures(scene, mine) for scene, mine in by_scene.items() if mine]
    body.append(figures("**all**", rows))
    return table(["scene", "height error, median [mm]", "height error, 90 % [mm]", "cells known", "within 1 / 2 / 3 sigma [%]", "truly unsafe cells",
                  "truly unsafe cells called safe", "largest cluster called safe [cells]", "hazard cells called safe", "largest cluster of hazard cells called safe [cells]",
                  "truly safe cells called unsafe", "truly safe cells unsure", "truly safe cells unknown"], body)


def near_feet(rows):
    """All cells within 0.7 m of the body after the turn and the metre backwards, observed or not."""
    body = []
    for scene in ("walk_pivot_reverse", *LOOKED_BACK):
        mine = [r for r in rows if r["scene"] == scene]
        if not mine:
            continue
        count = lambda key: sum(int(r["near_" + key]) for r in mine)
        safe = count("truly_safe")
        body.append([scene, safe, *(f"{100 * count(key) / max(safe, 1):.1f} %" for key in ("called_unsafe", "unsure", "unknown")),
                     count("truly_unsafe"), count("called_safe"), count("hazards_called_safe")])
    return table(["within 0.7 m of the body at the end", "truly safe cells", "truly safe cells called unsafe", "truly safe cells unsure", "truly safe cells unknown",
                  "truly unsafe cells", "truly unsafe cells called safe", "hazard cells called safe"], body) if body else []


EXPERIMENTS = {"terrain": terrain}
