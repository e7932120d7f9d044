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

from browser_page import LAYER, Page, find_browser, layer, mouse, screen, viewed
from robot_process import ONE_PROCESS, comes_true, free_port, listens, simulated

COMPOSITION = ONE_PROCESS + """\
      - {{type: strata::Player, name: player, parameters: {{log: {work}/world/log.clf, rate: 20.0}}}}
      - type: strata::Localizer
        name: localizer
        parameters: {{maps: {work}/maps, model: patch, start: {{pose: [0, 0, 0]}}}}
      - {{type: strata::LiveView, name: live_view, parameters: {{port: {port}}}}}
"""


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


SHADES = """(() => { const map = robot.map, before = { ...shown };
  for (const key of Object.keys(shown)) shown[key] = key === 'map';
  const found = {};
  for (const topic of ['/map_current', '/map_filtered']) {
    robot.map = { ...map, topic, width: 6, height: 1, resolution: 1, origin: { x: 0, y: 0, theta: 0 },
      data: Int8Array.of(-1, 5, 30, 50, 91, 100), image: null };
    draw();
    found[topic] = [0, 1, 2, 3, 4, 5].map((x) => {
      const [px, py] = toScreen(x + 0.5, 0.5).map((at) => Math.round(at * (devicePixelRatio || 1)));
      return [...pen.getImageData(px, py, 1, 1).data].slice(0, 3); });
  }
  robot.map = map; Object.assign(shown, before); draw();
  return JSON.stringify({ found, tones: Object.fromEntries(['ground', 'free', 'doubt', 'wall'].map((t) => [t, rgb(colors[t])])) });
})()"""


def test_shades(page):
    """Walls are dark and the free is light; what may or may not be there now has a colour of its own."""
    page.evaluate("setFollow(false); fitMap()")
    drawn = json.loads(page.evaluate(SHADES))
    tones, now, other = drawn["tones"], drawn["found"]["/map_current"], drawn["found"]["/map_filtered"]
    for shades in (now, other):
        assert shades[0] == tones["ground"] and shades[1] == tones["free"], shades
        assert shades[4] == shades[5] == tones["wall"], shades
        assert len({tuple(shade) for shade in shades[1:5]}) == 4, shades
    assert now[3] == tones["doubt"], (now, tones)
    assert max(other[3]) - min(other[3]) < 30, "grey"


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


TOPOLOGIES = """robot.topologies = { visits: [], topologies: [{ probability: 0.8, labels: [0, 1, 2, 0, 1],
  landmarks: [[1, 1], [3, 1], [3, 2.5]].map(([x, y]) => ({ mean: { x, y, theta: 0 } })) }] }"""
# Two nodes of which the level that forgets fastest sees a wall at 1 m, the other one at 2 m.
NODES = """takers['strata_msgs/msg/NodeMap']({ radius: 8, nodes: [[1, 1], [3, 1]].map(([x, y], id) => ({ id,
  pose: { x, y, theta: 0 }, levels: [[2, 2592000, 'long'], [1, 600, 'short']].map(([r, half_life_s, name]) =>
    ({ name, half_life_s, ranges: new Float32Array(360).map((_, i) => i < 90 ? r : i < 180 ? NaN : Infinity) })) })) })"""


def test_topology(page):
    """Places that were told apart, and the ways between them."""
    assert layer(page, "topology")["count"] == 0
    page.evaluate(TOPOLOGIES)

    def is_in_place():
        """The view may glide after the robot from one drawing to the next: then once more."""
        corners = screen(page, 1, 2.5) + screen(page, 3, 1)
        return all(abs(drawn - wanted) < 16
                   for drawn, wanted in zip(layer(page, "topology")["box"], corners))

    comes_true(is_in_place, "the places are drawn where they are")
    ways = json.loads(page.evaluate("JSON.stringify(graph().ways)"))
    assert ways == [{"ends": [0, 1], "times": 2}, {"ends": [1, 2], "times": 1},
                    {"ends": [0, 2], "times": 1}], ways
    # The way that was driven twice is the wider one.
    widths = []
    for middle in ((2, 1), (3, 1.75)):
        x, y = screen(page, *middle)
        across = f"{x}, {y} - 12, 1, 24" if middle[1] == 1 else f"{x} - 12, {y}, 24, 1"
        count = ("(() => {{ const with_ = pen.getImageData({0}).data; shown.topology = false; draw();"
                 "const without = pen.getImageData({0}).data; shown.topology = true; draw();"
                 "let n = 0; for (let i = 0; i < with_.length; i += 4) n += with_[i] !== without[i] ||"
                 " with_[i + 1] !== without[i + 1] || with_[i + 2] !== without[i + 2]; return n; }})()")
        widths.append(page.evaluate(count.format(across)))
    assert widths[0] > widths[1] > 0, widths
    page.evaluate("robot.topologies = null")


