"""Calibration files of other programs and machine files of other users, read by each of our programs."""
import json
import subprocess
import unittest

from surefoot_cli import BINARY, ROOT, CliTest, surefoot

GATE = BINARY.parent / "surefoot-gate"
MATRICES = """%YAML:1.0
---
mtxL: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 700, 0, 640, 0, 700, 360, 0, 0, 1 ]
distL: [ -0.17, 0.03, 0.001, -0.0005, 0 ]
mtxR: [ 702, 0, 642, 0, 702, 358, 0, 0, 1 ]
distR: [ -0.17, 0.03, 0.001, -0.0005, 0 ]
R: [ 0, 0.006981317007977318, 0 ]
T: [ -0.12, 0.0004, 0.0002 ]
"""


class Calibrations(CliTest):
    def test_the_size_is_given_where_the_file_does_not_hold_it(self):
        file = self.dir / "stereo.yml"
        file.write_text(MATRICES)
        process = surefoot("rig", file)
        self.assertEqual(process.returncode, 1)
        self.assertIn("--resolution WIDTHxHEIGHT", process.stderr)
        answer = self.json_of("rig", file, "--resolution", "1280x720", "--out", self.dir / "rig.yaml")
        self.assertEqual((answer["format"], answer["width"], answer["focal_right_px"]), ("opencv", 1280, [702, 702]))
        self.assertIn("rotation vector", answer["notes"][0])
        self.assertAlmostEqual(self.json_of("rig", self.dir / "rig.yaml")["baseline_m"], answer["baseline_m"], places=12)

    def test_every_command_says_what_the_file_looks_like(self):
        file = self.dir / "vins.yaml"
        file.write_text("%YAML:1.0\nmodel_type: PINHOLE\nprojection_parameters:\n   fx: 460\n")
        for call in (["rig", file], ["depth-accuracy", "--rig", file, "--out", self.dir / "out"],
                     ["run", "sim:floor", "--rig", file, "--out", self.dir / "out"], ["doctor", "--rig", file],
                     ["calibrate", "render", "--board", "chessboard:8x5:0.03", "--rig", file, "--out", self.dir / "b"]):
            process = surefoot(*call)
            self.assertNotEqual(process.returncode, 0, call)
            self.assertIn("looks like a VINS or camodocal calibration", process.stderr, call)
            self.assertNotIn("T_left_right", process.stderr, call)

    def test_an_unusual_baseline_is_said_by_every_command(self):
        file = self.dir / "squares.yml"
        file.write_text("image_width: 1280\nimage_height: 720\n" +
                        MATRICES.split("---\n")[1].replace("-0.12, 0.0004", "-3.327, 0.01"))
        for call in (["rig", file], ["doctor", "--rig", file]):
            self.assertIn("in squares of a chessboard?", self.run_ok(*call).stderr, call)

    def test_ros_messages_of_a_folder(self):
        for name, offset in (("left.yaml", 0), ("right.yaml", -43.84)):
            (self.dir / name).write_text(
                "header:\n  frame_id: cam\nheight: 480\nwidth: 752\ndistortion_model: plumb_bob\n"
                "d:\n- 0.0547\n- 0.1797\n- -0.00099\n- 0.00118\n- -0.729\n"
                "k: [719.87, 0, 386.1, 0, 719.73, 217.1, 0, 0, 1]\nr: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
                f"p: [721.13, 0, 387.7, {offset}, 0, 721.13, 222.4, 0, 0, 0, 1, 0]\n---\n")
        answer = self.json_of("rig", ".", cwd=self.dir)
        self.assertEqual((answer["format"], answer["width"], round(1e3 * answer["baseline_m"], 2)), ("ros", 752, 60.79))


class Machines(CliTest):
    REX = (ROOT / "machines" / "rex.yaml").read_text()
    SIGNED = ("deviations:\n  - {key: limits.KEY, value: VALUE, reason: a trial with a spotter, signed: J. Doe, "
              "date: 2026-11-27}\n")

    def programs(self, text):
        """Runs `surefoot gate` and `surefoot-gate` with a machine file; both end before they need a map."""
        file = self.dir / "machine.yaml"
        file.write_text(text)
        offline = surefoot("gate", "--map", self.dir / "nothing", "--pose", "0,0,0", "--command", "9", "--machine", file,
                           "--json")
        service = subprocess.run([GATE, "--snapshots", self.dir / "x", "--machine", file, "--port", "0", "--assured"],
                                 capture_output=True, text=True, timeout=60)
        return offline, service

    def refused(self, text, *words):
        offline, service = self.programs(text)
        for process in (offline, service):
            self.assertEqual(process.returncode, 2 if process is service else process.returncode)
            self.assertNotEqual(process.returncode, 0)
            for word in words:
                self.assertIn(word, process.stderr)
            self.assertNotIn("--audit", process.stderr)  # the check after the machine file

    def test_a_step_that_the_gait_cannot_make(self):
        self.refused(self.REX.replace("walk: {enabled: true, up_m: 0.02", "walk: {enabled: true, up_m: 0.3"),
                     "walk.up_m 0.3 is above swing_clearance_m 0.04")

    def test_a_laxer_limit_needs_a_signature(self):
        lax = self.REX.replace("tilt_deg: 6.0", "tilt_deg: 8")
        self.refused(lax, "limits.tilt_deg: 8 is laxer than the rated limit 6", "signed: NAME")
        signed = lax + self.SIGNED.replace("KEY", "tilt_deg").replace("VALUE", "8")
        offline, service = self.programs(signed)
        said = "limits.tilt_deg is 8 (rated 6), signed by J. Doe on 2026-11-27: a trial with a spotter"
        for process in (offline, service):
            self.assertIn(said, process.stderr)
        self.assertIn("--audit", service.stderr)  # the machine was accepted
        self.refused(signed.replace("tilt_deg: 8", "tilt_deg: 9"), "8 was signed, but limits.tilt_deg is 9")

    def test_a_signature_does_not_replace_the_self_test(self):
        """The file signs for steps of up to 150 mm; the gate's own check must still refuse it."""
        text = self.REX.replace("up_m: 0.02, down_m: 0.02", "up_m: 0.15, down_m: 0.02")
        text = text.replace("swing_clearance_m: 0.04", "swing_clearance_m: 0.2")
        lines = self.SIGNED.replace("KEY", "walk.up_m").replace("VALUE", "0.15")
        lines += self.SIGNED.split("\n")[1].replace("KEY", "swing_clearance_m").replace("VALUE", "0.2") + "\n"
        self.refused(text + lines, "the gate fails its self-test, the question")

    def test_both_programs_take_the_rex(self):
        offline, service = self.programs(self.REX)
        self.assertIn(json.loads(offline.stdout)["verdict"], ("ERROR",))
        self.assertIn("--audit", service.stderr)


if __name__ == "__main__":
    unittest.main()
