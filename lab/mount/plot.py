"""Table of docs/lab/mount.md: reports of a camera that was knocked, and false reports."""
import concurrent.futures
import json
import os
import subprocess

from lab_figures import fill, table

KNOCKS = ["pitch_deg=1.5", "pitch_deg=-3", "pitch_deg=5", "roll_deg=1.5", "roll_deg=-3", "roll_deg=5"]
UNHARMED = ["walk_floor", "walk_turn_round", "walk_pivot_reverse", "walk_ramp_1_12", "walk_back_to_table",
            "walk_descend_backwards"]
KNOCK_S, KNOCK_LASTS_S = 17, 0.1


def mount(lab):
    """How soon a knocked camera is reported, and whether a camera without a knock is reported."""
    out = lab.folder("mount")
    cases = [("walk_floor", seed, knock) for knock in KNOCKS for seed in (30_001, 30_002)]
    cases += [(scene, seed, None) for scene in UNHARMED for seed in (30_001, 30_002)]

    def run(case):
        scene, seed, knock = case
        folder = out / f"{scene}_{seed}_{knock}"
        if lab.redraw or (folder / "report.json").exists():  # a finished run is kept
            return
        words = [f"sim.knock.at_s={KNOCK_S}", f"sim.knock.{knock}"] if knock else []
        settings = [w for s in ["sim.profile=zed", "sim.rate_hz=6", *words] for w in ("--set", s)]
        subprocess.run([str(lab.build / "bin/surefoot"), "run", f"sim:{scene}", "--seed", str(seed), "--machine",
                        "rex", "--threads", "1", "--out", str(folder), *settings], check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(run, cases))
    body = []
    for scene, seed, knock in cases:
        frames = json.loads((out / f"{scene}_{seed}_{knock}" / "report.json").read_text())["per_frame"]
        second = lambda frame: 1e-9 * frame["time_ns"] - 1.0  # stamps of the simulator start at 1 s  # noqa: E731
        said = next((second(f) for f in frames if f["camera"] == "MOVED"), None)
        lost = sum(f["health"] == "LOST" for f in frames)
        answer = "no" if said is None else f"after {said - KNOCK_S:.1f} s" if knock else f"FALSE, at {said:.1f} s"
        leaning = [f for f in frames if f["camera"] == "LEANING"]
        after = [f for f in frames if knock and second(f) > KNOCK_S + KNOCK_LASTS_S and f["camera"] == "OK"]
        body.append([scene, seed, knock or "-", f"{second(frames[-1]):.0f} s", answer, len(after) if knock else "-",
                     f"{100 * len(leaning) / len(frames):.0f} %", lost])
    fill("mount", table(["simulated walk", "seed", "knock (`-`: none)", "end of the run", "knock reported",
                         "frames after the knock in which a movement could have begun",
                         "share of frames with the camera state LEANING", "frames with lost odometry"], body) + [""])


EXPERIMENTS = {"mount": mount}
