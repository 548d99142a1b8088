"""Evaluates the files of a soak: growth, missed deadlines, faults. Used by tools/soak."""
import collections
import csv
import json
import math
import statistics
import subprocess

MS = 1_000_000
ANSWER_MS = 250.0  # limit for an answer, from the question or from the end of a stop of the gate
FRESH_MS = 250.0  # latest OK after the last frame (hazard table, faults of class ERROR)
AUDIT_MS = 1500.0  # latest OK after the log stopped accepting records; it is "behind" after 1 s
WARM_S = 1800.0  # start of a process that is not judged: in it new sizes and faults still take memory
MOST_MB_PER_H = 1.0
MOST_HANDLES_PER_H = 1.0
BLOCK_S = 300.0  # block for handles: the fewest in it count, so that short crowds do not
PERCEPTION_GONE = ("perception_pause", "perception_hang", "perception_kill")
ASKED_AGAIN_S = 0.3  # latest first question over a dead connection
ORPHAN_S = 6.0  # a killed perception ends its gate; the next gate listens within this time
Sample = collections.namedtuple("Sample", "elapsed_s name pid rss_kb anon_kb threads handles ticks shm_files shm_kb "
                                          "audit_kb load")
Query = collections.namedtuple("Query", "sent received verdict reason decided valid_until port")  # times: steady ns
Fault = collections.namedtuple("Fault", "kind begin end perception gate port")


def rows(path, row):
    """Reads the lines as named tuples; converts numbers."""
    def value(text):
        try:
            return int(text)
        except ValueError:
            try:
                return float(text)
            except ValueError:
                return text
    if not path.exists():
        return []
    with open(path, newline="") as file:
        return [row(*map(value, line)) for line in csv.reader(file) if len(line) == len(row._fields)]


def slope(points):
    """Least-squares slope of groups of (x, y) with one offset per group; None = too few points."""
    over = under = 0.0
    for group in points:
        if len(group) < 2:
            continue
        mean_x = statistics.fmean(x for x, _ in group)
        mean_y = statistics.fmean(y for _, y in group)
        over += sum((x - mean_x) * (y - mean_y) for x, y in group)
        under += sum((x - mean_x) ** 2 for x, _ in group)
    return over / under if under > 0 else None


def lives(samples, name):
    """Samples of each long-lived process of that name, without its first WARM_S."""
    by_pid = collections.defaultdict(list)
    for sample in samples:
        if sample.name == name:
            by_pid[sample.pid].append(sample)
    return [[s for s in life if s.elapsed_s - life[0].elapsed_s >= WARM_S] for life in by_pid.values()]


