"""Table of docs/lab/injections.md: the time from a fault to the first answer that is not OK."""
import collections
import statistics
import subprocess

from lab_figures import fill, quantile, read, table

INJECTIONS = (75_101, 200)  # first seed, number of each kind; no choice used them


def injections(lab):
    """The time from a fault to the first answer that is not OK, and answers OK after it."""
    out = lab.folder("injections")
    if not lab.redraw:  # its status is 1 when a hazard fails; the table shows which
        subprocess.run([str(lab.build / "lab/hazard_injections"), str(out / "injections.csv"), *map(str, INJECTIONS)])
    rows = [r for file in sorted(out.glob("*.csv")) for r in read(file)]
    kinds = sorted({(int(r["hazard"][1:]), r["cause"]) for r in rows})
    body, sums = [], collections.Counter()
    for number, cause in kinds:
        mine = [r for r in rows if r["hazard"] == f"H{number}" and r["cause"] == cause]
        row, counts = injections_row(mine)
        body.append([f"H{number}", cause, *row])
        sums += counts
    fill("injections", table(["hazard", "fault", "entry point", "random choice of the seed", "wanted class of the answer", "injections that count",
                              "control runs with only OK", "injections with an OK too late (number of such answers)",
                              "time from the fault to the first inhibit: median / 99th percentile / largest [ms]", "first reasons, number of injections"], body) +
         ["", f"{sums['counted']} of {sums['injected']} injections count. In {sums['controls_ok']} of {sums['controls']} control runs every answer was OK "
          f"({sums['control_answers']} answers). In {sums['late']} injections an OK came too late.", ""])


def injections_row(rows):
    """The cells of one kind, and the counts to sum over all kinds."""
    faulty, controls = ([r for r in rows if r["faulty"] == f] for f in "10")
    well = lambda r: 0 < int(r["asked_before"]) == int(r["allowed_before"])  # noqa: E731
    counted = [r for r in faulty if r["from_the_start"] == "1" or well(r)]
    late = [r for r in counted if int(r["allowed_late"]) > 0]
    latencies = [float(r["latency_ms"]) for r in counted if r["latency_ms"]]
    never = len(counted) - len(latencies)
    times = " / ".join(f"{x:.0f}" for x in (statistics.median(latencies), quantile(latencies, 0.99), max(latencies))) if latencies else "-"
    reasons = collections.Counter(r["reason"] for r in counted if r["latency_ms"])
    counts = collections.Counter(counted=len(counted), injected=len(faulty), controls=len(controls), controls_ok=sum(map(well, controls)),
                                 control_answers=sum(int(r["asked_before"]) for r in controls if well(r)), late=len(late))
    return [rows[0]["level"], rows[0]["drawn"], rows[0]["class"], f"{len(counted)} of {len(faulty)}", f"{counts['controls_ok']} of {len(controls)}",
            f"**{len(late)}** ({sum(int(r['allowed_late']) for r in late)})" if late else "0",
            times + (f"; never in {never}" if never else ""), ", ".join(f"{name} {n}" for name, n in reasons.most_common(4))], counts


EXPERIMENTS = {"injections": injections}
