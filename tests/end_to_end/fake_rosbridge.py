"""A rosbridge server for one client and one service, with the parts of RFC 6455 and of the protocol that these need."""
import base64
import hashlib
import json
import socket
import struct
import threading


class FakeRosbridge:
    """Answers /surefoot/step on loopback with the result of `verdict_of(command)`: OK, NOT_TRAVERSABLE or ERROR."""

    def __init__(self, verdict_of):
        self.verdict_of = verdict_of
        self.questions = []
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()

    def close(self):
        """Stops the server. A second call has no effect."""
        try:
            self.listener.shutdown(socket.SHUT_RDWR)  # close() alone leaves the port with the waiting accept()
        except OSError:
            pass
        self.listener.close()

    def serve(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            with client:
                try:
                    self.serve_client(client, client.makefile("rb"))
                except (ConnectionError, EOFError):
                    pass

    def serve_client(self, client, stream):
        key = None
        while (line := stream.readline().strip()):
            name, _, value = line.partition(b":")
            if name.lower() == b"sec-websocket-key":
                key = value.strip()
        accept = base64.b64encode(hashlib.sha1(key + b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11").digest())
        client.sendall(b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                       b"Sec-WebSocket-Accept: " + accept + b"\r\n\r\n")
        while True:
            opcode, payload = self.read_frame(stream)
            if opcode == 8:
                return
            if opcode == 9:
                self.write_frame(client, 10, payload)
            if opcode == 1:
                self.write_frame(client, 1, json.dumps(self.answer(json.loads(payload))).encode())

    @staticmethod
    def read_frame(stream):
        head = stream.read(2)
        if len(head) < 2:
            raise EOFError
        length = head[1] & 127
        if length == 126:
            length = struct.unpack(">H", stream.read(2))[0]
        mask = stream.read(4)
        return head[0] & 15, bytes(byte ^ mask[i % 4] for i, byte in enumerate(stream.read(length)))

    @staticmethod
    def write_frame(client, opcode, payload):
        length = bytes([len(payload)]) if len(payload) < 126 else b"\x7e" + struct.pack(">H", len(payload))
        client.sendall(bytes([128 | opcode]) + length + payload)

    def answer(self, question):
        command, sequence = question["args"]["direction"], question["args"]["sequence"]
        self.questions.append((sequence, command))
        verdict = self.verdict_of(command)
        return {"op": "service_response", "id": question["id"], "service": question["service"], "result": True,
                "values": {"verdict": verdict, "result_code": {"OK": 0, "NOT_TRAVERSABLE": 1, "ERROR": -1}[verdict],
                           "reasons": [] if verdict == "OK" else ["DROP_OFF"], "primary": "NONE", "text": "so it is",
                           "command": command, "sequence": sequence, "connection": 4, "map_version": 1,
                           "config_hash": "00", "valid_for_ms": 300}}