def fewest(life, field):
    """(time [h], fewest in a block) of a process. Only whole blocks, because a short block has a higher minimum."""
    blocks = collections.defaultdict(list)
    for s in life:
        blocks[int((s.elapsed_s - life[0].elapsed_s) // BLOCK_S)].append(s)
    whole = [b for b in blocks.values() if b[0].elapsed_s + 0.9 * BLOCK_S <= b[-1].elapsed_s]
    return [(b[0].elapsed_s / 3600.0, min(getattr(s, field) for s in b)) for b in whole]


def growth(samples, name):
    warm = [life for life in lives(samples, name) if life]
    longest = max(warm, key=len, default=[])
    its = [s for s in samples if s.name == name]

    def per_hour(field, groups):
        return slope([[(s.elapsed_s / 3600.0, getattr(s, field) / 1024.0) for s in life] for life in groups])
    return {
        "processes": len({s.pid for s in its}),
        "warm_hours_of_the_longest": (longest[-1].elapsed_s - longest[0].elapsed_s) / 3600.0 if longest else 0.0,
        "mb_first": longest[0].rss_kb / 1024.0 if longest else None,
        "mb_last": longest[-1].rss_kb / 1024.0 if longest else None,
        "mb_most": max((s.rss_kb for s in its), default=0) / 1024.0,
        "mb_per_h": per_hour("rss_kb", [longest]),
        "own_mb_per_h": per_hour("anon_kb", [longest]),
        "own_mb_per_h_of_all": per_hour("anon_kb", warm),
        "handles_per_h": slope([fewest(longest, "handles")] if longest else []),
        "handles_least": min((s.handles for s in longest), default=None),
        "handles_most": max((s.handles for s in its), default=0),
        "threads_per_h": slope([fewest(longest, "threads")] if longest else []),
        "threads_most": max((s.threads for s in its), default=0),
    }


def overlaps(query, fault, before_s=0.0, after_s=0.0):
    return query.sent <= fault.end + after_s * 1e9 and query.received >= fault.begin - before_s * 1e9


def is_lost_rightly(query, faults):
    """Whether the gate was killed, ended with a killed perception, or was stopped."""
    for fault in faults:
        if fault.kind in ("gate_kill", "gate_pause") and overlaps(query, fault, 0.1, ASKED_AGAIN_S):
            return True
        if fault.kind == "audit_unwritable" and overlaps(query, fault, 3.0, ASKED_AGAIN_S):
            return True  # the new gate begins to listen
        if fault.kind == "perception_kill" and overlaps(query, fault, 0.1, ORPHAN_S):
            return True
    return False


def latency_ms(query, faults):
    """Waiting time from the question, or from the end of a stop of the gate."""
    begin = query.sent
    for fault in faults:
        if fault.kind == "gate_pause" and overlaps(query, fault, 0.05):
            begin = max(begin, fault.end)
    return (query.received - begin) / MS


def near(faults, query):
    """Faults within a minute of a query: only these can matter."""
    return [f for f in faults if f.begin - 60e9 < query.sent < f.end + 60e9]


def judge_queries(queries, faults):
    missed = []  # (what, query)
    latencies_ms, parts = [], []
    for query in queries:
        around = near(faults, query)
        if query.verdict in ("LOST", "TIMEOUT"):
            if not is_lost_rightly(query, around):
                missed.append(("no answer" if query.verdict == "LOST" else "late answer", query))
            continue
        took_ms = latency_ms(query, around)
        latencies_ms.append(took_ms)
        parts.append(((query.decided - query.sent) / MS, (query.received - query.decided) / MS))
        if took_ms > ANSWER_MS:
            missed.append(("late answer", query))
        if query.verdict != "OK":
            continue
        for fault in around:
            after_ms = (query.decided - fault.begin) / MS
            if query.decided > fault.end:
                continue
            if fault.kind in PERCEPTION_GONE and after_ms > FRESH_MS:
                missed.append(("OK on old frames", query))
            if fault.kind in ("audit_full", "audit_unwritable") and after_ms > AUDIT_MS and query.port == fault.port:
                missed.append(("OK without a log", query))
    return missed, sorted(latencies_ms), parts


def first_inhibits_ms(queries, faults):
    """Times from the stop of perception to the first answer that is not OK, if the answer before was OK."""
    found = []
    answers = [q for q in queries if q.verdict not in ("LOST", "TIMEOUT")]
    for fault in faults:
        if fault.kind not in PERCEPTION_GONE:
            continue
        before = [q for q in answers if fault.begin - 1e9 < q.decided <= fault.begin]
        after = [q for q in answers if fault.begin < q.decided <= fault.end]
        first = next((q for q in after if q.verdict != "OK"), None)
        if before and before[-1].verdict == "OK" and first:
            found.append((first.decided - fault.begin) / MS)
    return found


def silences_s(queries, faults):
    """Time from the last answer to the next one for each killed gate."""
    found = []
    answers = [q for q in queries if q.verdict not in ("LOST", "TIMEOUT")]
    for fault in faults:
        if fault.kind == "gate_kill":
            last = [q.received for q in answers if q.received <= fault.begin][-1:]
            following = [q.received for q in answers if q.sent > fault.begin][:1]
            if last and following:
                found.append((following[0] - last[0]) / 1e9)
    return found


def share(ordered, part):
    return ordered[min(len(ordered) - 1, math.ceil(part * len(ordered)) - 1)] if ordered else None


def audit_of(folder):
    process = subprocess.run([folder / "bin" / "surefoot", "audit", "replay", folder / "audit", "--json"],
                             capture_output=True, text=True)
    try:
        return json.loads(process.stdout)
    except ValueError:
        return {"damage": {"what": process.stderr.strip()[-300:]}}


def processor_share(samples):
    """Processor time of perception and gate together, as a share of one core."""
    ticks = 0
    for name in ("perception", "gate"):
        for pid in {s.pid for s in samples if s.name == name}:
            its = [s for s in samples if s.pid == pid and s.name == name]
            ticks += its[-1].ticks
    return ticks / 100.0 / max(samples[-1].elapsed_s, 1.0)


def evaluate(folder):
    samples = rows(folder / "samples.csv", Sample)
    queries = rows(folder / "queries.csv", Query)
    faults = rows(folder / "faults.csv", Fault)
    about = json.loads((folder / "about.json").read_text())
    state = json.loads((folder / "state.json").read_text())
    restarts = (folder / "serve.log").read_text().count("was restarted")
    wanted = sum(f.kind in ("gate_kill", "audit_unwritable") for f in faults)
    missed, latencies_ms, parts = judge_queries(queries, faults)
    inhibits_ms = first_inhibits_ms(queries, faults)
    found = {
        **about,
        "hours": state["elapsed_s"] / 3600.0,
        "surprises": state["surprises"],
        "gate_surprises": max(0, restarts - wanted),
        "faults": dict(sorted(collections.Counter(f.kind for f in faults).items())),
        "clients": json.loads((folder / "crowd.json").read_text()) if (folder / "crowd.json").exists() else {},
        "queries": len(queries),
        "verdicts": dict(sorted(collections.Counter(q.verdict for q in queries).items())),
        "latency_ms": {name: share(latencies_ms, part) for name, part in
                       (("p50", 0.5), ("p99", 0.99), ("p99.9", 0.999), ("max", 1.0))},
        "to_gate_ms_most": max((a for a, _ in parts), default=None),
        "from_gate_ms_most": max((b for _, b in parts), default=None),
        "missed": dict(sorted(collections.Counter(what for what, _ in missed).items())),
        "missed_queries": [[what, *query] for what, query in missed[:50]],
        "first_inhibit_ms": {"n": len(inhibits_ms), "max": max(inhibits_ms, default=None)},
        "silence_after_gate_kill_s": {"max": max(silences_s(queries, faults), default=None)},
        "handles_alone": [state.get("handles_alone_first"), state.get("handles_alone_last")],
        "perception": growth(samples, "perception"),
        "gate": growth(samples, "gate"),
        "shm_files_most": max(s.shm_files for s in samples),
        "shm_kb_most": max(s.shm_kb for s in samples),
        "audit_mb_most": max(s.audit_kb for s in samples) / 1024.0,
        "processor_share": processor_share(samples),
        "load_average": {"mean": statistics.fmean(s.load for s in samples), "max": max(s.load for s in samples)},
        "audit": audit_of(folder),
    }
    found["failures"] = failures(found)
    found["passed"] = not found["failures"]
    return found


def failures(found):
    """The reasons why a soak fails, in words."""
    said = [f"{times} times {what}" for what, times in found["missed"].items()]
    if found["surprises"]:
        said.append(f"perception ended {found['surprises']} times without an injected fault")
    if found["gate_surprises"]:
        said.append(f"the gate ended {found['gate_surprises']} times without an injected fault")
    for name in ("perception", "gate"):
        for field, most, unit in (("mb_per_h", MOST_MB_PER_H, "MB"), ("handles_per_h", MOST_HANDLES_PER_H, "handles"),
                                  ("threads_per_h", MOST_HANDLES_PER_H, "threads")):
            per_h = found[name][field]
            if per_h is not None and per_h > most:
                said.append(f"{name} grows by {per_h:.2f} {unit} an hour")
    first, last = found["handles_alone"]
    if first is None or last is None or last > first:
        said.append(f"the gate without clients has {last} handles at the end, but {first} at the beginning")
    if found["shm_files_most"] > 1:
        said.append(f"{found['shm_files_most']} files in shared memory, the limit is 1")
    if found["audit"].get("damage") or found["audit"].get("different"):
        said.append("the audit log is damaged, or its replay gives other verdicts")
    if not found["verdicts"].get("OK"):
        said.append("the gate allowed no step")
    return said


def sentence(found):
    return (f"soak: {found['hours']:.2f} h, {sum(found['faults'].values())} faults, {found['queries']} questions, "
            f"missed deadlines {sum(found['missed'].values())}, " +
            ("; ".join(found["failures"]) if found["failures"] else "no growth"))


def number(value, digits=1):
    return "-" if value is None else f"{value:.{digits}f}"


def lines_of(found):
    latency = found["latency_ms"]
    audit = found["audit"]
    lines = [
        f"Seed {found['seed']}, {found['hours']:.2f} h at commit {found['commit']}, load average "
        f"{found['load_average']['mean']:.1f} (at most {found['load_average']['max']:.1f}) on a machine with other users. "
        f"The gate and the well-behaved client were {found['urgent']} nice values more urgent than other sessions. Perception and gate together used {100 * found['processor_share']:.0f} % of one core. "
        f"{'Passed.' if found['passed'] else 'NOT passed: ' + '; '.join(found['failures']) + '.'}",
        "", "| measured quantity | perception | gate |", "|---|---|---|"]
    for text, field, digits in (
            ("number of processes that ran one after the other", "processes", 0),
            ("longest life of a process, without its first 30 minutes (\"the longest life\") [h]", "warm_hours_of_the_longest", 2),
            ("resident memory at the beginning of the longest life [MB]", "mb_first", 1), ("resident memory at the end of the longest life [MB]", "mb_last", 1),
            ("**slope of the resident memory in the longest life [MB per hour]**", "mb_per_h", 2), ("slope of the memory that is not shared, in the longest life [MB per hour]", "own_mb_per_h", 2),
            ("slope of the memory that is not shared, over all lives of more than 30 minutes [MB per hour]", "own_mb_per_h_of_all", 2),
            ("largest resident memory of any process [MB]", "mb_most", 1),
            ("**slope of the number of handles [per hour]** (lowest number in each 5 minutes)", "handles_per_h", 2),
            ("smallest number of handles, largest number of handles", None, 0), ("slope of the number of threads [per hour]", "threads_per_h", 2)):
        cells = [f"{number(found[name]['handles_least'], 0)}, {number(found[name]['handles_most'], 0)}" if field is None
                 else number(found[name][field], digits) for name in ("perception", "gate")]
        lines.append(f"| {text} | {cells[0]} | {cells[1]} |")
    lines += ["", "| measured quantity | value |", "|---|---|",
              f"| questions of the well-behaved client | {found['queries']} |",
              "| answers by verdict (LOST and TIMEOUT: no answer came) | " + ", ".join(f"{k} {v}" for k, v in found["verdicts"].items()) + " |",
              *(f"| waiting time for an answer, {name} [ms] | {number(latency[key])} |" for name, key in
                (("median", "p50"), ("99 % within", "p99"), ("99.9 % within", "p99.9"), ("largest", "max"))),
              f"| **missed deadlines** | {sum(found['missed'].values())}" +
              "".join(f", {what}: {times}" for what, times in found["missed"].items()) + " |",
              f"| perception stopped or killed while the gate said OK: longest time to the first inhibit, with ten questions a second [ms] | "
              f"{number(found['first_inhibit_ms']['max'])} ({found['first_inhibit_ms']['n']} times) |",
              f"| gate killed: longest time without an answer [s] | {number(found['silence_after_gate_kill_s']['max'], 2)} |",
              "| number of handles of the gate without clients, at the beginning and at the end of the run | "
              f"{found['handles_alone'][0]}, {found['handles_alone'][1]} |",
              f"| largest number of files in shared memory | {found['shm_files_most']} ({found['shm_kb_most'] / 1024:.1f} MB) |",
              f"| largest size of the audit folder (limit 64 MB) [MB] | {number(found['audit_mb_most'])} |",
              f"| replay of the log: equal verdicts, different verdicts | {audit.get('equal', '-')}, {audit.get('different', '-')} |",
              f"| gaps in the log, entries (verdicts and acts) lost in these gaps | {audit.get('gaps', '-')}, {audit.get('lost', '-')} |",
              "", "| injected fault | number of times |", "|---|---|"]
    lines += [f"| {kind} | {times} |" for kind, times in found["faults"].items()]
    lines += ["", "| action of the clients | number of times |", "|---|---|"]
    lines += [f"| {what} | {times} |" for what, times in sorted(found["clients"].items())]
    return lines


def fill(page, found):
    """Replaces the figures between the markers of a page."""
    begin, end = "<!-- soak: begin -->", "<!-- soak: end -->"
    text = page.read_text()
    head, rest = text.split(begin)
    page.write_text(head + begin + "\n" + "\n".join(lines_of(found)) + "\n" + end + rest.split(end)[1])
