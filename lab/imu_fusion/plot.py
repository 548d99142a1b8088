"""Table of the part "fusion" in docs/lab/odometry.md: vision alone and two ways to add an IMU."""
import os

from lab_figures import fill, read, render_room, table

FUSION_ROOM = (500, 20, 7)  # frames, first frame, seed: no setting was chosen with it


def imu_fusion(lab):
    """Vision alone, the loose fusion of the reference thesis and the tight fusion, on real corner tracks and in a rendered room."""
    folder = lab.folder("imu_fusion")
    room = folder / "room"
    if not lab.redraw:
        render_room(lab, room, *FUSION_ROOM)
    os.environ["SUREFOOT_DATA_DIR"] = str(lab.data)  # the corner tracks are found there
    lab.run("imu_fusion", folder / "corners.csv", "corners")
    lab.run("imu_fusion", folder / "room.csv", room)
    body = []
    for r in read(folder / "corners.csv") + read(folder / "room.csv"):
        body.append([r["recording"], r["method"], r["frames"], r["path_m"], r["ate_mm"], r["rpe_mm"], r["rpe_deg"],
                     r["nees"], r["end_mm"], r["truth_noise_mm"], " / ".join(r[key] for key in ("ok", "degraded", "lost"))])
    fill("odometry", table(["recording", "method", "frames with truth", "path [m]", "ATE [mm]", "error over 1 s, rms [mm]", "error over 1 s, rms [deg]", "NEES over 1 s, mean",
                            "error at the end [mm]", "noise of the truth [mm]", "frames OK / DEGRADED / LOST"], body) + [""], "fusion")


EXPERIMENTS = {"imu_fusion": imu_fusion}
