# SPDX-License-Identifier: Apache-2.0
"""A viewer of the live view that reads every topic, for measurements."""
import json
import socket
import struct
import threading
import time


class Viewer:
    """Reads what the page reads, as fast as it comes."""

    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port))
        self.socket.sendall(
            b"GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            b"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n"
            b"Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n\r\n")
        self.stream = self.socket.makefile("rb")
        while self.stream.readline().strip():
            pass
        self.scans = 0
        self.gaps_s = []
        self.came_at = None
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        scan = None
        try:
            while True:
                kind, size = self.stream.read(2)
                if size == 126:
                    size = struct.unpack(">H", self.stream.read(2))[0]
                elif size == 127:
                    size = struct.unpack(">Q", self.stream.read(8))[0]
                data = self.stream.read(size)
                if kind & 15 == 9:  # a ping: who does not answer is sent away
                    self.socket.sendall(bytes([0x8a, 0x80 | len(data)]) + bytes(4) + data)
                elif kind & 15 == 1:
                    channels = json.loads(data).get("channels", [])
                    scan = next((one["id"] for one in channels if one["topic"] == "/scan"), scan)
                    self.subscribe([one["id"] for one in channels])
                elif kind & 15 == 2 and struct.unpack("<I", data[1:5])[0] == scan:
                    self.count()
        except (OSError, ValueError):
            pass

    def count(self):
        now = time.monotonic()
        if self.came_at is not None:
            self.gaps_s.append(now - self.came_at)
        self.came_at = now
        self.scans += 1

    def leave(self, vanish=False):
        """Closes the connection; to vanish is to reset it, as a process that dies."""
        if vanish:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        else:
            self.socket.shutdown(socket.SHUT_RDWR)
        self.socket.close()

    def subscribe(self, channels):
        if not channels:
            return
        text = json.dumps({"op": "subscribe", "subscriptions": [
            {"id": one, "channelId": one} for one in channels]}).encode()
        self.socket.sendall(bytes([0x81, 0xfe]) + struct.pack(">H", len(text)) + bytes(4) + text)