def test_memory(page):
    """Levels of the timescale memory, from what is there lately to what usually is."""
    page.evaluate(NODES)
    assert page.evaluate("document.getElementById('age').hidden") is True, "it is off at first"
    page.evaluate("document.querySelectorAll('#layers input')[Object.keys(layers).indexOf('memory')]"
                  ".click()")
    assert page.evaluate("document.getElementById('age').hidden") is False
    boxes = []
    for level, words in ((0, "As in the last 10 minutes (short)"), (1, "As in the last 4 weeks (long)")):
        page.evaluate(f"$('level').value = {level}; $('level').dispatchEvent(new Event('input'))")
        assert page.text("levelname") == words, page.text("levelname")
        found = layer(page, "memory")
        assert found["count"] > 50, found
        boxes.append(found["box"])
    scale = page.evaluate("view.scale")
    for box, reach in zip(boxes, (1.0, 2.0)):
        right, top = screen(page, 3 + reach, 1 + reach)
        assert abs(box[2] - right) < 4 and abs(box[1] - top) < 4, (box, right, top, scale)
    page.evaluate("robot.nodes = null; shown.memory = false; tellLevel()")


def test_version(page, work):
    """Which maps those are, as everything else that tells of them says."""
    version = comes_true(lambda: (page.text("version") or "-") != "-" and page.text("version"),
                         "the version of the map")
    assert len(version) == 12 and int(version, 16) >= 0, version
    with urllib.request.urlopen(f"http://localhost:{page.evaluate('location.port')}/metrics") as answer:
        info = next(line for line in answer.read().decode().splitlines()
                    if line.startswith("strata_localization_map_info{"))
    assert f'sha256="{version}' in info and f'maps="{work}/maps"' in info, (version, info)


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


# Buttons and cards that leave the screen, words that leave their button, and cards that lie on another.
MISPLACED = """(() => {
  const seen = (one) => one.offsetParent !== null || getComputedStyle(one).position === 'fixed' && one.offsetWidth > 0;
  const box = (one) => one.getBoundingClientRect();
  const cards = [...document.querySelectorAll('.card')].filter(seen);
  const wrong = [...cards, ...document.querySelectorAll('#tools button')].filter((one) => seen(one) &&
    (box(one).left < 0 || box(one).top < 0 || box(one).right > innerWidth || box(one).bottom > innerHeight ||
     one.scrollWidth > one.clientWidth + 1)).map((one) => one.id);
  const stay = cards.filter((one) => one.id !== 'hint');  // which goes by itself
  for (const a of stay) for (const b of stay) if (a !== b && box(a).left < box(b).right && box(b).left < box(a).right
    && box(a).top < box(b).bottom && box(b).top < box(a).bottom) wrong.push(a.id + ' on ' + b.id);
  return wrong.join(); })()"""


def test_small_screens(page):
    """A phone, a tablet upright and lying: all that a large screen has is within reach."""
    for width, height in ((390, 844), (768, 1024), (1024, 768)):
        page.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
                  mobile=width < 720)
        comes_true(lambda: page.evaluate("innerWidth") == width, "the screen is small")
        assert page.evaluate(MISPLACED) == "", (width, page.evaluate(MISPLACED))
        layers = "document.getElementById('layers').offsetHeight > 0"
        assert page.evaluate(layers) is (width > 720), width
        if width > 720:
            continue
        page.evaluate("document.getElementById('more').click()")
        assert page.evaluate(layers) is True
        assert page.evaluate("document.getElementById('position').offsetHeight > 0") is True
        assert page.evaluate(MISPLACED) == "", page.evaluate(MISPLACED)
        page.evaluate("document.getElementById('more').click()")


def main():
    strata, hall, work = sys.argv[1:4]
    browser = find_browser()
    subprocess.run([strata, "learn", simulated(strata, hall, work), "--out", f"{work}/maps", "--quiet"],
                   check=True)
    test_areas(strata, browser, work)
    port = free_port()
    with viewed(browser, strata, COMPOSITION, work, port=port) as (page,):
        test_drawing(page)
        test_shades(page)
        test_silence_of_a_layer(page)
        test_topology(page)
        test_memory(page)
        test_version(page, work)
        test_setting_a_pose(page, port)
        test_relocalizing(page, port)
        test_small_screens(page)


main()
