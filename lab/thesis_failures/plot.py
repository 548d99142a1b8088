"""Tables and pictures of docs/lab/thesis_failures.md: the settings and faults of the reference thesis (Lange 2016)."""
import collections
import csv
import statistics

import matplotlib.pyplot as plt

from lab_figures import COLOURS, fill, read, save, table


def thesis_sometimes(lab):
    """A pose tracker that is late for a part of the clouds."""
    folder = lab.folder("thesis_failures/drawn1")
    lab.run("thesis_failures", folder, 20_001, 3, 1, "drawn")
    rows = read(folder / "runs.csv")
    body = []
    for late, share in dict.fromkeys((r["late_images"], r["drawn_share"]) for r in rows):
        of = lambda motion_model, key: [1e3 * float(r[key]) for r in rows  # noqa: E731
                                   if (r["late_images"], r["drawn_share"], r["motion_model"]) == (late, share, motion_model)]
        row = [f"50-500 ms, {100 * float(share):.0f} % of the clouds" if float(share) else f"{1e3 * int(late) / 15:.0f} ms, always"]
        for key in ("spread_m", "rms_m", "coarse_spread_m"):
            trolley, rex = statistics.median(of("trolley", key)), statistics.median(of("rex", key))
            each = ", ".join(f"{r / t:.1f}" for t, r in zip(of("trolley", key), of("rex", key)))
            row.append(f"{trolley:.0f} / {rex:.0f} = x {rex / trolley:.1f} ({each})")
        for motion_model in ("trolley", "rex"):
            middle, sides = (of(motion_model, f"coarse_edges_{part}_m") for part in ("middle", "sides"))
            row.append(f"{statistics.median(middle):.0f} - {statistics.median(sides):.0f} "
                       f"({', '.join(f'{m:.0f}-{s:.0f}' for m, s in zip(middle, sides))})")
        body.append(row)
    fill("thesis_failures", table(["pose late by", "floor spread, trolley / REX [mm] (each seed)", "rms of the floor, trolley / REX [mm]", "spread of 0.1 m medians, trolley / REX [mm]",
                                   "trolley: 99th percentile of jumps, middle - sides of the image [mm]", "REX: 99th percentile of jumps, middle - sides of the image [mm]"], body), "sometimes")


def thesis_failures(lab):
    """Late poses and disparity offsets as in the reference thesis (Lange 2016)."""
    out = lab.folder("thesis_failures")
    lines = []
    for noise in (1, 2):
        folder = out / f"noise{noise}"
        folder.mkdir(exist_ok=True)
        lab.run("thesis_failures", folder, 10_001, 3, noise)
        lines += [f"### Camera noise x {noise}", ""] + failures_table(read(folder / "runs.csv")) + [""]
        if noise == 1:
            lines += [failures_maps(folder), "", failures_histograms(read(folder / "heights.csv")), ""]
    fill("thesis_failures", lines)


def riser_mm(row):
    return 1e3 * (float(row["tread3_m"]) - float(row["tread0_m"])) / 3


def failures_table(rows):
    """Medians over the seeds, in mm."""
    groups = collections.defaultdict(list)
    for row in rows:
        groups[row["late_images"], row["offset_px"], row["scene"], row["motion_model"]].append(row)

    def middle(key, motion_model, scene="floor"):
        mine = groups[late, offset, scene, motion_model]
        return statistics.median(riser_mm(r) if key == "riser" else 1e3 * float(r[key]) for r in mine)

    body = []
    for late, offset in dict.fromkeys((r["late_images"], r["offset_px"]) for r in rows):
        row = [f"{1e3 * int(late) / 15:.0f} ms", f"{float(offset):+g} px" if float(offset) else "0"]
        for key in ("spread_m", "rms_m", "coarse_spread_m"):
            trolley, rex = middle(key, "trolley"), middle(key, "rex")
            row.append(f"{trolley:.0f} / {rex:.0f} = x {rex / trolley:.1f}")
        for motion_model in ("trolley", "rex"):
            row.append(f"{middle('coarse_edges_middle_m', motion_model):.0f} - {middle('coarse_edges_sides_m', motion_model):.0f}")
            row.append(f"{middle('riser', motion_model, 'demo_stairs'):.0f}")
        body.append(row)
    return table(["pose late by", "disparity offset", "floor spread, trolley / REX [mm]", "rms of the floor, trolley / REX [mm]", "spread of 0.1 m medians, trolley / REX [mm]",
                  "trolley: 99th percentile of jumps, middle - sides of the image [mm]", "trolley: riser [mm]", "REX: 99th percentile of jumps, middle - sides of the image [mm]", "REX: riser [mm]"], body)


def failures_maps(folder):
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4.4), sharey=True)
    for axis, (motion_model, title) in zip(axes, (("trolley", "trolley"), ("rex", "REX"))):
        heights = [[float(cell) for cell in row] for row in
                   csv.reader(open(folder / f"map_floor_{motion_model}_10001_1_4_0_0.csv", newline=""))]
        # Rows run along x: x points up and y to the left, as seen from the machine.
        drawn = axis.imshow([[1e3 * cell for cell in row] for row in heights], origin="lower", cmap="RdBu_r", vmin=-60,
                            vmax=60, extent=(-3, 3, -3, 3))
        axis.invert_xaxis()
        axis.set(title=f"{title}, pose late by 267 ms", xlabel="to the left of the machine [m]")
        axis.grid(False)
    axes[0].set(ylabel="ahead of the machine [m]")
    figure.colorbar(drawn, ax=axes, label="height of a level floor [mm]", shrink=0.85)
    return save(figure, "thesis_floor")


def failures_histograms(rows):
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 3.4))
    for motion_model, title, colour in (("trolley", "trolley", COLOURS[0]), ("rex", "REX", COLOURS[1])):
        late = [r for r in rows if r["motion_model"] == motion_model and r["late_images"] == "4" and r["seed"] == "10001"]
        floor = [1e3 * float(r["height_m"]) for r in late
                 if r["scene"] == "floor" and r["part"] == "floor" and r["offset_px"] == "0"]
        axes[0].hist(floor, bins=range(-100, 101, 4), histtype="step", color=colour, linewidth=1.5, label=title, density=True)
        stairs = [1e3 * float(r["height_m"]) for r in late if r["part"].startswith("tread") and r["offset_px"] == "0.7"]
        axes[1].hist(stairs, bins=range(-120, 661, 8), histtype="step", color=colour, linewidth=1.5, label=title, density=True)
    for step in range(4):
        axes[1].axvline(180 * step, color="black", linestyle=":", label="truth" if step == 0 else None)
    axes[0].set(title="level floor, pose late by 267 ms", xlabel="height [mm]", yticks=[])
    axes[1].set(title="demonstration stairs, disparity also off by 0.7 px", xlabel="height [mm]", yticks=[])
    for axis in axes:
        axis.legend(fontsize=8)
    return save(figure, "thesis_histograms")


EXPERIMENTS = {"thesis_failures": thesis_failures, "thesis_sometimes": thesis_sometimes}
