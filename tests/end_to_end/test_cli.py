"""Every verb: help, example, exit codes, names in its JSON."""
import json
import math
import os
import re
import shlex
import statistics
import struct
import subprocess
import time
import unittest

from surefoot_cli import BINARY, ROOT, CliTest, grey_png, read_asc, surefoot

# Ordered so that each example finds the results of earlier ones that it needs.
VERBS = [["sim"], ["run"], ["depth"], ["depth-accuracy"], ["rate"], ["stairs"], ["fuse"], ["ground"], ["dem"], ["voxel"], ["sor"], ["icp"], ["measure"], ["gate"],
         ["serve"], ["rex-link"], ["audit"], ["audit", "verify"], ["audit", "acts"], ["audit", "replay"], ["eval"], ["eval", "trajectory"],
         ["eval", "maps"], ["eval", "clouds"], ["eval", "depth"], ["eval", "stairs"], ["eval", "suite"], ["calibrate"],
         ["calibrate", "render"], ["calibrate", "mono"], ["calibrate", "stereo"], ["config"], ["doctor"], ["bench"],
         ["record"], ["replay"], ["info"], ["rig"], ["urdf"], ["map"], ["map", "info"], ["map", "merge"], ["map", "export"]]
GATE_EXIT_CODES = (0, 3, 4)
NO_GATE_EXIT_CODES = (0, 1)  # rex-link: another process may listen at the default port


