"""Table of docs/lab/odometry.md: motions over one second and their covariance against the truth."""
import statistics

from lab_figures import fill, kept, render_room, table

ODOMETRY_SCENES, ODOMETRY_FIRST_SEED, ODOMETRY_SEEDS, ODOMETRY_FRAMES = "walk_floor,room,corridor", 73_001, 30, 105
ROOM_FRAMES, ROOM_FIRST, ROOM_STEP = 65, 20, 34  # recordings of render_room.py: 30 parts of its path


def odometry(lab):
    """Motions over one second and their covariance against the truth, with the faults of the real camera and mount."""
    folder = lab.folder("odometry")
    simulated = kept(lab, "odometry_truth", folder / "zed.csv", ODOMETRY_SCENES, ODOMETRY_FIRST_SEED, ODOMETRY_SEEDS,
                     "zed", ODOMETRY_FRAMES)
    rendered = folder / "rooms.csv"
    if not (rendered.exists() or lab.redraw):
        for i in range(ODOMETRY_SEEDS):
            render_room(lab, folder / f"room_{ODOMETRY_FIRST_SEED + i}", ROOM_FRAMES, ROOM_FIRST + i * ROOM_STEP,
                        ODOMETRY_FIRST_SEED + i)
    rooms = kept(lab, "odometry_truth", rendered, folder / "room_", ODOMETRY_FIRST_SEED, ODOMETRY_SEEDS, "-", ROOM_FRAMES)
    rows = simulated + [{**row, "scene": "rendered room"} for row in rooms]
    body = []
    for scene in [*ODOMETRY_SCENES.split(","), "rendered room"]:
        mine = [r for r in rows if r["scene"] == scene]
        if not mine:
            body.append([scene, "not measured yet", *"-" * 8])
            continue
        of = lambda key: [float(r[key]) for r in mine]  # noqa: E731
        moving = [int(r["moving"]) for r in mine]
        nees = [n for n, m in zip(of("nees"), moving) if m]
        mean = sum(n * m for n, m in zip(of("nees"), moving) if m) / max(sum(moving), 1)
        share = [1e-1 * e / p for e, p in zip(of("end_mm"), of("path_m")) if p]
        frames = [sum(int(r[key]) for r in mine) for key in ("ok", "degraded", "lost")]
        body.append([scene, len(mine), sum(moving), f"{mean:.2f} ({min(nees):.2f} to {max(nees):.2f})",
                     f"{statistics.median(of('rpe_mm')):.2f} / {max(of('rpe_mm')):.2f}",
                     f"{statistics.median(of('end_mm')):.1f} / {max(of('end_mm')):.1f}", f"{max(share):.2f} %",
                     f"{max(of('jump_mm')):.1f}", f"{max(of('held_mm')):.2f}", " / ".join(map(str, frames))])
    fill("odometry", table(["scene", "seeds", "motions over 1 s", "NEES, mean (smallest to largest of a seed)",
                            "error over 1 s, rms [mm]: median / largest", "error at the end [mm]: median / largest",
                            "error at the end, largest share of the path", "largest error of one frame [mm]", "largest error while standing [mm]",
                            "frames OK / DEGRADED / LOST"], body) + [""])


EXPERIMENTS = {"odometry": odometry}
