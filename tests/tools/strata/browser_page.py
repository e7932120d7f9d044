# SPDX-License-Identifier: Apache-2.0
"""A page in headless Chromium, for tests of what the live view shows."""
import base64
import contextlib
import json
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import urllib.request

from robot_process import comes_true, free_port, listens, started


def find_browser():
    """Exits with 77, with which a test is skipped, where there is none."""
    browser = shutil.which("chromium-headless-shell") or shutil.which("chromium")
    if browser is None:
        print("skipped: no Chromium is installed (Debian: chromium-headless-shell or chromium)")
        sys.exit(77)
    return browser


class Page:
    """A page in Chromium, asked by its debugging protocol."""

    def __init__(self, browser, url, folder, size="1280,800"):
        port = free_port()
        self.process = subprocess.Popen(
            [browser, "--headless", "--no-sandbox", "--disable-gpu", f"--window-size={size}",
             f"--user-data-dir={folder}/profile", f"--remote-debugging-port={port}", url],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        try:
            target = comes_true(lambda: self.target(port), "Chromium has opened the page")
        except SystemExit:
            self.close()
            raise
        path = re.sub(r"^ws://[^/]*", "", target["webSocketDebuggerUrl"])
        self.socket = socket.create_connection(("127.0.0.1", port))
        self.socket.sendall(
            f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
            f"Connection: Upgrade\r\nSec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}"
            "\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
        self.stream = self.socket.makefile("rb")
        while self.stream.readline().strip():
            pass
        self.calls = 0

    def close(self):
        """The browser and what it has started: Debian's is a script, which would leave it."""
        os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()

    @staticmethod
    def target(port):
        try:
            answer = urllib.request.urlopen(f"http://127.0.0.1:{port}/json", timeout=5)
            return next((one for one in json.load(answer) if one["type"] == "page"), None)
        except OSError:
            return None

    def call(self, method, **parameters):
        self.calls += 1
        text = json.dumps({"id": self.calls, "method": method, "params": parameters}).encode()
        size = (b"\xfe" + struct.pack(">H", len(text)) if len(text) < 1 << 16
                else b"\xff" + struct.pack(">Q", len(text)))
        self.socket.sendall(b"\x81" + size + bytes(4) + text)
        while True:
            size = self.stream.read(2)[1] & 127
            if size == 126:
                size = struct.unpack(">H", self.stream.read(2))[0]
            elif size == 127:
                size = struct.unpack(">Q", self.stream.read(8))[0]
            answer = json.loads(self.stream.read(size))
            if answer.get("id") == self.calls:
                return answer["result"]

    def evaluate(self, expression, wait=False):
        """Its value; wait: of a promise, what it comes to."""
        return self.call("Runtime.evaluate", expression=expression,
                         awaitPromise=wait)["result"].get("value")

    def drawn(self):
        """What its canvas shows: numbers of pixels by what they are of."""
        return json.loads(self.evaluate("document.body && document.body.dataset.probe") or "{}")

    def text(self, element):
        return self.evaluate(f"document.getElementById('{element}').textContent")

    def picture(self):
        """A PNG, in base64."""
        return self.call("Page.captureScreenshot")["data"]

    def shoot(self, path):
        with open(path, "wb") as out:
            out.write(base64.b64decode(self.picture()))


@contextlib.contextmanager
def viewed(browser, strata, composition, work, **ports):
    """The pages of a composition's live views, one a port; the process has to end with 0."""
    robot = started(strata, composition, work, **ports)
    pages = []
    try:
        for port in ports.values():
            comes_true(lambda: listens(port), "the live view listens")
            pages.append(Page(browser, f"http://localhost:{port}/", tempfile.mkdtemp(dir=work)))
        yield pages
    finally:
        robot.terminate()
        robot.wait()
        for page in pages:
            page.close()
    assert robot.returncode == 0, robot.returncode


# Draws with one layer and without it; where pixels differ: how many, and around what. Nothing comes
# in between: a script is not interrupted.
LAYER = """(() => {
  const show = (is) => { shown[LAYER] = is; draw();
    return pen.getImageData(0, 0, canvas.width, canvas.height).data; };
  const without = show(false), data = show(true), ratio = devicePixelRatio || 1;
  let count = 0, box = [Infinity, Infinity, -Infinity, -Infinity];
  for (let i = 0; i < data.length; i += 4) {
    if (data[i] === without[i] && data[i + 1] === without[i + 1] && data[i + 2] === without[i + 2]) continue;
    const x = (i / 4) % canvas.width / ratio, y = Math.floor(i / 4 / canvas.width) / ratio;
    ++count; box = [Math.min(box[0], x), Math.min(box[1], y), Math.max(box[2], x), Math.max(box[3], y)];
  }
  return JSON.stringify({ count, box });
})()"""


def layer(page, name):
    return json.loads(page.evaluate(LAYER.replace("LAYER", json.dumps(name))))


def screen(page, x, y):
    return json.loads(page.evaluate(f"JSON.stringify(toScreen({x}, {y}))"))


def mouse(page, kind, x, y):
    page.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)


def shows_a_robot(drawn):
    """Map, scan and pose; the scan with labels or without."""
    beams = drawn.get("plain", 0) + drawn.get("static", 0)
    return drawn.get("free", 0) > 2000 and drawn.get("wall", 0) > 20 and beams > 20 \
        and drawn.get("pose", 0) > 20
