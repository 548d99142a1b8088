"""Tables of docs/lab/places.md: how often place recognition finds a known place, and how often it is wrong."""
import collections
import pathlib

from lab_figures import ROOT, fill, quantile, read, table

PLACE_SCENES = "room,door_900,walk_turn_round,demo_stairs,corridor"
PLACE_FIRST_SEED = {"second_run": 71_601, "same_run": 71_601, "storey": 71_601}  # no setting was chosen with these
PLACE_PARTS = (("second_run", PLACE_SCENES, 6), ("same_run", PLACE_SCENES, 6),
               ("storey", ROOT / "lab/scenes/look_alike.yaml", 100))


def places(lab):
    """Recognition of known places, and false acceptances in corridors that look alike."""
    lines = []
    for kind, scenes, seeds in PLACE_PARTS:
        file = lab.folder("places") / f"{kind}.csv"
        if not file.with_suffix(".done").exists():  # a long run: its result is kept
            if lab.redraw:
                lines += [f"{kind}: not measured yet.", ""]
                continue
            lab.run("place_recall", file, kind, scenes, PLACE_FIRST_SEED[kind], seeds)
            file.with_suffix(".done").touch()
        lines += places_table(kind, read(file)) + [""]
    fill("places", lines)


def places_table(kind, rows):
    def row(name, mine):
        cases = collections.defaultdict(list)
        for r in mine:
            if r["revisit"] == "1":
                cases[r["scene"], r["seed"]].append(r)
        found = sum(any(r["accepted"] == "1" for r in case) for case in cases.values())
        looked = [r for case in cases.values() for r in case]
        accepted = [r for r in mine if r["accepted"] == "1"]
        single = sum(r["refusal"] in ("none", "unconfirmed") for r in looked)
        shares = [int(r["agreeing"]) / int(r["asked"]) for r in looked if int(r["asked"])]
        refused = collections.Counter(r["refusal"] for r in looked if r["refusal"] != "none")
        errors = [(float(r["error_m"]), float(r["error_deg"])) for r in accepted]
        wrong = sum(metres > 0.3 or degrees > 5.0 for metres, degrees in errors)
        if kind == "storey":
            wrong = len(accepted)  # whatever its pose
        worst = [f"{1e3 * max(e[0] for e in errors):.1f}", f"{max(e[1] for e in errors):.2f}"] if errors else ["-", "-"]
        return [name, f"{found} of {len(cases)}", f"{single} of {len(looked)}", wrong, *worst,
                f"{quantile(shares, 0.0):.2f} / {quantile(shares, 0.5):.2f} / {quantile(shares, 1.0):.2f}" if shares else "-",
                ", ".join(f"{name} {count}" for name, count in sorted(refused.items()))]

    names = list(dict.fromkeys(r["scene"] for r in rows))
    body = [row(pathlib.Path(name).stem, [r for r in rows if r["scene"] == name]) for name in names]
    if len(names) > 1:
        body.append(row("**all**", rows))
    return [f"### {kind}", ""] + table(["scene", "places recognised", "keyframes recognised without confirmation", "keyframes accepted by mistake",
                                        "largest error [mm]", "largest error [deg]", "agreeing share of the features: smallest / median / largest",
                                        "refused keyframes by reason"], body)


EXPERIMENTS = {"places": places}
