"""Messages and requests of the engineer's view: stairs, settings, recordings (service/page/messages.json)."""
import json
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

from surefoot_cli import BINARY, surefoot
from test_page import SCENE, PageTest

LISTS = ("flights", "drops", "kerbs", "sills", "doors", "edges")


def exactly(text):
    return json.loads(text, parse_float=str)


class Stairs(PageTest):
    """The demonstration scene: three steps, a ramp, a table and a pit; analytic depth and known motion."""
    SCENE = ("sim:demo_stairs", "--machine", "rex", "--max-frames", "40", "--set", "sim.sensor=analytic")

    @classmethod
    def setUpClass(cls):
        cls.serve(*cls.SCENE, "--speed", "1")

    def test_pages_are_told_what_a_run_says(self):
        page = self.page()
        page.want(stairs=True)
        stranger = self.page()
        stranger.want()
        began = time.monotonic()
        page.wait_for("status", lambda said: said["state"] == "ended", 120)
        seconds = time.monotonic() - began
        page.listen(1.0)
        stranger.listen(1.0)
        self.assertEqual(stranger.told("stairs"), [], "a page that did not ask must get no stairs")
        messages = page.told("stairs")
        self.assertGreater(len(messages), 1)
        self.assertLess(len(messages), 3 * seconds + 3, "at most three messages per second")
        for before, after in zip(messages, messages[1:]):
            self.assertNotEqual({name: before[name] for name in LISTS}, {name: after[name] for name in LISTS})
        self.run_ok("run", *self.SCENE, "--out", self.dir / "run")
        said = exactly((self.dir / "run" / "stairs.json").read_text())
        self.assertTrue(said["flights"])
        told = exactly(json.dumps(messages[-1]))
        # A page also shows features of a single observation, but not the uncertainty of each edge.
        for name in LISTS:
            names = set().union(*(thing.keys() for thing in told[name]))
            of_run = [{key: value for key, value in thing.items() if key in names}
                      for thing in said[name] + said["unconfirmed"][name]]
            self.assertCountEqual(told[name], of_run, name)
        # A page that connects later gets the same stairs.
        late = self.page()
        late.want(stairs=True)
        self.assertEqual(late.wait_for("stairs"), messages[-1])
        late.listen(1.0)
        self.assertEqual(len(late.told("stairs")), 1, "no second message without a change")


