"""Tables of docs/lab/gate_answers.md: what the present gate answers about kept maps of thirteen scenes, and why it refuses."""
import collections
import concurrent.futures
import csv
import subprocess

from lab_figures import fill, table

SEED = 80_001  # for development: rules of the gate were chosen with these maps
SCENES = ("cross_fall", "demo_stairs", "door_900", "floor", "hole", "kerb_down_75", "kerb_down_100", "kerb_up_75", "platform_edge",
          "ramp_1_12_up", "sill_20", "stairs_up_nz_common", "table")
RIGS = {"zed_hd720": "1280 x 720", "zed_vga": "672 x 376"}
NOISES = (1, 2)


def gate_answers(lab):
    """Answers of the present gate about kept maps, by scene, size of the images and noise."""
    cases = [(rig, scene, noise) for rig in RIGS for scene in SCENES for noise in NOISES]
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        answers = dict(zip(cases, pool.map(lambda case: answers_of(lab, *case), cases)))
    fill("gate_answers", [*sums_table(answers), ""], "sums")
    fill("gate_answers", [*scenes_table(answers), ""])


def answers_of(lab, rig, scene, noise):
    """The lines of answers.csv. Runs the scene and asks the oracle only once."""
    run = lab.scratch / "gate_answers" / f"{rig}-{scene}-{noise}"
    motion, rate = ("trolley", 10) if scene == "cross_fall" else ("rex", 4)  # an ankle of the REX would exceed its limit on a cross-fall
    if not lab.redraw:
        if not (run / "map.snapshot").exists():
            subprocess.run([lab.build / "bin" / "surefoot", "run", f"sim:{scene}", "--seed", str(SEED), "--rig", rig, "--rate", str(rate),
                            "--out", run, "--set", "sim.profile=zed", "--set", f"sim.noise={noise}",
                            "--set", f"sim.motion_model={motion}"], check=True, capture_output=True)
        if not (run / "questions.csv").exists():
            lab.run("gate_answers", "ask", run, scene, motion, SEED, rig)
        subprocess.run([lab.build / "lab" / "gate_answers", "judge", "rex", run], check=True, capture_output=True)
    with open(run / "answers.csv", newline="") as file:
        return list(csv.DictReader(file))


def allowed(answers):
    return [answer for answer in answers if answer["decision"] == "OK"]


def clear(answers, safe, view=0):
    """The clear-cut safe or dangerous movements; `view`: 1 = feet, ways and bands in view, 2 = the ground below the body, too."""
    return [answer for answer in answers
            if answer["safe"] == safe and answer["clear_cut"] == "1" and int(answer["in_view"]) >= view]


def share(answers):
    return 100 * len(allowed(answers)) / len(answers) if answers else None


def percent(value):
    return "-" if value is None else f"{value:.0f} %"


def missed(answers):
    dangerous = [answer for answer in answers if answer["safe"] == "0"]
    return len(allowed(clear(answers, "0"))), len(allowed([answer for answer in dangerous if answer["clear_cut"] == "0"]))


def why(answers):
    refused = [answer for answer in answers if answer["decision"] != "OK"]
    counts = collections.Counter(reason for answer in refused for reason in answer["reasons"].split("|"))
    return ", ".join(f"{reason} {100 * count / len(answers):.0f} %" for reason, count in counts.most_common(3)) or "-"


def sums_table(answers):
    body = []
    for rig, size in RIGS.items():
        for noise in NOISES:
            group = [answers[rig, scene, noise] for scene in SCENES]
            row = [size, f"x {noise}", sum(len(clear(one, "0")) for one in group), sum(missed(one)[0] for one in group),
                   sum(missed(one)[1] for one in group)]
            for view in (1, 2):
                shares = [share(clear(one, "1", view)) for one in group if clear(one, "1", view)]
                row.append(f"{sum(shares) / len(shares):.0f} / {min(shares):.0f} %")
            body.append(row)
    return table(["images", "noise", "hazards tried", "missed", "missed within the margin", "safe and seen movements allowed: mean / worst scene",
                  "the same, with the ground below the body in view"], body)


def scenes_table(answers):
    body = []
    for (rig, scene, noise), one in answers.items():
        seen, body_seen = clear(one, "1", 1), clear(one, "1", 2)
        body.append([scene, RIGS[rig], f"x {noise}", len(clear(one, "0")), missed(one)[0], len(seen), percent(share(seen)), len(body_seen),
                     percent(share(body_seen)), why(body_seen)])
    return table(["scene", "images", "noise", "hazards tried", "missed", "safe and seen", "allowed", "with the ground below the body in view",
                  "allowed", "reasons of refusals of these"], body)


EXPERIMENTS = {"gate_answers": gate_answers}
