"""Tables of the part "followed" in docs/lab/stairs.md: features of single maps and tracked features."""
import math
import statistics

from lab_figures import ROOT, fill, read, table
from stairs_figures import numbers

FOLLOW_FIRST_SEED = 82_001  # no setting was chosen with these
FOLLOW_SCENES = {"lab/scenes/stairs_up.yaml#up_common": 2, "lab/scenes/stairs_down.yaml#down_near": 2,
                 "lab/scenes/kerb_ahead.yaml": 2, "table": 1}  # seeds of each
FOLLOW_HZ = 10
WAYS = {"found": "single map", "followed": "tracked"}  # as in the CSV file: as in the tables


def stairs_follow(lab):
    """Features of every frame, from its map alone and tracked over time."""
    folder = lab.folder("stairs_follow")
    for scene, seeds in FOLLOW_SCENES.items():
        named = str(ROOT / scene) if "/" in scene else scene
        lab.run("stairs_truth", folder / "looks.csv", named, FOLLOW_FIRST_SEED, seeds, "images_0.25", 1, folder / "maps")
    lab.run("stairs_follow", folder / "follow.csv", folder / "maps")
    rows = [{**row, "scene": row["scene"].split("#")[-1].split("/")[-1].split(".")[0]} for row in read(folder / "follow.csv")]
    changes, errors = [], []
    for scene in dict.fromkeys(r["scene"] for r in rows):
        for way in WAYS:
            mine = [r for r in rows if (r["scene"], r["way"]) == (scene, way)]
            total = lambda key: sum(int(r[key]) for r in mine)  # noqa: E731
            seconds = total("observations") / FOLLOW_HZ
            calls = numbers(mine, "call_us")
            changes.append([scene, len(mine), WAYS[way], *(f"{total(key) / seconds:.1f}" for key in ("edges", "drops", "kerbs", "flights", "doors")),
                            f"{total('steps_changes')} of {total('found_observations')}", total("drops_lost"),
                            f"{statistics.median(calls):.0f}" if calls else "-"])
            if any(numbers(mine, "across_mean")):
                errors.append([scene, WAYS[way], *(follow_errors(mine, name) for name in ("riser", "going", "across"))])
    fill("stairs", table(["scene", "runs", "features", "edges that appear or vanish per second",
                          "drops that appear or vanish per second", "kerbs that appear or vanish per second",
                          "flights that appear or vanish per second", "doors that appear or vanish per second",
                          "changes of the number of steps, of all frames that found the flight", "drops found, but not reported", "one call of the tracker [us]"], changes)
         + [""] + table(["scene", "features", *(f"{size}: mean error / change between observations, rms / error of the last observation [mm]"
                                                 for size in ("riser", "going", "first edge"))], errors), "followed")


def follow_errors(rows, name):
    if not (means := numbers(rows, f"{name}_mean")):
        return "-"
    rms = lambda key: math.sqrt(statistics.mean(v * v for v in numbers(rows, f"{name}_{key}")))  # noqa: E731
    return f"{statistics.mean(means):+.1f} / {rms('step'):.2f} / {statistics.mean(numbers(rows, f'{name}_last')):+.1f}"


EXPERIMENTS = {"stairs_follow": stairs_follow}