class Verbs(CliTest):
    def test_every_verb_of_the_program_is_listed_here(self):
        listed = re.findall(r"^  ([a-z-]+) ", surefoot("--help").stdout.split("Subcommands:")[1], re.M)
        self.assertEqual(sorted(listed), sorted({verb[0] for verb in VERBS}))

    def test_every_help_has_an_example_and_the_example_runs(self):
        for folder in ("tests", "service"):
            (self.dir / folder).symlink_to(ROOT / folder)
        for verb in VERBS:
            process = surefoot(*verb, "--help")
            self.assertEqual(process.returncode, 0, verb)
            self.assertIn("Example:", process.stdout, verb)
            for example in process.stdout.split("Example:")[1].strip().splitlines():
                words = shlex.split(example)
                self.assertEqual(words[0], "surefoot")
                process = surefoot(*words[1:], cwd=self.dir)
                allowed = {"gate": GATE_EXIT_CODES, "rex-link": NO_GATE_EXIT_CODES}.get(verb[0], (0,))
                self.assertIn(process.returncode, allowed, f"{example}\n{process.stderr}")
                if "--json" in words or verb == ["gate"]:
                    self.assertTrue(process.stdout.strip(), example)

    def test_the_limit_of_an_attestation_is_that_of_the_machine_file(self):
        words = " ".join(surefoot("gate", "--help").stdout.split())
        self.assertIn("At most attestation_radius_m of the machine file", words)
        self.assertNotIn("[0 - 2]", words)

    def test_old_option_names_work_with_a_warning(self):
        old = surefoot("gate", "--map", "nowhere", "--pose", "0,0,0", "--command", 9, "--vouch", "0.5", cwd=self.dir)
        new = surefoot("gate", "--map", "nowhere", "--pose", "0,0,0", "--command", 9, "--attest=0.5", cwd=self.dir)
        self.assertEqual(old.returncode, new.returncode)
        self.assertEqual(old.stdout, new.stdout)
        self.assertIn("--vouch is now called --attest", old.stderr)
        self.assertNotIn("is now called", new.stderr)
        other = surefoot("eval", "suite", "--eye", "left", cwd=self.dir)
        self.assertEqual(other.returncode, 2)
        self.assertIn("there is no option --eye", other.stderr)  # only `calibrate mono` had it

    def test_an_old_setting_gives_one_warning_in_every_verb_that_reads_settings(self):
        old = ("--set", "trim.enabled=false")
        for words in (["config", "--check"], ["eval", "maps", "nowhere", "nowhere"], ["run", "nowhere", "--out", "x"]):
            process = surefoot(*words, *old, cwd=self.dir)
            self.assertEqual(process.stderr.count("'trim.enabled' is now called 'self_calibration.enabled'"), 1,
                             f"{words}: {process.stderr}")

    def test_text_that_is_not_utf8_still_gives_an_answer_in_json(self):
        map_dir = os.fsencode(self.dir) + b"/\xff\xfe"
        process = subprocess.run([os.fsencode(BINARY), b"gate", b"--map", map_dir, b"--pose", b"0,0,0", b"--command", b"9",
                                  b"--json"], capture_output=True)
        self.assertEqual(process.returncode, 4)
        self.assertEqual(json.loads(process.stdout)["verdict"], "ERROR")
        process = subprocess.run([os.fsencode(BINARY), b"run", map_dir, b"--out", b"x", b"--json"], capture_output=True)
        self.assertEqual(json.loads(process.stdout)["exit_code"], process.returncode)

    def test_wrong_calls_exit_with_2_and_say_why(self):
        for words in (["walk"], ["run"], ["run", "sim:floor"], ["sim", "nowhere", "--out", "x"],
                      ["rate", "a.asc", "--out", "x", "--preset", "nothing"],
                      ["gate", "--map", "nowhere", "--pose", "0,0", "--command", "9"],
                      ["config", "--set", "elevation.lenght_m=3"],
                      ["config", "--set", "elevation.length_m"]):
            process = surefoot(*words, cwd=self.dir)
            self.assertEqual(process.returncode, 2, f"{words}: {process.stderr}")
            self.assertTrue(process.stderr.strip(), words)

    def test_gate_never_exits_with_0_when_it_cannot_judge(self):
        process = surefoot("gate", "--map", self.dir, "--pose", "0,0,0", "--command", "9")
        self.assertEqual(process.returncode, 4)

    def test_version(self):
        self.assertRegex(surefoot("--version").stdout.strip(), r"^\d+\.\d+\.\d+$")

    def test_config_prints_what_it_reads(self):
        text = self.run_ok("config", "--set", "elevation.length_m=8").stdout
        file = self.dir / "c.yaml"
        file.write_text(text)
        again = self.run_ok("config", "--config", file).stdout
        self.assertEqual(text, again)
        self.assertIn("length_m: 8", again)

    def test_json_is_one_object_with_the_promised_names(self):
        recording, run, region = self.dir / "recording", self.dir / "run", self.dir / "floor.region"
        grid = "ncols 40\nnrows 40\nxllcorner 0\nyllcorner 0\ncellsize 0.05\nNODATA_value -9999\n" + "0 " * 1600
        (self.dir / "flat.asc").write_text(grid + "\n")
        steps = ROOT / "tests" / "conformance" / "elevation" / "steps.txt"
        depth = ROOT / "tests" / "conformance" / "depth"
        eye = lambda camera: recording / "mav0" / camera / "data" / "1000000000.png"
        promised = (  # ordered so that each finds its inputs
            (["sim", "floor", "--frames", 3, "--out", recording], "frames complete error folder"),
            (["run", recording, "--out", run, "--machine", "rex", "--save-map", region], "source frames complete gravity_source map timing"),
            (["depth", eye("cam0"), eye("cam1"), "--rig", "zed_vga", "--out", self.dir / "depth"],
             "width height density_percent trusted_percent median_sigma_px row_error camera folder"),
            (["depth-accuracy", "--distances", 1, "--repeats", 1, "--out", self.dir / "accuracy"],
             "rig distances folder"),
            (["rate", self.dir / "flat.asc", "--out", self.dir / "rated"], "width height resolution_m folder"),
            (["stairs", run], "flights drops kerbs sills doors edges assumed"),
            (["fuse", steps, "--preset", "ethz", "--out", self.dir / "fused"], "steps folder"),
            (["ground", run / "map.ply", "--origin", "0,0,0.95"], "tilt_deg height_m inlier_ratio normal"),
            (["eval", "trajectory", run / "trajectory.tum", recording / "groundtruth.tum"],
             "ate_rmse_m rpe_trans_rmse_m rpe_rot_rmse_deg drift_percent matched rpe_by_length estimate truth"),
            (["eval", "maps", run, recording],
             "elevation traversability coverage sigma by_distance by_range by_column edges floor"),
            (["eval", "depth", depth / "disparity.pfm", depth / "truth.pfm"],
             "bad_1_percent bad_2_percent density_percent auc bad_0_5_percent error sigma sparsification"),
            (["eval", "stairs", run / "stairs.json", run], "flights drops kerbs sills doors edges"),
            (["eval", "suite", "--quick", "--scenes", "floor", "--noise", 1, "--out", self.dir / "suite"], "cases scenes motion_models bins"),
            (["map", "info", region], "width height resolution_m origin_m known_cells version frame frame_since_ns "
             "stamp_ns T_frame_body config_hash layers skipped_layers file"),
            (["map", "merge", region, region, "--out", self.dir / "both.region"],
             "width height resolution_m origin_m known_cells taken agreed disagreed file"),
            (["map", "export", region, "--out", self.dir / "exported"],
             "width height resolution_m origin_m known_cells files folder"),
            (["dem", run / "map.ply", "--resolution", 0.1, "--out", self.dir / "dem.asc"],
             "width height resolution_m origin_m known_cells points skipped file"),
            (["voxel", run / "map.ply", "--size", 0.1, "--out", self.dir / "thin.ply"], "points voxels skipped size_m shift_m file"),
            (["sor", run / "map.ply", "--out", self.dir / "clean.ply"],
             "points kept skipped others mean_m std_m limit_m shift_m file"),
            (["icp", run / "map.ply", run / "map.ply"],
             "T_reference_moved converged iterations pairs rms_m nearest_rms_m sigma_m sigma_deg border_directions "
             "free_directions shift_m steps"),
            (["measure", run / "map.ply"], "levels riser going uphill_deg shift_m"),
            (["eval", "clouds", run / "map.ply", self.dir / "clean.ply", "--method", "m3c2"],
             "method count mean_m std_m rms_m min_m max_m p50_m p90_m p99_m median_abs_m p90_abs_m skipped shift_m cores "
             "significant median_lod95_m"),
            (["calibrate", "render", "--board", "chessboard:8x5:0.03", "--rig", "zed_vga", "--views", 12, "--out",
              self.dir / "chess"], "views folder"),
            (["calibrate", "mono", self.dir / "chess", "--camera", "left", "--board", "chessboard:8x5:0.03", "--out",
              self.dir / "camera"], "model width height views used rms_px sigma_px cameras rejected advice notes"),
            (["calibrate", "stereo", self.dir / "chess", "--board", "chessboard:8x5:0.03", "--out", self.dir / "rig"],
             "model views used rms_px sigma_px row_rms_px row_focal_px rectified_focal_px baseline_m rotation_rad depth_errors "
             "cameras rejected advice notes"),
            (["config"], "settings"),
            (["config", "--check"], "valid problem"),
            (["doctor"], "version machine rig depth_sigma floor steps cameras"),
            (["bench", "gate"], "benchmarks"),
            (["record", recording, "--out", self.dir / "copy"], "frames complete error folder"),
            (["rex-link", "--script", recording / "joystick.csv"], "url connections questions motions inhibited events"),
            (["serve", "sim:walk_floor", "--walk", 9, "--attest", 1, "--port", 0, "--once", "--set",
              "sim.sensor=analytic", "--audit", self.dir / "log"], "movements"),
            (["audit", "verify", self.dir / "log"], "files bytes runs verdicts gaps lost unfinished damage"),
            (["audit", "acts", self.dir / "log"], "files bytes runs verdicts gaps lost acts unfinished damage list"),
            (["audit", "replay", self.dir / "log"], "verdicts equal different first_difference"),
            (["replay", recording, "--speed", 1000], "frames late speed per_frame"),
            (["info", recording], "kind frames rate_hz gaps imu_samples has_truth"),
            (["urdf", "rex", "--out", self.dir / "rex.urdf"], "name links joints file"),
            (["rig", recording], "format width height focal_left_px focal_right_px baseline_m rectified notes written"),
        )
        self.assertEqual({tuple(v) for v in VERBS} - {("gate",), ("eval",), ("calibrate",), ("map",), ("audit",)},
                         {tuple(call[:2]) if call[0] in ("eval", "calibrate", "map", "audit") else (call[0],) for call, _ in promised})
        answers = {}
        for call, names in promised:
            with self.subTest(" ".join(map(str, call[:2]))):
                answer = self.json_of(*call)
                self.assertLessEqual(set(names.split()), set(answer))
                answers[" ".join(map(str, call[:2]))] = answer
        self.assertAlmostEqual(answers["calibrate stereo"]["baseline_m"], 0.12, delta=2e-4)
        maps = answers["eval maps"]
        self.assertLessEqual({"median_abs_m", "p90_abs_m"}, set(maps["elevation"]))
        self.assertLessEqual({"false_safe", "false_unsafe"}, set(maps["traversability"]))
        self.assertEqual({"name", "median_ms", "p99_ms", "least_cpu_ms", "median_cpu_ms", "peer_ms",
                          "peer_least_cpu_ms"},
                         set(answers["bench gate"]["benchmarks"][0]))
        self.assertEqual(len(answers[f"replay {recording}"]["per_frame"]), 3)

    def test_a_calibration_goes_through_every_format(self):
        source = self.dir / "rig.yaml"
        source.write_text("resolution: [1280, 720]\nbaseline_m: 0.12\nfocal_px: 700.5\nprincipal_px: [640, 360]\n")
        for form, name in (("opencv", "o.yml"), ("kalibr", "k.yaml"), ("ros", "folder"), ("zed", "SN1.conf"),
                           ("surefoot", "again.yaml")):
            written = self.json_of("rig", source, "--as", form, "--out", self.dir / name)["written"]
            self.assertEqual(len(written), 2 if form == "ros" else 1)
            back = self.json_of("rig", self.dir / name)
            self.assertEqual(back["format"], form)
            self.assertEqual(back["focal_right_px"], [700.5, 700.5])
            self.assertAlmostEqual(back["baseline_m"], 0.12, places=12)
            source = self.dir / name
        half = self.json_of("rig", source, "--resolution", "640x360")
        self.assertEqual((half["width"], half["focal_left_px"]), (640, [350.25, 350.25]))
        process = surefoot("rig", source, "--resolution", "640x480")
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("cannot be scaled to 640 x 480 px", process.stderr)
        for wrong in ("640", "axb", "0x0", "640x"):
            self.assertIn("--resolution", surefoot("rig", source, "--resolution", wrong).stderr)

    def test_settings_are_checked_by_every_verb(self):
        for verb, rest in (("gate", ["--map", "x", "--pose", "0,0,0", "--command", "9"]), ("info", ["x"]),
                           ("record", ["x", "--out", "y"]), ("sim", ["--list"]), ("replay", ["x"])):
            for wrong in (["--set", "no.such_key=1"], ["--config", "nowhere.yaml"], ["--preset", "nothing"]):
                process = surefoot(verb, *rest, *wrong, cwd=self.dir)
                self.assertEqual(process.returncode, 2, f"{verb} {wrong}: {process.stderr}")
        process = surefoot("info", self.dir, "--set", "elevation.length_m=8")
        self.assertIn("have no effect", process.stderr)

    def test_live_cameras_say_what_is_missing(self):
        for source, code, words in (("v4l2:video0", 2, "expected v4l2:DEVICE"), ("v4l2:/dev/null", 1, "not a video device"),
                                    ("v4l2:/nowhere", 1, "cannot be opened"), (f"v4l2:{ROOT}/README.md", 1, "not a device")):
            process = surefoot("info", source)
            self.assertEqual(process.returncode, code, process.stderr)
            self.assertIn(words, process.stderr)
        process = surefoot("run", "v4l2:/dev/null", "--out", self.dir / "live")
        self.assertEqual(process.returncode, 2, process.stderr)
        self.assertIn("--rig", process.stderr)
        process = surefoot("run", "sim:floor", "--imu", "x.csv", "--out", self.dir / "live")
        self.assertEqual(process.returncode, 2, process.stderr)

    def test_every_preset_is_known(self):
        by_default = self.run_ok("config").stdout
        for name in ("rex_zed", "rex_demo_stairs", "laser", "ethz"):
            self.assertNotEqual(self.run_ok("config", "--preset", name).stdout, by_default, name)

    def test_scene_list_is_json_too(self):
        scenes = json.loads(surefoot("sim", "--list", "--json").stdout)["scenes"]
        self.assertIn("demo_stairs", [scene["name"] for scene in scenes])


