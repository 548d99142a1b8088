"""Table of the part "smooth" in docs/lab/stairs.md: false finds on ground without steps."""
import statistics

from lab_figures import fill, read, table
from stairs_figures import numbers, wilson

SMOOTH_SEEDS = (90_001, 1000)  # no setting was chosen with these


def stairs_smooth(lab):
    """Steps detected on smooth ramps, planes, hills, dips and waves without steps."""
    folder = lab.folder("stairs_smooth")
    lab.run("stairs_smooth", folder / "smooth.csv", *SMOOTH_SEEDS)
    rows, body = read(folder / "smooth.csv"), []
    errors = lambda r: (r["sigma_mm"], r["correlation_mm"], r["stated"])  # noqa: E731
    for key in dict.fromkeys(map(errors, rows)):
        mine = [r for r in rows if errors(r) == key]
        with_some = lambda name: sum(r[name] != "0" for r in mine)  # noqa: E731
        body.append([key[0], "uncorrelated" if key[1] == "0" else f"{key[1]} mm", "yes" if key[2] == "1" else "no", len(mine),
                     wilson(with_some("flights"), len(mine)), wilson(with_some("kerbs"), len(mine)), wilson(with_some("drops"), len(mine)),
                     f"{statistics.median(numbers(mine, 'find_us')) / 1e3:.1f}"])
    fill("stairs", table(["height errors, sd [mm]", "correlation length", "stated by the map", "maps", "maps with flights", "maps with kerbs", "maps with drops",
                          "one call [ms], median"], body), "smooth")


EXPERIMENTS = {"stairs_smooth": stairs_smooth}
