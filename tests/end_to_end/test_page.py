"""`surefoot serve` from the view of a browser: files, the WebSocket at /page, its messages (service/page/messages.json)."""
import gzip
import http.client
import json
import math
import re
import socket
import ssl
import struct
import subprocess
import tempfile
import time
import unittest

from surefoot_cli import BINARY, ROOT, CliTest
from websocket_client import RosbridgeClient

# A trolley that rolls slowly over level ground, so that it still rolls at the end of the tests.
SCENE = ("sim:floor", "--speed", "0.2", "--set", "sim.sensor=analytic")
MAP, POSE, IMAGE, LAYER = 1, 2, 3, 4
MAP_HEAD = struct.Struct("<QqqqiIHHBBHI")
POSE_HEAD = struct.Struct("<q3d4f4fBBH")
LAYER_HEAD = struct.Struct("<QqqIHHHH")


class Page(RosbridgeClient):
    """A page. `ground` is the map as received: cell of odom -> (height [mm], sigma [mm], state)."""

    def __init__(self, port, connected=None):
        super().__init__(port, path="/page", connected=connected)
        self.ground, self.wholes, self.map_bytes, self.versions = {}, 0, [], {}
        self.joints, self.values = [], {}
        self.poses, self.layers, self.images, self.texts, self.goodbye = [], [], [], [], None

    def want(self, **keys):
        self.send(1, json.dumps({"op": "want", **keys}).encode())

    def listen(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end and self.goodbye is None:
            self.take(*self.read())
        return self

    def take(self, opcode, payload):
        if opcode == 9:
            self.send(10, payload)
        if opcode == 8:
            self.goodbye = (struct.unpack(">H", payload[:2])[0], payload[2:].decode())
        if opcode == 1:
            self.texts.append(json.loads(payload))
        if opcode != 2:
            return
        kind, protocol, _ = struct.unpack_from("<BBH", payload)
        assert protocol == 1
        {MAP: self.take_map, POSE: self.take_pose, IMAGE: lambda body: self.images.append(body),
         LAYER: self.take_layer}[kind](payload[4:])

    def take_layer(self, body):
        """Stores the newest values of each layer: (map version, cell of odom -> known value)."""
        head = LAYER_HEAD.unpack_from(body)
        version, x, y, side, nx, ny, index, _ = head
        values = struct.unpack_from(f"<{nx * ny}f", body, LAYER_HEAD.size)
        assert LAYER_HEAD.size + 4 * nx * ny == len(body)
        self.layers.append(head)
        self.values[index] = (version, {(x // side + i % nx, y // side + i // nx): value
                                        for i, value in enumerate(values) if not math.isnan(value)})

    def take_pose(self, body):
        pose = POSE_HEAD.unpack_from(body)
        self.poses.append(pose)
        self.joints.append(struct.unpack_from(f"<{pose[-1]}f", body, POSE_HEAD.size))

    def take_map(self, body):
        (version, _, x, y, base, side, nx, ny, whole, _, edges, runs) = MAP_HEAD.unpack_from(body)
        self.map_bytes.append(len(body))
        origin = (x // side, y // side)
        if whole:
            self.wholes += 1
            self.ground = {}
        inside = {}
        for cell, what in self.ground.items():
            if origin[0] <= cell[0] < origin[0] + nx and origin[1] <= cell[1] < origin[1] + ny:
                inside[cell] = what
        self.ground, at = inside, MAP_HEAD.size + 24 * edges
        for _ in range(runs):
            first, count = struct.unpack_from("<II", body, at)
            at += 8
            for element, (height, sigma, state) in enumerate(struct.iter_unpack("<hBB", body[at:at + 4 * count]), first):
                cell = (origin[0] + element % nx, origin[1] + element // nx)
                if height == -32768 and state == 0:
                    self.ground.pop(cell, None)
                else:
                    self.ground[cell] = (height + base / 10, sigma, state)
            at += 4 * count
        assert at == len(body)
        self.versions[version] = dict(self.ground)

    def ask(self, **message):
        self.send(1, json.dumps(message).encode())

    def wait_for(self, kind, until=lambda said: True, seconds=30.0):
        """Waits until the newest message of a kind fulfils `until`, and returns it."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and self.goodbye is None:
            if self.told(kind) and until(self.told(kind)[-1]):
                return self.told(kind)[-1]
            self.listen(0.05)
        raise AssertionError(f"{kind}: {self.told(kind)[-1:]} after {seconds} s; goodbye: {self.goodbye}")

    def told(self, kind):
        return [text for text in self.texts if text["kind"] == kind]


class PageTest(CliTest):
    """Starts a service and opens pages. Each subclass chooses the scene."""

    @classmethod
    def serve(cls, *words, stderr=subprocess.DEVNULL):
        cls.service = subprocess.Popen([BINARY, "serve", *words, "--port", "0", "--page-port", "0", "--nice", "0"],
                                       stdout=subprocess.PIPE, stderr=stderr, text=True)
        cls.gate_port = int(cls.service.stdout.readline().rsplit(":", 1)[1])
        told = cls.service.stdout.readline()
        assert told.startswith("the page is at http://127.0.0.1:"), told
        cls.port = int(told.rstrip("/\n").rsplit(":", 1)[1])

    @classmethod
    def tearDownClass(cls):
        cls.service.kill()
        cls.service.wait()
        cls.service.stdout.close()

    def page(self):
        page = Page(self.port)
        self.addCleanup(page.close)
        return page


class PageOverTls(CliTest):
    """The page and its sockets with TLS; from this machine also without."""

    def test_a_real_client_sees_the_page_and_checks_its_certificate(self):
        certificate, key = self.dir / "certificate.pem", self.dir / "key.pem"
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days",
                        "2", "-subj", "/CN=surefoot test", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", key, "-out",
                        certificate], check=True, capture_output=True)
        key.chmod(0o600)
        service = subprocess.Popen([BINARY, "serve", *SCENE, "--port", "0", "--page-port", "0", "--nice", "0", "--certificate",
                                    certificate, "--key", key], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(service.stdout.close)
        self.addCleanup(service.wait)
        self.addCleanup(service.kill)
        self.assertTrue(service.stdout.readline().startswith("the gate listens on wss://127.0.0.1:"))
        told = service.stdout.readline()
        self.assertTrue(told.startswith("the page is at https://127.0.0.1:"), told)
        port = int(told.rstrip("/\n").rsplit(":", 1)[1])
        trusting = ssl.create_default_context(cafile=str(certificate))

        def title(connection):
            self.addCleanup(connection.close)
            connection.request("GET", "/")
            answer = connection.getresponse()
            self.assertEqual(answer.status, 200)
            self.assertIn("connect-src 'self' ws://127.0.0.1:* wss://127.0.0.1:*", answer.headers["Content-Security-Policy"])
            return gzip.decompress(answer.read())

        self.assertIn(b"<title>Surefoot", title(http.client.HTTPSConnection("127.0.0.1", port, timeout=10, context=trusting)))
        self.assertIn(b"<title>Surefoot", title(http.client.HTTPConnection("127.0.0.1", port, timeout=10)))
        with self.assertRaises(ssl.SSLCertVerificationError):
            http.client.HTTPSConnection("127.0.0.1", port, timeout=10, context=ssl.create_default_context()).request("GET", "/")
        secret = trusting.wrap_socket(socket.create_connection(("127.0.0.1", port), timeout=10), server_hostname="127.0.0.1")
        page = Page(port, connected=secret)
        self.addCleanup(page.close)
        page.wait_for("hello")
        for _ in range(200):  # a map is longer than a TLS record
            if page.ground:
                break
            page.listen(0.05)
        self.assertGreater(len(page.ground), 1000)


class LivePage(PageTest):
    @classmethod
    def setUpClass(cls):
        cls.serve(*SCENE)

    def get(self, path, method="GET"):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=5)
        self.addCleanup(connection.close)
        connection.putrequest(method, path, skip_accept_encoding=True)
        connection.endheaders()
        answer = connection.getresponse()
        return answer, answer.read()

    def test_files_come_packed_and_nothing_else_comes(self):
        for path in ("/", "/index.html"):
            answer, body = self.get(path)
            self.assertEqual((answer.status, answer.headers["Content-Encoding"]), (200, "gzip"))
            self.assertEqual(answer.headers["Content-Type"], "text/html; charset=utf-8")
            self.assertIn(b"<title>Surefoot", gzip.decompress(body))
        answer, body = self.get("/", "HEAD")
        self.assertEqual((answer.status, body), (200, b""))
        for path in ("/../etc/passwd", "/etc/passwd", "/index.html/", "/%2e%2e/x", "//", "/page", "/index.htm"):
            self.assertEqual(self.get(path)[0].status, 404, path)
        self.assertEqual(self.get("/", "POST")[0].status, 405)

    def test_what_the_machine_looks_like_is_a_file_too(self):
        hello = self.page().listen(1.0).told("hello")[0]
        self.assertEqual(hello["machine"]["model"], "/machine.urdf")
        answer, body = self.get(hello["machine"]["model"])
        self.assertEqual((answer.status, answer.headers["Content-Type"]), (200, "application/xml"))
        self.assertEqual(body, (ROOT / "models" / "rex.urdf").read_bytes())
        moving = re.findall(rb'<joint name="(\w+)" type="revolute">', body)
        self.assertEqual([joint["name"].encode() for joint in hello["machine"]["joints"]], moving)
        answer, body = self.get("/machine.urdf", "HEAD")
        self.assertEqual((answer.status, body), (200, b""))

    def test_who_rolls_has_no_joints(self):
        page = self.page()
        end = time.monotonic() + 20.0
        while not page.joints and time.monotonic() < end:
            page.listen(0.5)
        self.assertEqual(page.joints[-1], ())

    def first_line(self, path, host, *headers):
        """First line of the answer to a WebSocket request."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=5) as plain:
            plain.sendall("\r\n".join((f"GET {path} HTTP/1.1", f"Host: {host}", "Upgrade: websocket", "Connection: Upgrade",
                                       "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==", "Sec-WebSocket-Version: 13", *headers,
                                       "", "")).encode())
            return plain.recv(64).decode().split("\r\n")[0]

    def test_pages_of_other_sites_see_nothing(self):
        own = f"127.0.0.1:{self.port}"
        for origin, status in (("http://evil.example", "403"), ("http://127.0.0.1:1", "403"), (f"http://localhost:{self.port}", "101"),
                               (f"http://{own}", "101")):
            self.assertIn(status, self.first_line("/page", own, f"Origin: {origin}"), origin)

    def test_a_name_that_was_moved_to_this_machine_gets_nothing(self):
        """DNS rebinding: a foreign page asks this machine with the foreign host name."""
        evil = f"evil.example:{self.port}"
        for path in ("/page", "/"):
            self.assertIn("421", self.first_line(path, evil, f"Origin: http://{evil}", "Sec-WebSocket-Protocol: foxglove.sdk.v1"))
        for path in ("/", "/index.html", "/machine.urdf", "/nowhere"):
            connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=5)
            self.addCleanup(connection.close)
            connection.request("GET", path, headers={"Host": evil})
            self.assertEqual(connection.getresponse().status, 421, path)

    def test_every_answer_forbids_frames_foreign_scripts_and_guessed_types(self):
        for path, method, status in (("/", "GET", 200), ("/nowhere", "GET", 404), ("/machine.urdf", "GET", 200), ("/", "POST", 405)):
            answer, _ = self.get(path, method)
            self.assertEqual(answer.status, status)
            self.assertEqual(answer.headers["X-Content-Type-Options"], "nosniff", path)
            self.assertEqual(answer.headers["X-Frame-Options"], "DENY", path)
            self.assertIn("frame-ancestors 'none'", answer.headers["Content-Security-Policy"], path)
            self.assertIn("script-src 'self';", answer.headers["Content-Security-Policy"], path)

    def test_no_script_of_the_page_is_inline(self):
        """The content security policy would block such code."""
        _, body = self.get("/")
        page = gzip.decompress(body).decode()
        self.assertEqual(re.findall(r"<script(?![^>]*\ssrc=)", page), [])
        self.assertNotRegex(page, r"<[^>]*\s(on\w+|style)=")

    def test_a_crowd_of_half_open_requests_keeps_nobody_out(self):
        crowd = [socket.create_connection(("127.0.0.1", self.port), timeout=5) for _ in range(100)]
        for half in crowd:
            self.addCleanup(half.close)
            half.sendall(b"GET / HTTP/1.1\r\nHost: ")
        self.assertEqual(self.get("/nowhere")[0].status, 404)
        self.assertTrue(self.page().listen(1.0).told("hello"))

    def test_a_page_hears_who_is_there_and_how_it_goes(self):
        page = self.page().listen(1.5)
        end = time.monotonic() + 20.0
        while page.told("status")[-1]["state"] == "waiting" and time.monotonic() < end:
            page.listen(0.5)
        hello = page.told("hello")[0]
        self.assertEqual(page.texts[0], hello)
        self.assertEqual((hello["protocol"], hello["source_kind"], hello["gate_port"]), (1, "simulated", self.gate_port))
        self.assertEqual(hello["machine"]["name"], "rex")
        self.assertEqual(len(hello["machine"]["movements"]), 26)
        self.assertEqual(len(hello["blind_zone"]), 4)
        self.assertGreater(max(x for x, _ in hello["blind_zone"]), 0.3)
        states = page.told("status")
        self.assertGreaterEqual(len(states), 2)
        self.assertEqual(states[-1]["state"], "running")
        self.assertEqual([stage["name"] for stage in states[-1]["stages"]],
                         ["rectify", "odometry", "stereo", "ground", "fuse", "traversability", "stairs"])
        self.assertTrue(page.poses)

    def test_what_changes_is_the_whole_ground_in_the_end(self):
        first = self.page()
        first.want(map_hz=10)
        first.listen(1.0)
        second = self.page()
        second.want(map_hz=10)
        end = time.monotonic() + 20.0
        common = set()
        while len(common) < 3 and time.monotonic() < end:
            first.listen(0.2)
            second.listen(0.2)
            common = set(first.versions) & set(second.versions)
        self.assertGreaterEqual(len(common), 3)
        for version in common:
            self.assertEqual(first.versions[version], second.versions[version])
        self.assertGreater(len(first.ground), 1000)
        self.assertLess(sum(first.map_bytes) / len(first.map_bytes), 200e3, "2 MB/s at 10 maps a second")
        states = [state & 3 for _, _, state in first.ground.values()]
        self.assertGreater(states.count(1), 0.5 * len(states), "a level floor must be free")

    def test_layers_and_images_come_to_who_wants_them(self):
        page = self.page()
        page.want(layers=["elevation", "traversability"], images=["left", "disparity"], image_hz=5)
        end = time.monotonic() + 20.0
        while (len(page.layers) < 2 or not page.images) and time.monotonic() < end:
            page.listen(0.3)
        self.assertEqual({layer[6] for layer in page.layers}, {0, 2})
        self.assertTrue(page.images)
        plain = self.page().listen(1.0)
        self.assertEqual((plain.layers, plain.images), ([], []))

    def test_layers_are_those_of_the_map(self):
        """Heights of the layer message and of the map message at one map version."""
        page = self.page()
        page.want(map_hz=10, layers=["elevation", "variance"])
        compared, end = 0, time.monotonic() + 40.0
        while compared < 3 and time.monotonic() < end:
            page.values = {}
            while set(page.values) != {0, 1} and time.monotonic() < end:
                page.listen(0.1)
            version, heights_m = page.values[0]
            if page.values[1][0] != version or version not in page.versions or len(heights_m) < 1000:
                continue
            compared += 1
            self.assertEqual(heights_m.keys(), page.values[1][1].keys())
            self.assertTrue(all(1e-9 < variance_m2 < 0.1 for variance_m2 in page.values[1][1].values()))
            ground = page.versions[version]
            known = {cell for cell, (height_mm, _, _) in ground.items() if height_mm > -30000}
            self.assertGreater(len(known & heights_m.keys()), 0.95 * len(heights_m))
            for cell in known & heights_m.keys():
                self.assertLess(abs(1e3 * heights_m[cell] - ground[cell][0]), 0.7, cell)
        self.assertEqual(compared, 3)

    def test_who_sends_nonsense_is_told_and_let_go(self):
        for text, words in ((b"{", "JSON"), (b"[]", "object"), (b'{"op":"fly"}', "no operation 'fly'"),
                            (b'{"op":"want","layers":["gold"]}', "there is no layer 'gold'"), (b'{"op":"want","map_hz":"fast"}', "map_hz")):
            page = self.page()
            page.send(1, text)
            page.listen(3.0)
            self.assertEqual(page.goodbye[0], 1008, text)
            self.assertIn(words, page.goodbye[1])
        page = self.page()
        with self.assertRaises((ConnectionError, OSError, AssertionError, struct.error, TypeError)):
            page.send(1, b" " * 5000)  # the limit is 4096 bytes
            page.listen(3.0)
            self.assertIsNone(page.goodbye)
        self.assertTrue(self.page().listen(1.0).texts, "other pages must still receive messages")


class JoystickOnPages(PageTest):
    @classmethod
    def setUpClass(cls):
        cls.serve("sim:walk_floor", "--joystick", "--attest", "1", "--speed", "4", "--set", "sim.sensor=analytic")

    def hold(self, page, command, until, others=(), seconds=40.0):
        """Holds the joystick until `until(last steer message)`."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            page.send(1, json.dumps({"op": "joystick", "command": command}).encode())
            page.listen(0.3)
            for other in others:
                other.listen(0.05)
            if page.told("steer") and until(page.told("steer")[-1]):
                return page.told("steer")[-1]
        self.fail(f"still {page.told('steer')[-1:]} after {seconds} s")

    def test_one_page_steers_and_the_others_are_told(self):
        first, second = self.page().listen(1.0), self.page().listen(1.0)
        self.assertTrue(first.told("hello")[0]["can_steer"])
        self.assertEqual((first.told("steer")[0]["yours"], first.told("steer")[0]["taken"]), (False, False))
        gate = RosbridgeClient(self.gate_port)
        self.addCleanup(gate.close)
        gate.send(1, b'{"op":"subscribe","topic":"/surefoot/verdict","type":"surefoot/Verdict"}')
        # Until the gate is ready, each push ends with "cannot judge", and the joystick must be released before the next one.
        end = time.monotonic() + 60.0
        steered = {"moved": False}
        while not steered["moved"] and time.monotonic() < end:
            before = len(first.told("steer"))
            steered = self.hold(first, 9, lambda said: said["asked"] == 9 and len(first.told("steer")) > before, (second,))
            first.send(1, b'{"op":"joystick","command":0}')
            first.listen(0.6)
            steered = first.told("steer")[-1]
        self.assertEqual((steered["asked"], steered["moved"], steered["verdict"], steered["yours"]), (9, True, "OK", True))
        second.listen(0.5)
        self.assertEqual([second.told("steer")[-1][key] for key in ("yours", "taken", "asked", "moved")], [False, True, 9, True])
        # The page must show the gate's own answer.
        said = None
        while said is None or said["verdict"] != "OK":
            opcode, payload = gate.read()
            said = json.loads(payload)["msg"] if opcode == 1 and b"/surefoot/verdict" in payload else said
        self.assertEqual(said["command"], 9)
        self.assertTrue(all(len(joints) == len(first.told("hello")[0]["machine"]["joints"]) for joints in first.joints))
        # While the machine walks, the other page can neither stop nor steer it.
        second.send(1, b'{"op":"joystick","command":17}')
        end = time.monotonic() + 30.0
        while first.poses[-1][1] < 0.2 and time.monotonic() < end:
            first.listen(0.5)
        self.assertGreater(first.poses[-1][1], 0.2)
        names = [joint["name"] for joint in first.told("hello")[0]["machine"]["joints"]]
        for knee in ("left_upperleg_to_left_lowerleg", "right_upperleg_to_right_lowerleg"):
            angles = [joints[names.index(knee)] for joints in first.joints]
            self.assertGreater(max(angles) - min(angles), 0.2, knee)
        self.assertEqual([said["asked"] for said in second.listen(0.5).told("steer")][-1], 9)
        # When a page closes, another one may steer.
        first.close()
        second.listen(1.0)
        self.assertFalse(second.told("steer")[-1]["taken"])
        self.hold(second, 17, lambda said: said["yours"])

    def test_a_movement_that_is_none_moves_nothing(self):
        page = self.page()
        page.send(1, b'{"op":"joystick","command":300}')
        self.assertIn("0 to 255", page.listen(3.0).goodbye[1])
        page = self.page()
        page.send(1, b'{"op":"playback","paused":true}')
        self.assertIn("not a recording", page.listen(3.0).goodbye[1])


class Recordings(PageTest):
    FRAMES = 90

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        recording = cls.folder.name + "/floor"
        subprocess.run([BINARY, "sim", "floor", "--frames", str(cls.FRAMES), "--out", recording], check=True, capture_output=True)
        cls.serve(recording)

    @classmethod
    def tearDownClass(cls):
        super().tearDownClass()
        cls.folder.cleanup()

    def ask(self, page, until, seconds=20.0, **wish):
        if wish:
            page.send(1, json.dumps({"op": "playback", **wish}).encode())
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            page.listen(0.1)
            if page.told("status") and until(page.told("status")[-1]):
                return page.told("status")[-1]
        self.fail(page.told("status")[-1])

    def test_pause_jump_and_speed(self):
        page, other = self.page(), self.page()
        said = self.ask(page, lambda said: said["playback"]["frame"] > 40)
        self.assertEqual((said["playback"]["frames"], said["playback"]["speed"], said["state"]), (self.FRAMES, 1, "running"))
        self.ask(page, lambda said: said["state"] == "paused", paused=True)
        page.listen(0.5)
        stands, poses = page.poses[-1], len(page.poses)
        page.listen(1.0)
        self.assertEqual(len(page.poses), poses)
        self.ask(other, lambda said: said["playback"]["paused"])  # every page sees it
        # Jumps back and continues from there.
        self.ask(page, lambda said: said["state"] == "running" and 10 < said["playback"]["frame"] < 60, frame=10, paused=False)
        self.assertEqual(page.poses[poses], stands, "no other pose before the first new frame")
        self.assertLess(page.poses[poses + 1][0], stands[0] - 2e9)
        self.ask(page, lambda said: said["state"] == "ended" and said["playback"]["frame"] == self.FRAMES - 1, frame=75, speed=8)
        self.assertGreater(page.poses[-1][0], stands[0])
        # Jumps back from the end.
        self.ask(page, lambda said: said["state"] == "running" and 5 < said["playback"]["frame"] < 60, frame=5, speed=1)
        page.send(1, b'{"op":"joystick","command":9}')
        self.assertIn("cannot steer this source", page.listen(3.0).goodbye[1])


class OtherMachine(PageTest):
    """A machine without a 3D model."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        machine = cls.folder.name + "/other.yaml"
        text = (ROOT / "machines" / "rex.yaml").read_text().replace("name: rex\n", "name: other\n", 1)
        with open(machine, "w", encoding="utf-8") as file:
            file.write(text)
        cls.serve(*SCENE, "--machine", machine)

    @classmethod
    def tearDownClass(cls):
        super().tearDownClass()
        cls.folder.cleanup()

    def test_has_no_model_and_says_so(self):
        hello = self.page().listen(1.0).told("hello")[0]
        self.assertEqual((hello["machine"]["name"], hello["machine"]["model"], hello["machine"]["joints"]), ("other", None, []))
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=5)
        self.addCleanup(connection.close)
        connection.request("GET", "/machine.urdf")
        self.assertEqual(connection.getresponse().status, 404)


class LargeMap(PageTest):
    """A map of 2.6 million cells."""

    @classmethod
    def setUpClass(cls):
        cls.serve(*SCENE, "--set", "elevation.length_m=40")

    def test_all_of_its_layers_come_within_2_mb_a_second(self):
        page = self.page()
        page.want(map_hz=10, layers=["elevation", "variance", "traversability", "slope", "step", "roughness"])
        end = time.monotonic() + 60.0
        while (len(page.ground) < 1000 or {layer[6] for layer in page.layers} != set(range(6))) and time.monotonic() < end:
            page.listen(0.3)
        self.assertGreater(len(page.ground), 1000)
        self.assertEqual({layer[6] for layer in page.layers}, set(range(6)))
        maps, layers, poses, began = len(page.map_bytes), len(page.layers), len(page.poses), time.monotonic()
        page.listen(10.0)
        sizes = [4 * nx * ny for _, _, _, _, nx, ny, _, _ in page.layers[layers:]]
        self.assertGreaterEqual(len(sizes), 6)
        seconds = time.monotonic() - began
        print(f"40 m: {sum(page.map_bytes[maps:]) / seconds / 1e6:.2f} MB/s of ground, {sum(sizes) / seconds / 1e6:.2f} MB/s of {len(sizes)} layers")
        self.assertLess((sum(page.map_bytes[maps:]) + sum(sizes)) / seconds, 2e6)
        self.assertGreater(len(page.poses), poses)
        self.assertIsNone(page.goodbye)


class Ports(CliTest):
    def test_a_taken_port_is_said_and_the_next_one_is_used(self):
        with socket.socket() as other:
            other.bind(("127.0.0.1", 0))
            other.listen()
            port = other.getsockname()[1]
            process = self.run_ok("serve", *SCENE, "--max-frames", 1, "--once", "--port", 0, "--page-port", port)
        self.assertIn(f"port {port} is in use", process.stderr)
        self.assertRegex(process.stdout, r"the page is at http://127\.0\.0\.1:\d+/")
        self.assertNotIn(f"127.0.0.1:{port}/", process.stdout)

    def test_only_a_simulated_machine_is_steered_and_by_one(self):
        for words, said in (((*SCENE, "--joystick", "--no-page"), "needs the page"),
                            (("sim:walk_floor", "--joystick", "--walk", "9"), "not both")):
            process = subprocess.run([BINARY, "serve", *words, "--once", "--port", "0", "--page-port", "0"],
                                     capture_output=True, text=True, timeout=60)
            self.assertNotEqual(process.returncode, 0)
            self.assertIn(said, process.stderr)

    def test_without_a_page_nothing_is_said_of_one(self):
        process = self.run_ok("serve", *SCENE, "--max-frames", 1, "--once", "--port", 0, "--no-page")
        self.assertNotIn("the page", process.stdout + process.stderr)

    def test_beyond_this_machine_it_needs_tls_or_a_sentence(self):
        process = subprocess.run([BINARY, "serve", *SCENE, "--once", "--bind", "0.0.0.0", "--port", "0"],
                                 capture_output=True, text=True, timeout=60)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("--certificate", process.stderr)

    def test_the_page_may_be_reached_by_the_origins_that_are_named(self):
        service = subprocess.Popen([BINARY, "serve", *SCENE, "--port", "0", "--page-port", "0", "--nice", "0", "--origin",
                                    "https://robot.example"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(service.stdout.close)
        self.addCleanup(service.wait)
        self.addCleanup(service.kill)
        service.stdout.readline()
        port = int(service.stdout.readline().rstrip("/\n").rsplit(":", 1)[1])
        for host, status in (("robot.example", 200), ("other.example", 421)):
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
            self.addCleanup(connection.close)
            connection.request("GET", "/", headers={"Host": host})
            self.assertEqual(connection.getresponse().status, status, host)


if __name__ == "__main__":
    unittest.main()