class Scenes(CliTest):
    """Simulated recordings: accepted scenes, and continuation after an interruption."""
    # Half a metre ahead to an edge: 1 s standing, 3 s walking, 0.7 s standing.
    EDGE = """name: edge
description: the ground ends after a short way
materials:
  grey: {pattern: concrete}
solids:
  - floor: {min_x_m: -2, min_y_m: -2, max_x_m: 4, max_y_m: 2, z_m: -0.3, material: grey, label: drop}
  - box: {x_m: -0.5, y_m: 0, length_m: 3, width_m: 4, bottom_m: -0.3, top_m: 0, material: grey, label: floor}
  - walls: {min_x_m: -2, min_y_m: -2, max_x_m: 4, max_y_m: 2, bottom_m: -0.3, material: grey}
motion:
  waypoints: [{x_m: 0, y_m: 0, pause_s: 1}, {x_m: 0.5, y_m: 0, pause_s: 0.7}]
"""

    def scene(self, old="", new=""):
        self.assertIn(old, self.EDGE)
        path = self.dir / "edge.yaml"
        path.write_text(self.EDGE.replace(old, new, 1))
        return path

    def test_list_draws_scenes(self):
        # Only the first scenes: all of them take minutes.
        out = self.dir / "gallery"
        names = [scene["name"] for scene in self.json_of("sim", "--list")["scenes"]]
        process = subprocess.Popen([str(BINARY), "sim", "--list", "--out", str(out)], stdout=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        pictures = [out / f"{name}{kind}.png" for name in names[:3] for kind in ("", "_height")]
        ends = time.monotonic() + 120
        while not pictures[-1].exists() and process.poll() is None and time.monotonic() < ends:
            time.sleep(0.1)
        for picture in pictures:
            self.assertGreater(min(read_png_size(picture)), 300, picture.name)
        self.assertEqual(len({picture.read_bytes() for picture in pictures}), len(pictures), "all pictures must differ")

    def test_folders_that_cannot_be_written_are_sentences(self):
        (self.dir / "file").write_text("")
        for out in ("/proc/nowhere/out", self.dir / "file" / "out", self.dir / "file"):
            for words in (["sim", "floor", "--frames", 1], ["sim", "--list"]):
                process = surefoot(*words, "--out", out, timeout=60)
                self.assertEqual(process.returncode, 1, process.stderr)
                self.assertIn(str(out), process.stderr)
                self.assertRegex(process.stderr, "cannot make this folder|is a file; a folder is needed")

    def test_impossible_scenes_are_sentences(self):
        for old, new, said in (("length_m: 3", "length_m: -3", ("edge.yaml:7", "length_m", "-3")),
                               ("pattern: concrete", "pattern: marble", ("edge.yaml:4", "'marble'", "carpet")),
                               ("material: grey}", "material: gray}", ("edge.yaml:8", "'gray'", "grey")),
                               ("x_m: 0.5,", "x_m: 3.9,", ("edge.yaml:9", "the camera or base_link", "the solid of line 8")),
                               ("x_m: 0.5,", "x_m: a_way,", ("edge.yaml:10", "a_way")),
                               ("max_x_m: 4", "max_x_m: -4", ("edge.yaml:6", "max_x_m"))):
            out = self.dir / "out"
            process = surefoot("sim", self.scene(old, new), "--frames", 1, "--out", out)
            self.assertEqual(process.returncode, 1, f"{new}: {process.stderr}")
            for words in said:
                self.assertIn(words, process.stderr, new)
            self.assertFalse(out.exists(), new)

    def recorded(self, name, *more):
        return self.run_ok("sim", self.scene(), "--rate", 2, *more, "--out", self.dir / name)

    def files(self, name):
        folder = self.dir / name
        return {str(file.relative_to(folder)): file.read_bytes() for file in folder.rglob("*") if file.is_file()}

    def cut(self, name, damaged):
        """Simulates an interruption while `damaged` was being written: later files are missing."""
        folder = self.dir / name
        for file in folder.glob("*.*"):
            if file.name not in ("config.yaml", "rig.yaml", "rgb.txt", "depth.txt"):
                file.unlink()
        for file in [*folder.glob("mav0/*/data.csv"), *folder.glob("*.txt")]:
            file.write_text("".join(file.read_text().splitlines(True)[:3]))
        for file in [*folder.rglob("*.png"), *folder.rglob("*.pfm")]:
            if float(file.stem) > damaged:
                file.unlink()
            elif float(file.stem) == damaged:
                file.write_bytes(file.read_bytes()[:-100])

    def test_a_recording_that_was_stopped_goes_on_where_it_was(self):
        self.recorded("whole", "--depth")
        whole = self.files("whole")
        frames = sorted(name for name in whole if name.startswith("mav0/cam0/data/"))
        self.assertEqual(len(frames), 10)
        self.recorded("cut", "--depth")
        self.cut("cut", 3_000_000_000)
        process = self.recorded("cut", "--depth")
        self.assertIn("4 of 10 frames already existed", process.stderr)
        self.assertEqual(self.files("cut"), whole)
        # A kept frame is not rendered again: a file changed by hand stays changed.
        image = self.dir / "cut" / frames[2]
        image.write_bytes(whole[frames[7]])
        self.recorded("cut", "--depth")
        self.assertEqual({name for name, content in self.files("cut").items() if content != whole[name]}, {frames[2]})

    def test_an_rgbd_recording_goes_on_too(self):
        rgbd = ["--set", "sim.sensor=depth_camera"]
        self.recorded("whole", *rgbd)
        self.recorded("cut", *rgbd)
        self.cut("cut", 2.5)
        process = self.recorded("cut", *rgbd)
        self.assertIn("3 of 10 frames already existed", process.stderr)
        self.assertEqual(self.files("cut"), self.files("whole"))

    def test_what_depends_on_earlier_frames_is_rendered_again(self):
        automatic = ["--set", "sim.exposure.automatic=true"]
        self.recorded("whole", *automatic)
        self.recorded("cut", *automatic)
        self.cut("cut", 3_000_000_000)
        self.assertNotIn("already", self.recorded("cut", *automatic).stderr)
        self.assertEqual(self.files("cut"), self.files("whole"))

    def test_another_recording_in_the_folder_is_a_sentence(self):
        self.recorded("out", "--frames", 2)
        before = self.files("out")
        for more, said in ((["--frames", 3], "--frames 3"), (["--frames", 2, "--seed", 5], "--seed 5"),
                           (["--frames", 2, "--set", "sim.noise=2"], "noise: 2")):
            process = surefoot("sim", self.scene(), "--rate", 2, *more, "--out", self.dir / "out")
            self.assertEqual(process.returncode, 1, process.stderr)
            self.assertIn("holds a recording already", process.stderr)
            self.assertIn(said, process.stderr)
        process = surefoot("sim", self.scene("z_m: -0.3", "z_m: -0.2"), "--rate", 2, "--frames", 2, "--out", self.dir / "out")
        self.assertEqual(process.returncode, 1, "must be refused: the scene file has changed")
        self.assertEqual(self.files("out"), before)

    def test_safety_of_a_trolley_is_asked_at_its_stops(self):
        self.recorded("out")
        head, *lines = (self.dir / "out" / "safety.csv").read_text().splitlines()
        rows = [dict(zip(head.split(","), line.split(","))) for line in lines]
        ahead = [row for row in rows if row["command"] == "9"]
        # At the start, and 1 + 3 s later: 0.5 m at 0.25 m/s plus 1 s of acceleration.
        self.assertEqual(float(ahead[0]["time_s"]), 1.0)
        self.assertAlmostEqual(float(ahead[1]["time_s"]), 5.0, delta=0.05)
        self.assertEqual([row["safe"] for row in ahead], ["1", "0"])
        self.assertIn("drop_off", ahead[1]["dangers"])
        commands = {row["command"] for row in rows}
        self.assertEqual(len(rows), 2 * len(commands))
        self.assertGreater(len(commands), 5)
        # A recording that ends before the second stop does not list it.
        self.recorded("short", "--frames", 4)
        lines = (self.dir / "short" / "safety.csv").read_text().splitlines()
        self.assertEqual(len(lines), 1 + len(commands))


def write_pfm(path, rows):
    """One float channel, little-endian, bottom row first; None = +inf = unknown."""
    values = [math.inf if x is None else x for row in reversed(rows) for x in row]
    path.write_bytes(f"Pf\n{len(rows[0])} {len(rows)}\n-1.0\n".encode() + struct.pack(f"<{len(values)}f", *values))


def read_png_size(path):
    content = path.read_bytes()
    assert content[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", content[16:24])


class Measures(CliTest):
    """Results of the measuring verbs, compared with values computed by hand or in Python."""

    def test_eval_stairs_by_hand(self):
        found, truth = self.dir / "run" / "stairs.json", self.dir / "truth.json"
        found.parent.mkdir()
        flight = {"kind": "up", "steps": 4, "riser_m": 0.172, "going_m": 0.285, "pose": [1.02, 0.1, 0, 0.05]}
        kerb = {"kind": "down", "height_m": 0.1, "pose": [5, 0, 0, 0]}
        found.write_text(json.dumps({"flights": [flight], "kerbs": [kerb], "drops": []}))
        flight.update(riser_m=0.17, going_m=None, pose=[1, 0, 0, 0])
        kerb.update(kind="up")
        truth.write_text(json.dumps({"flights": [flight], "kerbs": [kerb]}))
        errors = json.loads(self.run_ok("eval", "stairs", found.parent, truth, "--json").stdout)
        flights = errors["flights"]
        self.assertEqual([flights[k] for k in ("truth", "found", "matched", "steps_right", "recall", "precision")], [1, 1, 1, 1, 1, 1])
        self.assertAlmostEqual(flights["riser"]["mean_m"], 0.002)
        self.assertAlmostEqual(flights["across"]["mean_m"], 0.02)
        self.assertEqual(flights["going"], {"count": 0, "mean_m": None, "std_m": None, "max_abs_m": None})
        self.assertEqual((errors["kerbs"]["matched"], errors["kerbs"]["missed"], errors["kerbs"]["extra"]), (0, [[5, 0, 0, 0]], [[5, 0, 0, 0]]))
        self.assertIsNone(errors["drops"])  # the truth has no drops
        self.assertIn("number of steps correct in 1 of 1", self.run_ok("eval", "stairs", found, truth).stdout)
        narrow = json.loads(self.run_ok("eval", "stairs", found, truth, "--across", 0.01, "--json").stdout)
        self.assertEqual(narrow["flights"]["matched"], 0)
        for text, says in (('{"flights": 3}', "flights is not a list"), ('{"flights": [{"kind": "up", "steps": 2}]}', "flights[0].pose"),
                           ('{"kerbs": [{"pose": [0, 0, 0, 0]}]}', "kerbs[0].kind"), ("{}", "no list of flights"), ("[1]", "not a JSON object"),
                           ('{"edges": [{"from": [0, 0], "to": [0, "x"]}]}', "edges[0].to"), ('{"sills": [', "truth.json"),
                           ('{"flights": [{"kind": "up", "steps": -1, "pose": [0, 0, 0, 0]}]}', "flights[0].steps")):
            truth.write_text(text)
            process = surefoot("eval", "stairs", found, truth)
            self.assertEqual(process.returncode, 1, text)
            self.assertIn(says, process.stderr)
            self.assertIn("truth.json", process.stderr)

    def test_eval_depth_by_hand(self):
        folder = ROOT / "tests" / "conformance" / "depth"
        got = self.json_of("eval", "depth", folder / "disparity.pfm", folder / "truth.pfm", "--sigma",
                           folder / "sigma.pfm")
        # 11 pixels have a truth; 8 are known with errors 0 .75 -1.5 2.5 | 0 .25 3 0; the gaps are filled with
        # 9.75 (error -.25) and twice 20.25 (.25).
        self.assertEqual(got["pixels"], 11)
        for name, value in (("density_percent", 800 / 11), ("bad_0_5_percent", 400 / 11), ("bad_1_percent", 300 / 11),
                            ("bad_2_percent", 200 / 11), ("known_bad_0_5_percent", 50), ("known_bad_1_percent", 37.5),
                            ("known_bad_2_percent", 25)):
            self.assertAlmostEqual(got[name], value, places=9, msg=name)
        self.assertAlmostEqual(got["error"]["mean_px"], 5 / 8)
        # Error over sigma: 0 1.5 1.5 1.25 | 0 1 3 0.
        self.assertEqual([got["sigma"][f"within_{k}_sigma"] for k in (1, 2, 3)], [4 / 8, 7 / 8, 1])
        pairs = [(0.25, 0), (0.5, 0.75), (1, 1.5), (2, 2.5), (0.25, 0), (0.25, 0.25), (1, 3), (0.25, 0)]
        # Equal sigmas share the mean of their errors.
        tied = {s: statistics.mean(e for t, e in pairs if t == s) for s, _ in pairs}

        def area(errors):
            return statistics.mean(statistics.mean(errors[:m]) for m in range(1, len(errors) + 1))
        ordered, oracle = area([tied[s] for s, _ in sorted(pairs)]), area(sorted(e for _, e in pairs))
        chance = statistics.mean(e for _, e in pairs)
        self.assertAlmostEqual(got["auc"], (ordered - oracle) / (chance - oracle), places=9)

    def test_eval_depth_reads_scaled_truth_and_mask(self):
        write_pfm(self.dir / "est.pfm", [[10.0] * 4] * 2)
        truth = self.dir / "truth.png"
        truth.write_bytes(grey_png(4, 2))  # all values 128
        answer = self.json_of("eval", "depth", self.dir / "est.pfm", truth, "--scale", 16)
        self.assertAlmostEqual(answer["error"]["mean_px"], 10 - 128 / 16)
        self.assertIsNone(answer["auc"])
        process = surefoot("eval", "depth", self.dir / "est.pfm", truth, "--mask", truth)
        self.assertEqual(process.returncode, 1)  # 128 is not the value for "seen by both cameras"
        self.assertIn("no pixel", process.stderr)
        (self.dir / "small.png").write_bytes(grey_png(3, 2))
        process = surefoot("eval", "depth", self.dir / "est.pfm", self.dir / "small.png")
        self.assertEqual(process.returncode, 1)
        self.assertIn("4 x 2", process.stderr)

    def test_dem_by_hand_on_both_lattices(self):
        (self.dir / "c.xyz").write_text("-0.1 0 1\n0.0 0.9 2\n0.4 0.9 5\n0.5 1.0 3\n")

        def dem(*options):
            answer = self.json_of("dem", self.dir / "c.xyz", "--resolution", 0.5, "--out", self.dir / "d.asc", *options)
            return (answer, *read_asc(self.dir / "d.asc"))
        answer, header, rows = dem()
        self.assertEqual((answer["points"], answer["known_cells"], answer["skipped"]), (4, 3, 0))
        self.assertEqual((header["xllcorner"], header["yllcorner"], header["cellsize"]), (-0.5, 0, 0.5))
        self.assertEqual(rows, [[None, None, 3], [None, 5, None], [1, None, None]])  # largest y first
        self.assertEqual(dem("--reduce", "min")[2][1][1], 2)
        self.assertEqual(dem("--reduce", "mean")[2][1][1], 3.5)
        _, header, rows = dem("--lattice", "node")
        self.assertAlmostEqual(header["xllcorner"], -0.35)
        # Centres at x -0.1, 0.4 and y 0, 0.5, 1: the last two points share one.
        self.assertEqual(rows, [[2, 5], [None, None], [1, None]])

    def test_dem_agrees_with_cloudcompare(self):
        folder = self.data("conformance", "clouds")
        self.run_ok("dem", folder / "ref_e1.ply", "--resolution", 0.025, "--lattice", "node", "--reduce", "max",
                    "--out", self.dir / "d.asc")
        header, rows = read_asc(self.dir / "d.asc")
        known = {(ix, len(rows) - 1 - row): z for row, line in enumerate(rows) for ix, z in enumerate(line)
                 if z is not None}
        lines = [line.split() for line in (folder / "dem_0.025_MAX.asc").read_text().splitlines()
                 if not line.startswith("//")]
        points = [tuple(float(word) for word in line[:3]) for line in lines]
        self.assertEqual(len(known), len(points))
        for x, y, z in points:
            cell = (round((x - header["xllcorner"]) / 0.025 - 0.5), round((y - header["yllcorner"]) / 0.025 - 0.5))
            self.assertAlmostEqual(known[cell], z, delta=1e-6)

    def test_dem_refuses_what_is_no_map(self):
        (self.dir / "far.xyz").write_text("0 0 0\n1e9 1e9 0\n")
        process = surefoot("dem", self.dir / "far.xyz", "--resolution", 0.01, "--out", self.dir / "d.asc")
        self.assertEqual(process.returncode, 2, process.stderr)
        self.assertIn("choose larger cells", process.stderr)

    def test_trajectories_of_other_programs_are_read_and_named(self):
        stamps = [1403636579000000000 + 50000000 * i for i in range(40)]
        place = lambda i: (0.1 * i, 0.02 * math.sin(i), 0.01 * i)
        turn = lambda i: (0.0, 0.0, math.sin(0.01 * i), math.cos(0.01 * i))
        row = lambda stamp, i: " ".join([stamp, *(f"{v:.9f}" for v in (*place(i), *turn(i)))]) + "\n"
        seconds = lambda ns: f"{ns // 10**9}.{ns % 10**9:09d}"
        tum = [row(seconds(ns), i) for i, ns in enumerate(stamps)]

        def matrix(i):
            c, s = math.cos(0.02 * i), math.sin(0.02 * i)
            x, y, z = place(i)
            return f"{c:.9f} {-s:.9f} 0 {x:.9f} {s:.9f} {c:.9f} 0 {y:.9f} 0 0 1 {z:.9f}\n"
        euroc = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n"
        for i, ns in enumerate(stamps):
            x, y, z, w = turn(i)
            euroc += ",".join([str(ns), *(f"{v:.9f}" for v in (*place(i), w, x, y, z))]) + "\n"
        kitti = "".join(matrix(i) for i in range(40))
        files = {"truth.tum": ("".join(tum), "TUM", "s"), "dup.tum": ("".join(tum[:9] + tum[8:]), "TUM", "s"),
                 "unsorted.tum": ("".join(tum[20:] + tum[:20]), "TUM", "s"),
                 "header.tum": ("timestamp tx ty tz qx qy qz qw\n" + "".join(tum), "TUM", "s"),
                 "nan.tum": (seconds(1) + " NaN" * 7 + "\n" + "".join(tum), "TUM", "s"),
                 "num.csv": ("num, t, x, y, z, qx, qy, qz, qw\n" + "".join(
                     f"{i}, " + line.replace(" ", ", ") for i, line in enumerate(tum)), "columns by name", "s"),
                 "ns.tum": ("".join(row(f"{ns}.000000", i) for i, ns in enumerate(stamps)), "TUM", "ns"),
                 "euroc.csv": (euroc, "EuRoC csv", "ns"),
                 "kitti.txt": (kitti, "KITTI poses", "the same rows as the other trajectory")}
        for name, (text, kind, unit) in files.items():
            (self.dir / name).write_text(text)
            for pair in ((name, "truth.tum"), ("truth.tum", name)):
                answer = self.json_of("eval", "trajectory", *(self.dir / file for file in pair))
                self.assertLess(answer["ate_rmse_m"], 1e-6, pair)
                self.assertEqual(answer["matched"], 40, pair)
                read = answer["estimate" if pair[0] == name else "truth"]
                self.assertEqual((read["format"], read["stamps"]), (kind, unit), pair)
                self.assertEqual((read["repeated"], read["not_finite"], read["sorted"]),
                                 (int(name == "dup.tum"), int(name == "nan.tum"), name == "unsorted.tum"), pair)
        said = surefoot("eval", "trajectory", self.dir / "dup.tum", self.dir / "euroc.csv")
        self.assertIn("estimate: TUM, stamps: s, 40 poses\ntruth: EuRoC csv, stamps: ns, 40 poses\n", said.stdout)
        self.assertIn("1 rows with a repeated time stamp are left out", said.stderr)
        (self.dir / "times.txt").write_text("".join(f"{ns}\n" for ns in stamps))
        answer = self.json_of("eval", "trajectory", self.dir / "kitti.txt", self.dir / "truth.tum", "--times",
                              self.dir / "times.txt")
        self.assertLess(answer["ate_rmse_m"], 1e-6)
        (self.dir / "times.txt").unlink()
        (self.dir / "zero.tum").write_text("".join(tum[:5]) + f"{seconds(stamps[5])} 1 2 3 0 0 0 0\n")
        (self.dir / "short.txt").write_text(kitti[:kitti.rindex("\n", 0, -1) + 1])
        for words, why in ((["zero.tum", "truth.tum"], "zero.tum:6: quaternion has length 0"),
                           (["short.txt", "truth.tum"], "39 poses have no time stamps")):
            process = surefoot("eval", "trajectory", *(self.dir / file for file in words))
            self.assertEqual(process.returncode, 1)
            self.assertIn(why, process.stderr)
        process = surefoot("eval", "trajectory", self.dir / "truth.tum", self.dir / "truth.tum", "--times", "x.txt")
        self.assertEqual(process.returncode, 2)

    def test_pictures_and_lengths(self):
        recording, run = self.dir / "recording", self.dir / "run"
        self.run_ok("sim", "floor", "--frames", 6, "--out", recording)
        self.run_ok("run", recording, "--out", run, "--machine", "rex")
        answer = self.json_of("eval", "trajectory", run / "trajectory.tum", recording / "groundtruth.tum", "--delta",
                              0.02, "--delta", 7, "--plot", self.dir / "t.png")
        self.assertEqual([entry["length_m"] for entry in answer["rpe_by_length"]], [0.02, 7])
        self.assertEqual(answer["rpe_by_length"][1]["count"], 0)
        self.assertIsNone(answer["rpe_by_length"][1]["trans_rmse_m"])
        self.assertGreater(min(read_png_size(self.dir / "t.png")), 800)
        maps = self.json_of("eval", "maps", run, recording, "--out", self.dir / "pictures")
        for name in ("confusion.png", "error.png"):
            self.assertGreater(min(read_png_size(self.dir / "pictures" / name)), 400)
        print(f"floor map: spread {maps['floor']['spread_m']}, edges p99 {maps['edges']['p99_abs_m']}, {maps['sigma']}")
        cells = maps["elevation_away_from_edges"]["count"]
        self.assertGreater(cells, 1000)
        self.assertEqual(sum(entry["count"] for entry in maps["by_distance"]), cells)
        # Some frame saw every mapped cell, so nearly all cell centres fall into an image.
        self.assertGreater(sum(entry["count"] for entry in maps["by_column"]), 0.9 * cells)
        self.assertEqual(len(maps["edges"]["by_column"]), 8)
        self.assertLess(maps["floor"]["tilt_deg"], 1.0)
        # The comparison also works without poses.
        for name in ("trajectory.tum", "variance.asc", "report.json"):
            (run / name).unlink()
        less = self.json_of("eval", "maps", run, recording)
        self.assertEqual((less["by_distance"], less["by_column"], less["sigma"]["count"]), ([], [], 0))
        self.assertEqual(less["elevation"], maps["elevation"])


if __name__ == "__main__":
    unittest.main()