class Settings(PageTest):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.log = open(cls.folder.name + "/stderr", "w+", encoding="utf-8")
        cls.serve(*SCENE, "--set", "elevation.length_m=5", stderr=cls.log)

    @classmethod
    def tearDownClass(cls):
        super().tearDownClass()
        cls.log.close()
        cls.folder.cleanup()

    def logged(self):
        return pathlib.Path(self.log.name).read_text(encoding="utf-8")

    def set(self, page, key, value):
        before = len(page.told("setting"))
        page.ask(op="set", key=key, value=value)
        while len(page.told("setting")) == before:
            page.listen(0.05)
            self.assertIsNone(page.goodbye)
        answer = page.told("setting")[-1]
        self.assertEqual(answer["key"], key)
        return answer

    def test_all_of_the_run_are_listed_and_few_may_change(self):
        page = self.page()
        page.want(settings=True)
        settings = {one["key"]: one for one in page.wait_for("settings")["settings"]}
        run = {one["key"]: one for one in self.json_of("config", "--set", "sim.sensor=analytic", "--set",
                                                       "elevation.length_m=5")["settings"]}
        self.assertEqual(set(run) - set(settings), set())
        self.assertEqual(set(settings) - set(run), {one for one in settings if settings[one]["changeable"]})
        self.assertEqual((settings["elevation.length_m"]["value"], settings["elevation.length_m"]["unit"]), ("5", "m"))
        for key, one in run.items():
            self.assertEqual((settings[key]["range"], settings[key]["comment"]), (one["range"], one["comment"]), key)
        # Settings that serve adapts to the machine are shown with their used values.
        self.assertNotEqual(settings["ground.expected_height_m"]["value"], run["ground.expected_height_m"]["value"])
        page.want(settings=True, map_hz=1)
        page.listen(0.5)
        self.assertEqual(len(page.told("settings")), 1, "unchanged settings must not be sent again")

    def test_the_speed_changes_and_everybody_is_told(self):
        page, other = self.page(), self.page()
        other.want(settings=True)
        other.wait_for("settings")
        before = len(page.listen(4.0).poses)
        other.listen(0.1)  # a page that does not answer pings for 10 s is disconnected
        answer = self.set(page, "service.speed", "0.01")
        self.assertTrue(answer["accepted"], answer)
        self.assertEqual(answer["value"], "0.01")
        page.listen(1.0)  # one frame may still be in transit
        other.listen(0.1)
        slow = len(page.poses)
        slow = len(page.listen(4.0).poses) - slow
        self.assertLess(slow, 2)
        self.assertGreater(before, slow + 2)
        self.assertEqual([one["value"] for one in other.wait_for("settings", lambda said: len(other.told("settings")) > 1)["settings"]
                          if one["key"] == "service.speed"], ["0.01"])
        self.assertIn("service.speed is now 0.01, because a page changed this setting", self.logged())
        self.assertTrue(self.set(page, "service.speed", "0.2")["accepted"])

    def test_fewer_maps_are_sent(self):
        page = self.page()
        self.assertTrue(self.set(page, "service.speed", "0.5")["accepted"])
        page.want(map_hz=10)
        page.listen(4.0)
        before = len(page.map_bytes)
        self.assertGreater(before, 6)
        self.assertTrue(self.set(page, "page.map_hz", "0.5")["accepted"])
        page.listen(2.5)  # one may still be in transit
        before = len(page.map_bytes)
        page.listen(4.0)
        self.assertLessEqual(len(page.map_bytes) - before, 3)
        self.assertTrue(self.set(page, "page.map_hz", "10")["accepted"])
        self.assertTrue(self.set(page, "service.speed", "0.2")["accepted"])

    def nice_values(self):
        threads = pathlib.Path(f"/proc/{self.service.pid}/task").iterdir()
        return {int(thread.name): int((thread / "stat").read_text().rsplit(")", 1)[1].split()[16]) for thread in threads}

    def test_perception_stands_further_back(self):
        before = self.nice_values()
        self.assertTrue(self.set(self.page(), "service.niceness", "7")["accepted"])
        after = self.nice_values()
        self.assertEqual(after[self.service.pid], before[self.service.pid], "the supervising thread")
        self.assertEqual({value for thread, value in after.items() if thread != self.service.pid}, {7})

    def test_what_is_refused_is_said_and_nothing_changes(self):
        page = self.page()
        page.want(settings=True)
        before = {one["key"]: one["value"] for one in page.wait_for("settings")["settings"]}
        for key, value, words in (("page.map_hz", "50", "outside 0.2 .. 10"), ("page.image_hz", "fast", "is not a number"),
                                  ("service.niceness", "1.5", "is not a whole number"),
                                  ("elevation.length_m", "8", "--set elevation.length_m=8"),
                                  ("gate.step_up_m", "9", "there is no setting")):
            answer = self.set(page, key, value)
            self.assertFalse(answer["accepted"], key)
            self.assertIn(words, answer["text"])
            self.assertEqual(answer["value"], before.get(key, ""))
        self.assertIn("a page cannot change a setting: page.map_hz: '50' is outside 0.2 .. 10", self.logged())
        page = self.page()
        page.ask(op="set", key="page.map_hz", value=5)
        self.assertIn("expected", page.listen(3.0).goodbye[1])

    def test_nothing_is_recorded_where_no_folder_was_named(self):
        page = self.page()
        said = page.wait_for("recording")
        self.assertEqual(said["state"], "off")
        self.assertIn("--record-dir", said["text"])
        page.ask(op="record", on=True)
        self.assertIn("--record-dir", page.listen(3.0).goodbye[1])


