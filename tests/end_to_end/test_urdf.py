"""`surefoot urdf`: the model of a machine, checked with the programs that read URDF."""
import shutil
import subprocess
import unittest
import xml.etree.ElementTree

from surefoot_cli import ROOT, CliTest, surefoot


class Urdf(CliTest):
    def test_a_foreign_reader_takes_it(self):
        self.assertTrue(shutil.which("check_urdf"), "check_urdf is missing: run tools/setup to install it (liburdfdom-tools)")
        file = self.dir / "rex.urdf"
        self.run_ok("urdf", "rex", "--out", file)
        checked = subprocess.run(["check_urdf", file], capture_output=True, text=True, timeout=60)
        self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
        self.assertIn("robot name is: rex", checked.stdout)
        self.assertIn("root Link: base_link has 2 child(ren)", checked.stdout)
        for link in ("camera", "pelvis", "left_foot", "right_sole"):
            self.assertRegex(checked.stdout, rf"child\(\d\):  {link}\n")
        self.assertEqual(checked.stderr, "")

    def test_file_name_and_built_in_name_give_the_text_of_the_repository(self):
        text = (ROOT / "models" / "rex.urdf").read_text()
        self.assertEqual(self.run_ok("urdf", "rex").stdout, text)
        self.assertEqual(self.run_ok("urdf", ROOT / "models" / "rex.yaml").stdout, text)

    def test_boxes_have_materials_of_the_robot(self):
        robot = xml.etree.ElementTree.fromstring(self.run_ok("urdf", "rex").stdout)
        named = {material.get("name") for material in robot.findall("material")}
        used = {material.get("name") for material in robot.findall("link/visual/material")}
        self.assertEqual(named, used)
        self.assertFalse(robot.findall("link/visual/material/color"), "each colour must be defined only once")
        self.assertEqual(len(robot.findall("link/visual")), 10)
        self.assertEqual(len(robot.findall("link/collision")), 10)

    def test_what_is_wrong_is_said(self):
        broken = self.dir / "broken.yaml"
        text = (ROOT / "models" / "rex.yaml").read_text()
        for old, new, said in (("parent: right_ankle", "parent: right_ankel", "there is no link 'right_ankel' in `links`; did you mean"),
                               ("size_x_m: 0.366", "size_x_m: -0.366", "-0.366 is outside"),
                               ("max_deg: 93.0", "max_deg: 0.0", "is empty")):
            broken.write_text(text.replace(old, new, 1))
            process = surefoot("urdf", broken)
            self.assertEqual((process.returncode, process.stdout), (2, ""), said)
            self.assertIn("broken.yaml:", process.stderr)
            self.assertIn(said, process.stderr)
        process = surefoot("urdf", "rexx")
        self.assertEqual(process.returncode, 2)
        self.assertIn("did you mean 'rex'", process.stderr)


if __name__ == "__main__":
    unittest.main()
