"""Tables of docs/lab/odometry_faults.md: faults in the middle of a walk, and the first motion after standing."""
import collections

from lab_figures import fill, kept, table

FAULT_SCENES, FAULT_FIRST_SEED, FAULT_SEEDS = ("walk_floor", "room"), 71_110, 3


def faults(lab):
    """Reactions of the odometry to faults in the middle of a walk, and to the first millimetres after standing."""
    folder = lab.folder("odometry_faults")
    runs, onsets, missing = [], [], []
    for seed in range(FAULT_FIRST_SEED, FAULT_FIRST_SEED + FAULT_SEEDS):
        for scene in FAULT_SCENES:
            rows = kept(lab, "odometry_faults", folder / f"{scene}_{seed}.csv", scene, seed, 1, "zed", "all")
            missing += [] if rows else [f"{scene} {seed}"]
            runs += fault_cases(rows)
        onsets += kept(lab, "odometry_onset", folder / f"onset_{seed}.csv", ",".join(FAULT_SCENES), seed, 1, "ideal,zed")
    lines = [f"Not measured yet: {', '.join(missing)}.", ""] if missing else []
    fill("odometry_faults", lines + faults_table(runs))
    fill("odometry_faults", onset_table(onsets), "onset")


def fault_cases(rows):
    """One summary for the frames of each run with one fault."""
    runs = collections.defaultdict(list)
    for r in rows:
        runs[r["fault"], r["severity"], r["imu"]].append(r)
    return [fault_case(key, frames) for key, frames in runs.items()]


def fault_case(key, frames):
    faulty = [i for i, r in enumerate(frames) if r["faulty"] == "1"]
    begin, end = (faulty[0], faulty[-1]) if faulty else (0, len(frames) - 1)
    after = frames[max(begin, 1):]  # the first frame has no predecessor
    of = lambda name, some: [float(r[name]) for r in some]  # noqa: E731
    unwell = [int(r["frame"]) - int(frames[begin]["frame"]) for r in after if r["health"] != "OK"]
    well = [i for i in range(end + 1, len(frames)) if frames[i]["health"] == "OK"]
    seconds = [r for r in after if r["s_health"] == "OK"]
    beyond = [r for r in seconds if float(r["s_mm"]) > 4 * float(r["s_sig_mm"]) or float(r["s_deg"]) > 4 * float(r["s_sig_deg"])]
    left_behind = [r for r in after if r["since_mm"] and float(r["since_mm"]) > 3 * float(r["since_sig_mm"])]
    ok = [r for r in after if r["health"] == "OK"]
    return {"key": key, "jump_mm": max(of("err_mm", after)), "jump_deg": max(of("err_deg", after)),
            "ok_mm": max(of("err_mm", ok), default=0.0), "ok_deg": max(of("err_deg", ok), default=0.0),
            "first": unwell[0] if unwell else None, "again": well[0] - end if well else None, "ended": end + 1 < len(frames),
            "reasons": [f"{r['health']} {r['reason']}" for r in after if r["reason"] != "none"],
            "cameras": {r["camera"] for r in frames[begin:]} - {"OK", "UNKNOWN"},
            "seconds": len(seconds), "beyond": len(beyond), "beyond_mm": max(of("s_mm", beyond), default=0.0),
            "outside": len(left_behind), "mapped": sum(r["health"] != "LOST" and r["lit"] == "1" for r in frames[begin:end + 1]),
            "faulty": end + 1 - begin, "finite": all(r["finite"] == "1" for r in frames)}


def faults_table(runs):
    body = []
    for fault, severity in dict.fromkeys(run["key"][:2] for run in runs):
        for imu in ("1", "0"):
            mine = [run for run in runs if run["key"] == (fault, severity, imu)]
            if not mine:
                continue
            total = lambda name: sum(run[name] for run in mine)  # noqa: E731
            most = lambda name: max(run[name] for run in mine)  # noqa: E731
            first = [run["first"] for run in mine]
            again = [run["again"] for run in mine if run["again"] is not None]
            reasons = collections.Counter(reason for run in mine for reason in run["reasons"])
            cameras = sorted(set().union(*(run["cameras"] for run in mine)))
            jump = f"{most('ok_mm'):.1f} / {most('ok_deg'):.2f}"
            never = sum(f is None for f in first)
            said = [str(max(f for f in first if f is not None))] if never < len(first) else []
            said += [f"never in {never}"] if never else []
            beyond = f"{total('beyond')} of {total('seconds')}" + (f", {most('beyond_mm'):.0f} mm" if total("beyond") else "")
            body.append([fault, severity, "yes" if imu == "1" else "no", len(mine), f"{most('jump_mm'):.1f} / {most('jump_deg'):.2f}",
                         f"**{jump}**" if most("ok_mm") > 50 or most("ok_deg") > 3 else jump, ", ".join(said),
                         ", ".join(f"{name} {count}" for name, count in reasons.most_common(3)) + (f"; camera {', '.join(cameras)}" if cameras else "") or "-",
                         max(again) if again else "-" if not mine[0]["ended"] else "not yet",
                         f"**{beyond}**" if most("beyond_mm") > 10 else beyond, total("outside"), f"{total('mapped')} of {total('faulty')}"])
            assert all(run["finite"] for run in mine), (fault, severity)
    return table(["fault", "severity", "IMU", "runs", "largest error of one frame [mm / deg]", "largest error of an OK frame [mm / deg]",
                  "frames from the fault to the first frame that is not OK, largest",
                  "most frequent health states and reasons, number of frames",
                  "frames from the end of the fault to the next OK frame, largest",
                  "seconds with only OK frames and an error beyond 4 sigma, of all seconds with only OK frames; largest error",
                  "frames whose motion since the fault errs by more than 3 sigma", "faulty frames that are mapped, of all faulty frames"], body) + [""]


def onset_table(rows):
    body = []
    keys = dict.fromkeys((r["profile"], r["shift_mm"], r["spread_frames"]) for r in rows)
    for profile, shift, spread in keys:
        mine = [r for r in rows if (r["profile"], r["shift_mm"], r["spread_frames"]) == (profile, shift, spread)]
        seen = [int(r["seen_after"]) for r in mine]
        unseen = sum(s < 0 for s in seen)
        answer = "-" if float(shift) == 0 else ", ".join(
            ([str(max(seen))] if max(seen) >= 0 else []) + ([f"not in {unseen}"] if unseen else []))
        if float(shift) >= 3 and (unseen or max(seen) > 1):
            answer = f"**{answer}**"
        body.append([profile, f"{float(shift):g}", spread if float(shift) else "-", len(mine), answer,
                     "-" if float(shift) == 0 else f"{max(abs(float(r['end_mm'])) for r in mine):.2f}",
                     sum(int(r["moved_before"]) for r in mine), f"{max(float(r['crept_mm']) for r in mine):.2f}"])
    return table(["camera", "motion [mm]", "frames that the motion takes", "runs", "frames until the motion is detected, largest", "largest error at the end [mm]",
                  "frames with a false motion while standing", "largest drift while standing [mm]"], body) + [""]


EXPERIMENTS = {"faults": faults}
