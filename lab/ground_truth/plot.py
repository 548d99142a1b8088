"""Tables of docs/lab/ground.md: the ground plane that places odom, and that of single frames."""

from lab_figures import fill, read, table, worst

GROUND_SCENES = ["floor", "corridor", "table", "room", "door_900", "demo_stairs", "stairs_up_nz_common", "flight_20_down",
                 "platform_edge", "hole", "kerb_up_75", "kerb_down_75", "kerb_up_150", "kerb_down_150", "kerb_ramp_up",
                 "ramp_1_12_up"]
GROUND_FIRST_SEED, GROUND_SEEDS, GROUND_FRAMES = 71501, 3, 20


def ground(lab):
    """The ground plane that places odom, and those of single frames, against the true pose."""
    lines = []
    for profile in ("ideal", "zed_calibrated", "zed"):
        file = lab.folder("ground") / f"{profile}.csv"
        lab.run("ground_truth", file, ",".join(GROUND_SCENES), GROUND_FIRST_SEED, GROUND_SEEDS, profile,
                  GROUND_FRAMES)
        rows = read(file)
        body = []
        for scene in GROUND_SCENES:
            of_scene = [row for row in rows if row["scene"] == scene]
            frames, accepted = (sum(int(row[key]) for row in of_scene) for key in ("frames", "accepted"))
            body.append([scene, *(worst(of_scene, key, digits) for key, digits in (("tilt_deg", 2), ("height_mm", 1))),
                         f"{accepted} of {frames}",
                         *(worst(of_scene, key, digits) for key, digits in (("tilt_p50_deg", 2), ("tilt_p90_deg", 2),
                                                                            ("height_p50_mm", 1),
                                                                            ("height_p90_mm", 1)))])
        lines += [f"### Camera profile {profile}", ""]
        lines += table(["scene", "tilt error of odom [deg]", "height error of odom [mm]", "single frames with an accepted plane",
                        "tilt error of single frames, 50 % [deg]", "tilt error of single frames, 90 % [deg]",
                        "height error of single frames, 50 % [mm]", "height error of single frames, 90 % [mm]"], body) + [""]
        for row in rows:
            if row["source"] != "plane":
                lines += [f"{row['scene']} {row['seed']}: placed by {row['source']}, no plane was accepted.", ""]
    fill("ground", lines + warm_up(lab))


WARM_SCENES, WARM_FRAMES = ["floor", "corridor", "demo_stairs", "room"], 170


def warm_up(lab):
    """The ground plane that places odom when the first 10-30 s are over-exposed."""
    body = []
    for profile in ("zed_calibrated", "zed"):
        file = lab.folder("ground") / f"warm_up_{profile}.csv"
        lab.run("ground_truth", file, ",".join(WARM_SCENES), GROUND_FIRST_SEED, GROUND_SEEDS, profile,
                  WARM_FRAMES, "sim.exposure.sun_warm_up=true", "sim.rate_hz=5")
        for row in read(file):
            body.append([row[key] for key in ("scene", "seed", "profile", "waited_s", "source", "tilt_deg", "height_mm")])
    return ["### Exposure warm-up in the sun", ""] + table(["scene", "seed", "camera profile", "waiting time [s]", "odom placed by",
                                                                 "tilt error of odom [deg]", "height error of odom [mm]"], body) + [""]


EXPERIMENTS = {"ground": ground}
