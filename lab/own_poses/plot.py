"""Tables of docs/lab/own_poses.md: the map with the poses of the odometry, by motion model and by shutter."""
import math
import statistics

from lab_figures import fill, kept, table

OWN_SCENES = "floor,walk_floor,room,corridor,door_900,demo_stairs,table,kerb_down_75,stairs_up_nz_common,flight_20_down"
OWN_MOTION_MODELS = ("trolley", "rex", "hand")
OWN_FIRST_SEED, OWN_SEEDS, OWN_FRAMES = 71_701, 2, 120
ROLLING_SCENES, ROLLING_SEEDS, ROLLING_S, ROLLING_30HZ_SEED = "floor,room,demo_stairs", 2, 10, 72_001
ROLLING_HEADER = ["odometry", "images", "scene", "runs", "ATE, global shutter, mean [mm]", "ATE, rolling shutter, mean [mm]", "ratio of the means"]
RIGS = ("zed_vga", "zed_vga_rolling")


def own_poses(lab):
    """Effects of the odometry's own poses on the map by motion model, and of a rolling shutter."""
    folder = lab.folder("own_poses")

    rows_of = lambda name, *words: kept(lab, "own_poses", folder / f"{name}.csv", *words)  # noqa: E731
    rows = rows_of("motion_models", OWN_SCENES, OWN_FIRST_SEED, OWN_SEEDS, "zed", OWN_FRAMES, ",".join(OWN_MOTION_MODELS))
    most = lambda mine, key: f"{max((float(r[key]) for r in mine if r[key] != 'nan'), default=math.nan):.1f}"  # noqa: E731
    pair = lambda mine, name: [most(mine, f"{name}_true_{of}_mm") + " / " + most(mine, f"{name}_own_{of}_mm")  # noqa: E731
                               for of in ("jump", "spread")]
    body = []
    for scene in [*OWN_SCENES.split(","), "**all**"]:
        for motion_model in OWN_MOTION_MODELS:
            mine = [r for r in rows if r["motion_model"] == motion_model and scene in (r["scene"], "**all**")]
            if mine:
                drift = max(1e-1 * float(r["end_mm"]) / float(r["path_m"]) for r in mine)
                body.append([scene, motion_model, len(mine), most(mine, "ate_mm"), f"{drift:.2f} %",
                             sum(int(r["lost"]) for r in mine), *pair(mine, "exact"), *pair(mine, "matched")])
    lines = table(["scene", "motion model", "runs", "ATE, largest [mm]", "drift, largest", "frames lost",
                   "exact depth: 99th percentile of jumps, true / own poses [mm]", "exact depth: spread, true / own poses [mm]",
                   "our depth: 99th percentile of jumps, true / own poses [mm]", "our depth: spread, true / own poses [mm]"], body)
    lines += ["", floor_ratio(rows), "", "### A rolling shutter", ""]
    body = []
    for name, imu in (("with IMU", "true"), ("without IMU", "false")):
        body += rolling_rows(lab, name, imu, 10, OWN_FIRST_SEED)
    fill("own_poses", lines + table(ROLLING_HEADER, body) + [""])


def own_poses_30hz(lab):
    """A rolling shutter without an IMU at the frame rate of a real camera."""
    fill("own_poses", table(ROLLING_HEADER, rolling_rows(lab, "without IMU", "false", 30, ROLLING_30HZ_SEED)), "30hz")


def floor_ratio(rows):
    """The floor from the walking machine against that from the trolley, with our depth and poses, in the same scenes and seeds."""
    spread = {(r["motion_model"], r["scene"], r["seed"]): float(r["matched_own_spread_mm"]) for r in rows}
    ratios = [value / spread["trolley", scene, seed] for (motion_model, scene, seed), value in spread.items()
              if motion_model == "rex" and ("trolley", scene, seed) in spread]
    ratios = [ratio for ratio in ratios if not math.isnan(ratio)]
    return (f"Spread of the floor with our depth and our poses, REX against trolley, {len(ratios)} pairs of runs: "
            f"{statistics.median(ratios):.2f} at the median, {max(ratios):.2f} at most.")


def rolling_rows(lab, name, imu, rate_hz, first_seed):
    rows = kept(lab, "own_poses", lab.folder("own_poses") / f"rolling_{imu}_{rate_hz}.csv", ROLLING_SCENES, first_seed,
                ROLLING_SEEDS, "zed", ROLLING_S * rate_hz, "rex", ",".join(RIGS), f"sim.rate_hz={rate_hz}",
                f"odometry.imu.enabled={imu}")
    if not rows:
        return [[name, f"{rate_hz} Hz", "not measured yet", *"-" * 4]]
    body = []
    for scene in [*ROLLING_SCENES.split(","), "**all**"]:
        ate = [statistics.mean(float(r["ate_mm"]) for r in rows if r["rig"] == rig and scene in (r["scene"], "**all**"))
               for rig in RIGS]
        runs = sum(r["rig"] == RIGS[0] and scene in (r["scene"], "**all**") for r in rows)
        body.append([name, f"{rate_hz} Hz", scene, runs, f"{ate[0]:.2f}", f"{ate[1]:.2f}", f"{ate[1] / ate[0]:.2f}"])
    return body


EXPERIMENTS = {"own_poses": own_poses, "own_poses_30hz": own_poses_30hz}
