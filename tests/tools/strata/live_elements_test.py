#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the live page draws and does, element by element, in headless Chromium.

usage: live_elements_test.py STRATA HALL.yaml WORK

Exits with 77 when no Chromium is installed (Debian: chromium-headless-shell or chromium).
"""
import json
import math
import struct
import subprocess
import sys
import tempfile
import urllib.request

from browser_page import Page, find_browser
from robot_process import comes_true, free_port, listens, simulated, started

COMPOSITION = """version: 1
transport: loopback
processes:
  - name: robot
    executor: multi_threaded
    components:
      - {{type: strata::Player, name: player, parameters: {{log: {work}/world/log.clf, rate: 20.0}}}}
      - type: strata::Localizer
        name: localizer
        parameters: {{maps: {work}/maps, model: patch, start: {{pose: [0, 0, 0]}}}}
      - {{type: strata::LiveView, name: live_view, parameters: {{port: {port}}}}}
"""
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


def sample(port, head):
    with urllib.request.urlopen(f"http://localhost:{port}/metrics") as answer:
        for line in answer.read().decode().splitlines():
            if line.startswith(head + " "):
                return float(line.split()[-1])
    return 0.0


def test_drawing(page):
    comes_true(lambda: page.evaluate("robot.map !== null && robot.scan !== null && "
                                     "robot.particles !== null && robot.health !== null"),
               "map, scan, particles and health have come")
    comes_true(lambda: page.text("verdict") == "Localized", "the verdict")
    assert page.text("reason"), "the model, or what is doubted"
    assert int(page.text("count")) > 0, page.text("count")
    assert page.text("latency").endswith(" ms"), page.text("latency")
    assert 0.0 <= float(page.text("score")) <= 1.0, page.text("score")
    assert layer(page, "map")["count"] > 10_000
    comes_true(lambda: layer(page, "plain")["count"] > 100, "the scan")
    comes_true(lambda: layer(page, "particles")["count"] > 3, "the particles")
    # An ellipse of two standard deviations: here 1 m along x and 2 m along y.
    drawn = json.loads(page.evaluate(
        "robot.pose.covariance = [0.25, 0, 1.0, 0.01];" + LAYER.replace("LAYER", '"pose"').replace(
            "JSON.stringify({ count, box })",
            "JSON.stringify({ count, box, scale: view.scale, at: toScreen(robot.pose.x, robot.pose.y) })")))
    left, top, right, bottom = drawn["box"]
    for found, wanted in ((drawn["at"][0] - left, 1.0), (right - drawn["at"][0], 1.0),
                          (drawn["at"][1] - top, 2.0), (bottom - drawn["at"][1], 2.0)):
        assert abs(found - wanted * drawn["scale"]) < 3.0, drawn


def test_silence_of_a_layer(page):
    """A box that is unticked takes its layer away, and ticked gives it back."""
    boxes = "document.querySelectorAll('#layers input')"
    page.evaluate(f"{boxes}[0].click()")
    assert page.evaluate("shown.map") is False
    page.evaluate(f"{boxes}[0].click()")
    assert page.evaluate("shown.map") is True


def test_setting_a_pose(page, port):
    page.evaluate("window.sent = []; const send = socket.send.bind(socket);"
                  "socket.send = (data) => { window.sent.push(data); send(data); };"
                  "setFollow(false); view.isChosen = true")
    page.evaluate("document.getElementById('place').click()")
    assert page.text("hint").startswith("Press where the robot is"), page.text("hint")
    at = json.loads(page.evaluate("JSON.stringify([robot.pose.x, robot.pose.y])"))
    x, y = screen(page, *at)
    mouse(page, "mousePressed", x, y)
    mouse(page, "mouseMoved", x, y - 80)  # up: the robot looks along the map's y
    mouse(page, "mouseReleased", x, y - 80)
    sent = comes_true(lambda: page.evaluate(
        "window.sent.length ? Array.from(new Uint8Array(window.sent[0].buffer || window.sent[0]))"
        ".map((b) => b.toString(16).padStart(2, '0')).join('') : ''"), "a pose is sent")
    data = bytes.fromhex(sent)
    assert data[:5] == b"\1\1\0\0\0", data[:5]
    cdr = data[9:]  # behind opcode, channel and the CDR header
    assert cdr[8:16] == struct.pack("<I", 4) + b"map\0", cdr[:20]
    px, py, _, _, _, qz, qw = struct.unpack_from("<7d", cdr, 16)
    assert math.hypot(px - at[0], py - at[1]) < 0.1, (px, py, at)
    assert abs(2 * math.atan2(qz, qw) - math.pi / 2) < 0.05, (qz, qw)
    received = 'strata_topic_received_messages_total{component="/localizer",topic="/initialpose"}'
    comes_true(lambda: sample(port, received) == 1, "the localizer is told")


def test_relocalizing(page, port):
    requests = 'strata_component_requests_total{component="/localizer"}'
    before = sample(port, requests)
    page.evaluate("document.getElementById('relocalize').click()")
    comes_true(lambda: page.text("hint").startswith("Searching everywhere"), "the page says so")
    comes_true(lambda: sample(port, requests) == before + 1, "the localizer is asked")


def test_areas(strata, browser, work):
    port = free_port()
    viewing = subprocess.Popen([strata, "view", f"{work}/maps", "--port", str(port), "--quiet"])
    page = None
    try:
        comes_true(lambda: listens(port), "the live view listens")
        page = Page(browser, f"http://localhost:{port}/", tempfile.mkdtemp(dir=work))
        comes_true(lambda: page.evaluate("robot.patches !== null && robot.map !== null"), "areas")
        assert layer(page, "areas")["count"] > 100
        area = json.loads(page.evaluate("JSON.stringify((() => { const a = robot.patches.submaps[0];"
                                        "const r = areaRect(a); return { id: a.id, x: r.x + r.w / 2,"
                                        "y: r.y + r.h / 2, configurations: a.configurations.length };"
                                        "})())"))
        # Its colour says how sure its likeliest configuration is.
        tones = [page.evaluate(
            f"robot.states.set({area['id']}, {json.dumps(belief)}); draw(); "
            f"(() => {{ const [x, y] = toScreen({area['x']}, {area['y']}); return "
            "Array.from(pen.getImageData(x, y, 1, 1).data).join(); })()")
            for belief in ([0.5, 0.5], [1.0, 0.0])]
        assert tones[0] != tones[1], tones
        page.evaluate(f"robot.states.delete({area['id']}); draw()")
        x, y = screen(page, area["x"], area["y"])
        mouse(page, "mousePressed", x, y)
        mouse(page, "mouseReleased", x, y)
        comes_true(lambda: page.evaluate("document.getElementById('area').hidden") is False,
                   "a click opens the area's card")
        text = page.text("area")
        assert text.startswith(f"Area {area['id']}"), text
        assert text.count("Configuration ") == area["configurations"], text
        assert "seen" in text, text
    finally:
        viewing.kill()
        if page is not None:
            page.close()


def main():
    strata, hall, work = sys.argv[1:4]
    browser = find_browser()
    subprocess.run([strata, "learn", simulated(strata, hall, work), "--out", f"{work}/maps", "--quiet"],
                   check=True)
    test_areas(strata, browser, work)
    port = free_port()
    robot = started(strata, COMPOSITION, work, port=port)
    page = None
    try:
        comes_true(lambda: listens(port), "the live view listens")
        page = Page(browser, f"http://localhost:{port}/", tempfile.mkdtemp(dir=work))
        test_drawing(page)
        test_silence_of_a_layer(page)
        test_setting_a_pose(page, port)
        test_relocalizing(page, port)
    finally:
        robot.terminate()
        robot.wait()
        if page is not None:
            page.close()
    assert robot.returncode == 0, robot.returncode


main()
