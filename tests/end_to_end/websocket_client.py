"""A rosbridge client with one connection: the needed parts of RFC 6455, with the standard library only."""
import base64
import json
import os
import socket
import struct


class RosbridgeClient:
    def __init__(self, port, timeout_s=5.0, path="/", connected=None):
        """`connected`: an already connected socket, for example of TLS."""
        self.socket = connected or socket.create_connection(("127.0.0.1", port), timeout=timeout_s)
        self.stream = self.socket.makefile("rb")
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                            f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
        if b"101" not in self.stream.readline():
            self.close()
            raise ConnectionError("the service did not take the connection")
        while self.stream.readline().strip():
            pass
        self.asked = 0

    def close(self):
        self.stream.close()
        self.socket.close()

    def send(self, opcode, payload):
        mask = os.urandom(4)
        length = bytes([128 | len(payload)]) if len(payload) < 126 else b"\xfe" + struct.pack(">H", len(payload))
        self.socket.sendall(bytes([128 | opcode]) + length + mask +
                            bytes(byte ^ mask[i % 4] for i, byte in enumerate(payload)))

    def read(self):
        head = self.stream.read(2)
        if len(head) < 2:
            raise ConnectionError("the service closed the connection")
        length = head[1] & 127
        if length >= 126:
            length = struct.unpack(*((">H", self.stream.read(2)) if length == 126 else (">Q", self.stream.read(8))))[0]
        return head[0] & 15, self.stream.read(length)

    def call(self, service, **args):
        """Calls a service and returns the whole answer."""
        self.asked += 1
        name = f"call:{self.asked}"
        self.send(1, json.dumps({"op": "call_service", "id": name, "service": service, "args": args}).encode())
        while True:
            opcode, payload = self.read()
            if opcode == 9:
                self.send(10, payload)
            if opcode == 8:
                raise ConnectionError("the service said goodbye")
            if opcode == 1:
                message = json.loads(payload)
                if message.get("id") == name:
                    return message

    def step(self, direction):
        return self.call("/surefoot/step", direction=direction)["values"]
