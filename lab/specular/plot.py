"""Tables of docs/lab/specular.md: answers of the gate before mirrors and glass, and without them."""

from lab_figures import fill, read, table

PANE_SCENES = ("mirror_wall", "glass_balustrade", "glass_corner", "mirror_pillar", "mirror_standing", "mirror_beside", "mirror_passage",
               "glass_beside", "glass_passage", "glass_door_ajar", "mirror_corner", "glass_wall", "mirror_door", "glass_door", "mirror_plinth",
               "mirror_puddle", "mirror_table", "glass_table", "glass_cabinet", "glass_screen")
SCENES_WITHOUT_PANES = ("floor", "stripes_window", "look_tiles", "door_900", "corridor", "shadow_window", "sill_13", "stripes_blind", "look_wood",
                        "room", "thesis_h_hall", "table", "cross_fall", "look_carpet", "shadow_pillar", "thesis_j_office")
SPECULAR_SEEDS = (1001, 1)  # no setting was chosen with these; an hour of one core


def specular(lab):
    """Answers of the gate before mirrors and glass, and in scenes without them."""
    folder = lab.folder("specular")
    for name, scenes in (("panes", PANE_SCENES), ("others", SCENES_WITHOUT_PANES)):
        lab.run("specular", folder / f"{name}.csv", ",".join(scenes), *SPECULAR_SEEDS)
    panes, others = read(folder / "panes.csv"), read(folder / "others.csv")
    of = lambda rows, name: sum(int(r[name]) for r in rows)  # noqa: E731
    by_scene = lambda rows: [[r for r in rows if r["scene"] == s] for s in dict.fromkeys(r["scene"] for r in rows)]  # noqa: E731

    def share(part, whole):
        return f"{100 * part / whole:.1f} %" if whole else "-"

    def stopped(rows, place_name, when):
        asked = of(rows, f"{place_name}_unsafe")
        return share(asked - of(rows, f"{place_name}_missed_{when}"), asked)

    def pane_row(name, rows):
        seen = [r for r in rows if int(r["panes"]) > 0]
        return [name, len(rows), of(rows, "here_unsafe"), stopped(rows, "here", "before"), stopped(rows, "here", "after"),
                of(rows, "around_unsafe"), stopped(rows, "around", "before"), stopped(rows, "around", "after"), f"{len(seen)} of {len(rows)}"]

    def other_row(name, rows):
        safe = of(rows, "around_safe")
        before, after = of(rows, "around_allowed_before"), of(rows, "around_allowed_after")
        return [name, len(rows), safe, share(before, safe), share(after, safe), share(before - after, safe),
                sum(int(r["panes"]) > 0 for r in rows)]

    lines = ["### Mirrors and glass", ""]
    lines += table(["scene", "cases", "dangerous movements, last pose", "last pose: inhibited without the search", "last pose: inhibited with the search",
                    "dangerous movements, within 0.6 m", "within 0.6 m: inhibited without the search", "within 0.6 m: inhibited with the search", "cases with a pane suspected"],
                   [pane_row(rows[0]["scene"], rows) for rows in by_scene(panes)] + [pane_row("**all**", panes)])
    whole = lambda when: sum(int(r[f"here_missed_{when}"]) == 0 for r in panes)  # noqa: E731
    lines += ["", f"Cases in which every dangerous movement at the last pose is inhibited: {whole('before')} of {len(panes)} without the search, "
              f"{whole('after')} of {len(panes)} with the search.", "", "### Scenes without panes", ""]
    lines += table(["scene", "cases", "safe movements, within 0.6 m", "allowed without the search", "allowed with the search", "added false stops", "cases with a pane suspected"],
                   [other_row(rows[0]["scene"], rows) for rows in by_scene(others)] + [other_row("**all**", others)])
    fill("specular", lines)


EXPERIMENTS = {"specular": specular}
