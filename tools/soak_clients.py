"""The clients of tools/soak: a well-behaved one with timed queries, an operator, ordinary and misbehaving ones.

Usage: soak_clients.py witness|crowd FOLDER SEED. FOLDER/port contains the present port of the gate. Both run until
they are terminated, and write their results into FOLDER.
"""
import json
import os
import pathlib
import random
import socket
import struct
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "end_to_end"))
from websocket_client import RosbridgeClient  # noqa: E402

FORWARD = 9
WITNESS_PERIOD_S = 0.1
ANSWER_TIMEOUT_S = 1.0
GONE = (OSError, ConnectionError, ValueError, KeyError, struct.error)


def port_of(folder):
    try:
        return int((folder / "port").read_text())
    except (OSError, ValueError):
        return 0


def path_of(folder, role):
    """Path of the socket with the token of a role; a guest has no token."""
    if role is None:
        return "/"
    lines = (folder / "tokens").read_text().splitlines()
    return "/?token=" + next(line.split()[1] for line in lines if line.startswith(f"{role} "))


def connect(folder, timeout_s, role=None):
    """Connects to the present gate; waits until one exists."""
    while True:
        try:
            return RosbridgeClient(port_of(folder), timeout_s, path_of(folder, role))
        except GONE:
            time.sleep(0.05)


def witness(folder, seed):
    """Asks ten times a second. Writes a line per question: sent, received (0 = never) [steady ns], verdict, first reason,
    decided, valid until [steady ns of the gate], port."""
    commands = random.Random(seed)
    with open(folder / "queries.csv", "a", buffering=1) as log:
        while True:
            port = port_of(folder)
            client = connect(folder, ANSWER_TIMEOUT_S, "rider")
            next_s = time.monotonic()
            while True:
                sent_ns = time.monotonic_ns()
                try:
                    values = client.step(commands.choice((FORWARD, FORWARD, 17, 25)))
                except GONE as error:
                    kind = "TIMEOUT" if isinstance(error, TimeoutError) else "LOST"
                    log.write(f"{sent_ns},{time.monotonic_ns()},{kind},{type(error).__name__},0,0,{port}\n")
                    client.close()
                    break
                received_ns = time.monotonic_ns()
                log.write(f"{sent_ns},{received_ns},{values['verdict']},{values['primary']},{values['decided_ns']},"
                          f"{values['valid_until_ns']},{port}\n")
                next_s = max(next_s + WITNESS_PERIOD_S, time.monotonic())
                time.sleep(max(0.0, next_s - time.monotonic()))


