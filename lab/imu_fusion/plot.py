"""Table of the part "fusion" in docs/lab/odometry.md: vision alone and two ways to add an IMU."""
import os

from lab_figures import fill, read, render_room, table

FUSION_ROOM = (500, 20, 7)  # frames, first, seed: nothing was chosen by it


def imu_fusion(lab):
    """Vision alone, the thesis' loose fusion and the tight one: on real corner tracks, and on a rendered room."""
    folder = lab.folder("imu_fusion")
    room = folder / "room"
    if not lab.redraw:
        render_room(lab, room, *FUSION_ROOM)
    os.environ["SUREFOOT_DATA_DIR"] = str(lab.data)  # that of the corners
    lab.run("imu_fusion", folder / "corners.csv", "corners")
    lab.run("imu_fusion", folder / "room.csv", room)
    body = []
    for r in read(folder / "corners.csv") + read(folder / "room.csv"):
        body.append([r["recording"], r["method"], r["frames"], r["path_m"], r["ate_mm"], f"{r['rpe_mm']} mm, {r['rpe_deg']} deg",
                     r["nees"], r["end_mm"], r["truth_noise_mm"], " / ".join(r[key] for key in ("ok", "degraded", "lost"))])
    fill("odometry", table(["recording", "method", "frames with truth", "way [m]", "ATE [mm]", "error over 1 s, rms", "NEES over 1 s, mean",
                            "error at the end [mm]", "noise of the truth [mm]", "frames OK / DEGRADED / LOST"], body) + [""], "fusion")


EXPERIMENTS = {"imu_fusion": imu_fusion}