class Recording(PageTest):
    FRAMES = 60

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.source = cls.folder.name + "/floor"
        cls.records = pathlib.Path(cls.folder.name) / "rec"
        subprocess.run([BINARY, "sim", "floor", "--frames", str(cls.FRAMES), "--out", cls.source], check=True, capture_output=True)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def start(self, *words, records=None):
        PageTest.serve.__func__(type(self), self.source, "--record-dir", str(records or self.records), *words)
        self.addCleanup(PageTest.tearDownClass.__func__, type(self))
        page = self.page()
        page.wait_for("recording", lambda said: said["state"] == "ready")
        page.ask(op="playback", paused=True, frame=0)
        page.wait_for("status", lambda said: said["playback"]["paused"] and said["playback"]["frame"] == 0)
        return page

    def test_what_a_page_records_can_be_read_and_run(self):
        page = self.start("--speed", "0.5")
        other = self.page()
        page.ask(op="record", on=True)
        page.wait_for("recording", lambda said: said["state"] == "recording")
        page.ask(op="playback", paused=False)
        seen = other.wait_for("recording", lambda said: said["frames"] > 14)
        self.assertEqual(seen["state"], "recording", "every page must see the recording")
        page.ask(op="record", on=False)
        said = page.wait_for("recording", lambda said: said["state"] == "ready")
        self.assertEqual(said["left_out"], 0)
        self.assertEqual(pathlib.Path(said["folder"]).parent, self.records)
        self.assertRegex(pathlib.Path(said["folder"]).name, r"^\d{8}T\d{6}Z(-\d+)?$")
        info = self.json_of("info", said["folder"])
        self.assertEqual((info["kind"], info["frames"], info["bytes"]), ("euroc", said["frames"], said["bytes"]))
        self.assertEqual((info["unpaired"], info["missing_images"], info["bad_stamps"], info["gaps"]), (0, 0, 0, 0))
        self.assertAlmostEqual(info["duration_s"], said["duration_s"])
        names = sorted(path.name for path in pathlib.Path(said["folder"]).glob("mav0/cam0/data/*"))
        for name in (names[0], names[-1]):
            for eye in ("cam0", "cam1"):
                image = pathlib.Path("mav0") / eye / "data" / name
                self.assertEqual((pathlib.Path(said["folder"]) / image).read_bytes(), (pathlib.Path(self.source) / image).read_bytes(),
                                 "without loss")
        report = self.json_of("run", said["folder"], "--machine", "rex", "--max-frames", 12, "--out", self.dir / "run")
        self.assertEqual((report["frames"], report["complete"]), (12, True))

    def test_a_jump_back_ends_it_and_the_end_of_the_service_keeps_it(self):
        page = self.start("--speed", "0.5")
        page.ask(op="record", on=True)
        page.wait_for("recording", lambda said: said["state"] == "recording")
        page.ask(op="playback", paused=False)
        page.wait_for("recording", lambda said: said["frames"] > 14)
        page.ask(op="playback", frame=2)
        said = page.wait_for("recording", lambda said: said["state"] == "ready")
        self.assertIn("back in time", said["text"])
        self.assertEqual(self.json_of("info", said["folder"])["frames"], said["frames"])
        page.ask(op="record", on=True)
        said = page.wait_for("recording", lambda said: said["state"] == "recording" and said["frames"] > 5)
        self.service.send_signal(signal.SIGTERM)
        self.service.wait(timeout=30)
        self.assertGreaterEqual(self.json_of("info", said["folder"])["frames"], said["frames"])

    def test_a_folder_that_cannot_be_made_is_said(self):
        (self.dir / "file").write_text("in the way")
        page = self.start(records=self.dir / "file" / "rec")
        page.ask(op="record", on=True)
        said = page.wait_for("recording", lambda said: said["state"] == "failed")
        self.assertIn("file/rec: cannot make this folder", said["text"])
        self.assertIsNone(page.listen(0.5).goodbye, "the connection must stay open")

    def test_without_a_page_nobody_could_begin_one(self):
        process = surefoot("serve", self.source, "--no-page", "--record-dir", self.records, "--port", 0, timeout=60)
        self.assertEqual(process.returncode, 2)
        self.assertIn("--record-dir", process.stderr)


if __name__ == "__main__":
    unittest.main()