class Crowd:
    """Runs all other clients, one thread each, and counts their actions."""

    def __init__(self, folder, seed):
        self.folder = folder
        self.seed = seed
        self.counts = {}
        self.lock = threading.Lock()

    def note(self, what, times=1):
        with self.lock:
            self.counts[what] = self.counts.get(what, 0) + times

    def operator(self):
        """Re-arms after a fault, and attests the ground again after a restart of the gate."""
        while True:
            client = connect(self.folder, 5.0, "operator")
            try:
                while True:
                    time.sleep(1.0)
                    health = client.call("/surefoot/health")["values"]
                    if health["state"] == "FAULT" and client.call("/surefoot/rearm")["values"]["success"]:
                        self.note("rearmed")
                    if health["state"] == "READY" and not health["attesting"]:
                        if client.call("/surefoot/attest", radius_m=1.0)["values"]["success"]:
                            self.note("attested")
            except GONE:
                client.close()

    def ordinary(self, number):
        """An ordinary client: asks twice a second and listens to the topics."""
        while True:
            client = connect(self.folder, 5.0)
            try:
                for topic in ("/surefoot/verdict", "/surefoot/health", "/diagnostics")[:1 + number % 3]:
                    client.send(1, json.dumps({"op": "subscribe", "topic": topic, "throttle_rate": 200}).encode())
                while True:
                    time.sleep(0.5)
                    client.step((FORWARD, 17, 25)[number % 3])
                    self.note("ordinary questions")
            except GONE:
                client.close()

    def rude(self):
        """A misbehaving client: one kind of misbehaviour after the other, some seconds apart."""
        manners = random.Random(f"rude {self.seed}")
        deeds = (self.nonsense, self.half_a_frame, self.flood, self.sleeper, self.vanish, self.no_websocket, self.huge)
        while True:
            time.sleep(manners.uniform(1.0, 6.0))
            deed = manners.choice(deeds)
            try:
                deed(manners)
                self.note(deed.__name__)
            except GONE:
                self.note(deed.__name__)  # the gate is expected to disconnect it

    def client(self):
        return RosbridgeClient(port_of(self.folder), 5.0)

    def nonsense(self, manners):
        client = self.client()
        texts = ('{"op":', "[]", "null", '{"op":"call_service","service":"/step","args":{"direction":"9"}}', "\0\1\2",
                 '{"op":"fly"}', "[" * 40, '{"op":"publish","topic":"/move_base_simple/goal","msg":{"pose":1e999}}')
        for _ in range(manners.randrange(1, 60)):
            client.send(1, manners.choice(texts).encode())
        time.sleep(0.2)
        client.close()

    def half_a_frame(self, manners):
        client = self.client()
        client.socket.sendall(bytes([129, 0xfe]) + struct.pack(">H", 900) + b"mask" + b"x" * manners.randrange(0, 800))
        time.sleep(manners.uniform(0.1, 4.0))
        client.close()

    def flood(self, manners):
        client = self.client()
        question = json.dumps({"op": "call_service", "service": "/step", "args": {"direction": FORWARD}}).encode()
        for _ in range(manners.randrange(300, 1500)):
            client.send(1, question)
        client.close()

    def sleeper(self, manners):
        """Subscribes to everything and reads nothing."""
        client = self.client()
        client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        for topic in ("/surefoot/verdict", "/surefoot/health", "/diagnostics"):
            client.send(1, json.dumps({"op": "subscribe", "topic": topic}).encode())
        for _ in range(150):
            client.send(1, b'{"op":"call_service","service":"/rosapi/topics"}')
        time.sleep(manners.uniform(1.0, 15.0))
        client.close()

    def vanish(self, manners):
        """Ends a conversation with a TCP reset."""
        client = self.client()
        client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        for _ in range(manners.randrange(1, 20)):
            client.send(1, b'{"op":"call_service","service":"/surefoot/step","args":{"direction":9}}')
        client.close()

    def no_websocket(self, manners):
        with socket.create_connection(("127.0.0.1", port_of(self.folder)), 5.0) as plain:
            plain.sendall(manners.choice((b"GET /health HTTP/1.1\r\nHost: x\r\n\r\n", b"\x16\x03\x01" + bytes(60),
                                          b"GET / HTTP/1.1\r\nX: " + b"y" * 20000, b"G")))
            plain.settimeout(3.0)
            plain.recv(4096)

    def huge(self, manners):
        """Announces a message of ten megabytes and sends its beginning."""
        client = self.client()
        client.socket.sendall(bytes([129, 0xff]) + struct.pack(">Q", 10 << 20) + b"mask" + bytes(manners.randrange(1, 99999)))
        time.sleep(0.5)
        client.close()

    def storms(self):
        """Opens as many connections as FOLDER/storm says."""
        order = self.folder / "storm"
        while True:
            time.sleep(0.1)
            try:
                number = int(order.read_text())
                order.unlink()
            except (OSError, ValueError):
                continue
            self.storm(number)
            self.note("storms")

    def storm(self, number):
        guests = []
        for i in range(number):
            try:
                if i % 3 == 0:
                    guests.append(socket.create_connection(("127.0.0.1", port_of(self.folder)), 1.0))
                else:
                    guests.append(RosbridgeClient(port_of(self.folder), 1.0))
                    guests[-1].send(1, b'{"op":"call_service","service":"/step","args":{"direction":9}}')
                self.note("guests")
            except GONE:
                self.note("guests turned away")
        time.sleep(2.0)
        for guest in guests:
            guest.close()

    def run(self):
        threads = [threading.Thread(target=self.ordinary, args=(i,), daemon=True) for i in range(6)]
        threads += [threading.Thread(target=work, daemon=True) for work in (self.operator, self.rude, self.storms)]
        for thread in threads:
            thread.start()
        while True:
            time.sleep(5.0)
            with self.lock:
                text = json.dumps(self.counts)
            (self.folder / "crowd.tmp").write_text(text)
            os.replace(self.folder / "crowd.tmp", self.folder / "crowd.json")


if __name__ == "__main__":
    mode, where, its_seed = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
    if mode == "witness":
        witness(where, its_seed)
    else:
        Crowd(where, its_seed).run()
