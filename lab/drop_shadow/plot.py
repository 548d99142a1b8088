"""Table and picture of the part "shadow" in docs/lab/correlated_depth.md: the occluded region behind a kerb."""
import statistics

import matplotlib.pyplot as plt

from lab_figures import COLOURS, fill, read, save, table

DEFAULT_RULE = "default"
SHADOW_SEEDS = (20_001, 12)


def drop_shadow(lab):
    """The occluded strip behind a kerb of 75 mm: its length, and the depth that fills it."""
    folders = {matcher: lab.folder(f"drop_shadow/{matcher}1") for matcher in ("census", "sgbm")}
    for matcher, folder in folders.items():
        lab.run("drop_shadow", folder, *SHADOW_SEEDS, 1, f"algorithm={matcher}")
    rows = {matcher: read(folder / "shadow.csv") for matcher, folder in folders.items()}
    body = []
    for distance in dict.fromkeys(r["distance_m"] for r in rows["census"]):
        of = lambda matcher, rule: [r for r in rows[matcher] if (r["distance_m"], r["rule"]) == (distance, rule)]  # noqa: E731
        one = of("census", DEFAULT_RULE)[0]
        row = [f"{distance} m", *(f"{1e3 * float(one[key]):.0f} mm" for key in ("geometry_m", "rays_m", "rendered_m"))]
        for rule in ("every match", DEFAULT_RULE):
            row += [f"{filled_share(of(matcher, rule)) * 1e3 * float(one['geometry_m']):.0f} mm "
                    f"({100 * filled_share(of(matcher, rule)):.0f} %)" for matcher in folders]
        body.append(row + [f"{height:.0f}" for height in fill_heights_mm(of("census", "every match"))])
    fill("correlated_depth", table(
        ["distance of the edge", "length of the occluded strip by geometry", "length of the occluded strip by the rays of both cameras",
         "distance behind the edge of the first pixel with ground again",
         "filled by every match, census", "filled by every match, sgbm", "filled with the defaults, census", "filled with the defaults, sgbm",
         *(f"median height of the fill, fifth {k} [mm]" for k in range(1, 6))],
        body) + ["", "The height of the fill is that of every match of census. Fifth 1 of the strip lies at the edge.", "", "The picture shows a cut along the camera's axis, 24 mm wide, for the first seed and census:", "", shadow_picture(folders["census"], {r["distance_m"]: 1e3 * float(r["geometry_m"]) for r in rows["census"]}), ""], "shadow")


def filled_share(rows):
    return sum(int(r["filled"]) for r in rows) / sum(int(r["pieces"]) for r in rows)


def fill_heights_mm(rows):
    """Median over the seeds for each fifth of the strip."""
    return [statistics.median(1e3 * float(r["height_m"]) for r in rows if r["fifth"] == str(k) and r["height_m"] != "nan")
            for k in range(5)]


def shadow_picture(folder, lengths_mm):
    rows = read(folder / "cut.csv")
    figure, axes = plt.subplots(2, 2, figsize=(9.5, 5.2), sharex=True, sharey=True, constrained_layout=True)
    for axis, (distance, length_mm) in zip(axes.flat, lengths_mm.items()):
        axis.axvspan(0, length_mm, color="#d55e00", alpha=0.15, linewidth=0, label="seen by no camera")
        axis.plot([-150, 0, 0, 350], [0, 0, -75, -75], color="black", linewidth=1, label="truth")
        axis.plot([0, length_mm], [0, -75], color="#d55e00", linewidth=1, linestyle="--", label="ray over the edge")
        for rule, style in (("every match", {"color": "#999999", "markersize": 4}), (DEFAULT_RULE, {"color": COLOURS[0], "markersize": 4})):
            mine = [r for r in rows if r["distance_m"] == distance and r["rule"] == rule]
            axis.plot([1e3 * float(r["behind_m"]) for r in mine], [1e3 * float(r["height_m"]) for r in mine], ".",
                      label=rule if rule != DEFAULT_RULE else "matches that the defaults accept", **style)
        axis.set(title=f"edge {distance} m ahead: occluded strip of {length_mm:.0f} mm", xlim=(-150, 350), ylim=(-130, 60))
    for axis in axes[1]:
        axis.set(xlabel="behind the edge [mm]")
    for axis in axes[:, 0]:
        axis.set(ylabel="height [mm]")
    axes[0][1].legend(fontsize=7, loc="upper right")
    return save(figure, "kerb_shadow")


EXPERIMENTS = {"drop_shadow": drop_shadow}
