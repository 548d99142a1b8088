"""Roles, tokens, origins and TLS of the gate process. Clients: plain sockets and Python's TLS."""
import http.client
import json
import os
import re
import socket
import ssl
import stat
import subprocess
import unittest
import warnings

from surefoot_cli import BINARY, CliTest, surefoot
from websocket_client import RosbridgeClient

GATE = BINARY.parent / "surefoot-gate"
INSECURE = "I understand that everybody on this network can read and change what is sent"


def own_address():
    """An address of this machine other than loopback; None = it has no other. Sends no packet."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))
            return probe.getsockname()[0]
        except OSError:
            return None


class AccessTest(CliTest):
    def setUp(self):
        super().setUp()
        self.tokens = self.dir / "state" / "tokens"

    def start(self, *words, env=None):
        process = subprocess.Popen([GATE, "--snapshots", self.dir / "channel", "--port", "0", *map(str, words)],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env={**os.environ, "XDG_STATE_HOME": str(self.dir), **(env or {})})
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        self.said = process.stdout.readline()
        self.port = int(self.said.rsplit(":", 1)[1])
        return process

    def refused(self, *words):
        process = subprocess.run([GATE, "--snapshots", self.dir / "channel", "--port", "0", *map(str, words)],
                                 capture_output=True, text=True, timeout=60)
        self.assertNotEqual(process.returncode, 0)
        self.assertNotIn("listening", process.stdout)
        return process.stderr

    def token(self, role, path=None):
        return re.search(rf"^{role} (\S+)$", (path or self.tokens).read_text(), re.M)[1]

    def client(self, path="/"):
        client = RosbridgeClient(self.port, path=path)
        self.addCleanup(client.close)
        return client

    def get(self, target, headers=None, context=None):
        if context:
            connection = http.client.HTTPSConnection("127.0.0.1", self.port, timeout=10, context=context)
        else:
            connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=10)
        self.addCleanup(connection.close)
        connection.request("GET", target, headers=headers or {})
        response = connection.getresponse()
        return response.status, response.read().decode()


class Roles(AccessTest):
    def test_the_first_start_makes_tokens_shows_them_once_and_the_next_one_reads_them(self):
        gate = self.start("--token-file", self.tokens)
        self.assertEqual(stat.S_IMODE(self.tokens.stat().st_mode), 0o600)
        gate.terminate()
        gate.wait()
        shown = gate.stderr.read()
        for role in ("observer", "rider", "operator"):
            self.assertIn(self.token(role), shown)
        before = self.tokens.read_text()
        gate = self.start("--token-file", self.tokens)
        gate.terminate()
        gate.wait()
        said = gate.stderr.read()
        for role in ("observer", "rider", "operator"):
            self.assertNotIn(self.token(role), said)
        self.assertEqual(self.tokens.read_text(), before)

    def test_without_an_option_the_file_is_the_users_own(self):
        self.start()
        self.assertEqual(len(self.token("operator", self.dir / "surefoot" / "tokens")), 32)

    def test_rights_that_others_have_end_the_start(self):
        self.start("--token-file", self.tokens)
        self.tokens.chmod(0o644)
        self.assertIn("chmod 600", self.refused("--token-file", self.tokens))

    def test_a_guest_asks_but_attests_and_re_arms_nothing_and_all_is_in_the_log(self):
        audit = self.dir / "audit"
        gate = self.start("--token-file", self.tokens, "--audit", audit)
        guest = self.client()
        self.assertEqual(guest.step(9)["verdict"], "ERROR")  # no perception, but an answer
        for service, args in (("/surefoot/attest", {"radius_m": 0.00005}), ("/surefoot/rearm", {})):
            values = guest.call(service, **args)["values"]
            self.assertFalse(values["success"])
            self.assertIn("this needs the role operator, and this client is rider", values["message"])
        values = self.client(f"/?token={self.token('operator')}").call("/surefoot/attest", radius_m=0.00005)["values"]
        self.assertFalse(values["success"])
        self.assertNotIn("role", values["message"])
        self.assertEqual(self.get("/health", {"Authorization": "Bearer 0123456789abcdef"})[0], 401)
        gate.terminate()
        gate.wait()
        acts = json.loads(surefoot("audit", "acts", audit, "--json").stdout)["list"]
        told = [(act["role"], act["act"], act["outcome"]) for act in acts]
        self.assertEqual(told, [("rider", "attest", "no right"), ("rider", "re-arm", "no right"),
                                ("operator", "authenticate", "done"), ("operator", "attest", "failed"),
                                ("none", "authenticate", "no right")])
        self.assertIn("operator attest: failed", surefoot("audit", "acts", audit).stdout)
        self.assertIn("intact", self.run_ok("audit", "verify", audit).stdout)

    def test_guests_can_be_kept_out(self):
        self.start("--token-file", self.tokens, "--guests", "none")
        with self.assertRaises(ConnectionError):
            self.client()
        status, text = self.get("/health")
        self.assertEqual(status, 401)
        self.assertIn("a token is needed", text)
        self.assertEqual(self.client(f"/?token={self.token('rider')}").step(9)["verdict"], "ERROR")

    def test_a_page_from_a_file_is_told_the_option_that_lets_it_in(self):
        self.start("--token-file", self.tokens)
        status, text = self.get("/health", {"Origin": "null"})
        self.assertEqual(status, 403)
        self.assertIn("--origin 'null'", text)
        self.start("--token-file", self.tokens, "--origin", "null", "--origin", "file://")
        self.assertEqual(self.get("/health", {"Origin": "null"})[0], 200)
        self.assertEqual(self.get("/health", {"Origin": "file://"})[0], 200)


class Serve(AccessTest):
    def serve(self, *words):
        process = subprocess.Popen([BINARY, "serve", "sim:walk_floor", "--walk", "0", "--no-page", "--port", "0", "--set",
                                    "sim.sensor=analytic", "--set", "sim.rate_hz=5", "--speed", "1", "--token-file",
                                    self.tokens, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        self.said = process.stdout.readline()
        self.port = int(self.said.rsplit(":", 1)[1])
        return process

    def test_serve_passes_origins_guests_and_tokens_to_its_gate(self):
        process = self.serve("--origin", "null", "--guests", "observer")
        self.assertEqual(self.get("/health", {"Origin": "null"})[0], 200)
        self.assertEqual(self.get("/health", {"Origin": "http://192.0.2.7"})[0], 403)
        answer = self.client().call("/step", direction=9)
        self.assertFalse(answer["result"])
        self.assertIn("this client is observer", answer["values"])
        self.assertIn("verdict", self.client(f"/?token={self.token('rider')}").step(9))
        process.kill()
        process.wait()
        shown = process.stderr.read()
        self.assertEqual(shown.count(self.token("operator")), 1)

    def test_beyond_loopback_serve_asks_for_the_same_as_the_gate(self):
        process = surefoot("serve", "sim:walk_floor", "--no-page", "--once", "--bind", "0.0.0.0", "--port", 0, "--set",
                           "sim.sensor=analytic", timeout=60)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn("--certificate", process.stderr)


class Link(AccessTest):
    def test_a_rex_link_shows_the_riders_token(self):
        self.start("--token-file", self.tokens, "--guests", "none")
        script = self.dir / "script.txt"
        script.write_text("0.0 0\n0.1 9\n0.5 0\n")
        words = ("rex-link", "--url", f"ws://127.0.0.1:{self.port}", "--script", script, "--json")
        alone = surefoot(*words)
        self.assertNotEqual(alone.returncode, 0)
        shown = surefoot(*words, "--token-file", self.tokens)
        self.assertEqual(shown.returncode, 0, shown.stderr)
        self.assertIn("answer", shown.stdout)
        self.assertIn("cannot be read", surefoot(*words, "--token-file", self.dir / "none").stderr)


class Tls(AccessTest):
    def make_certificate(self):
        self.certificate, self.key = self.dir / "certificate.pem", self.dir / "key.pem"
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes",
                        "-days", "2", "-subj", "/CN=surefoot test", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout",
                        self.key, "-out", self.certificate], check=True, capture_output=True)
        self.key.chmod(0o600)
        return ("--certificate", self.certificate, "--key", self.key)

    def trusting(self):
        return ssl.create_default_context(cafile=str(self.certificate))

    def test_a_real_client_speaks_tls_and_checks_the_certificate(self):
        self.start("--token-file", self.tokens, *self.make_certificate())
        self.assertTrue(self.said.startswith("listening on wss://127.0.0.1:"), self.said)
        status, text = self.get("/health", context=self.trusting())
        self.assertEqual(status, 200)
        self.assertIn("state", json.loads(text))
        with self.assertRaises(ssl.SSLCertVerificationError):
            self.get("/health", context=ssl.create_default_context())
        old = self.trusting()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)
            old.minimum_version = old.maximum_version = ssl.TLSVersion.TLSv1_1
        with self.assertRaises((ssl.SSLError, OSError)):
            self.get("/health", context=old)

    def test_questions_and_roles_go_through_tls(self):
        self.start("--token-file", self.tokens, "--guests", "none", *self.make_certificate())
        plain = socket.create_connection(("127.0.0.1", self.port), timeout=10)
        secret = self.trusting().wrap_socket(plain, server_hostname="127.0.0.1")
        client = RosbridgeClient(self.port, path=f"/?token={self.token('operator')}", connected=secret)
        self.addCleanup(client.close)
        for _ in range(200):
            self.assertEqual(client.step(9)["verdict"], "ERROR")
        self.assertFalse(client.call("/surefoot/attest", radius_m=1.0)["values"]["success"])  # no map
        # Longer than a TLS record.
        client.send(1, json.dumps({"op": "x" * 60000}).encode())
        self.assertEqual(json.loads(client.read()[1])["op"], "status")

    def test_this_machine_may_speak_plainly_to_the_same_port_others_may_not(self):
        address = own_address()
        if address is None:
            print("skipped 1 check: this machine has only the loopback address", flush=True)
            self.skipTest("only the loopback address")
        self.start("--token-file", self.tokens, "--bind", "0.0.0.0", *self.make_certificate())
        token = self.token("rider")
        self.assertEqual(self.client(f"/?token={token}").step(9)["verdict"], "ERROR")
        with self.assertRaises(ConnectionError):
            self.client()  # on other interfaces guests are refused, also from this machine
        with socket.create_connection(("127.0.0.1", self.port), timeout=10) as nonsense:
            nonsense.sendall(b"\x16\x03\x01\x00\x05hello")  # begins like TLS
            self.assertNotIn(b"HTTP/1.1 101", nonsense.recv(4096))
        self.assertEqual(self.client(f"/?token={token}").step(9)["verdict"], "ERROR")

    def test_beyond_loopback_tokens_and_tls_are_needed_or_the_sentence(self):
        words = ("--token-file", self.tokens, "--bind", "0.0.0.0")
        self.assertIn("--certificate", self.refused(*words))
        self.assertIn(INSECURE, self.refused(*words))
        self.assertIn(INSECURE, self.refused(*words, "--insecure", "yes"))
        self.assertIn("--guests none", self.refused(*words, "--guests", "rider", *self.make_certificate()))
        self.start(*words, "--insecure", INSECURE)
        self.assertTrue(self.said.startswith("listening on ws://"))

    def test_files_that_cannot_be_used_are_named(self):
        words = self.make_certificate()
        self.key.chmod(0o644)
        self.assertIn(f"chmod 600 {self.key}", self.refused(*words))
        self.key.chmod(0o600)
        self.assertIn("both files", self.refused("--key", self.key))
        other = self.dir / "other.pem"
        other.write_text("nonsense")
        self.assertIn(str(other), self.refused("--certificate", other, "--key", self.key))
        other.chmod(0o600)
        self.assertIn(str(other), self.refused("--certificate", self.certificate, "--key", other))
        self.assertIn(str(self.dir / "none"), self.refused("--certificate", self.certificate, "--key", self.dir / "none"))
        old_key = self.key.read_text()
        self.make_certificate()
        other.write_text(old_key)
        self.assertIn(str(other), self.refused("--certificate", self.certificate, "--key", other))

    def test_half_handshakes_end_and_the_others_go_on(self):
        self.start("--token-file", self.tokens, *self.make_certificate())
        crowd = [socket.create_connection(("127.0.0.1", self.port), timeout=10) for _ in range(100)]
        self.addCleanup(lambda: [one.close() for one in crowd])
        for one in crowd[::2]:
            one.sendall(b"\x16\x03\x01\x02\x00\x01")
        self.assertEqual(self.get("/health", context=self.trusting())[0], 200)
        self.assertEqual(crowd[0].recv(1), b"")  # the server closed the oldest connection


if __name__ == "__main__":
    unittest.main()
