#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The page that `strata localize` and `strata compare` leave of a drive, opened from its file in headless Chromium.

usage: replay_page_test.py STRATA HALL.yaml WORK

Exits with 77 when no Chromium is installed (Debian: chromium-headless-shell or chromium).
"""
import json
import os
import subprocess
import sys

from browser_page import Page, find_browser
from robot_process import comes_true, simulated

# Of the pixels of a color in the first canvas of a selector: how many, and where their middle is.
MIDDLE = """(() => {
  const canvas = document.querySelectorAll('.panel canvas')[%d];
  const {data, width} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
  let [n, x, y] = [0, 0, 0];
  for (let i = 0; i < data.length; i += 4) {
    if (data[i] !== %d || data[i + 1] !== %d || data[i + 2] !== %d) continue;
    n += 1; x += i / 4 %% width; y += Math.floor(i / 4 / width);
  }
  return JSON.stringify([n, x / n, y / n]);
})()"""
POSE, TRUTH, BEAM, PARTICLE = (31, 95, 208), (217, 98, 43), (15, 127, 140), (123, 79, 201)


def middle(page, color, panel=0):
    return json.loads(page.evaluate(MIDDLE % (panel, *color)))


def slide(page, scan):
    page.evaluate(f"at('time').value = {scan}; at('time').dispatchEvent(new Event('input'))")


def opened(browser, path, work, name):
    os.makedirs(f"{work}/{name}")
    page = Page(browser, f"file://{os.path.abspath(path)}", f"{work}/{name}")
    comes_true(lambda: page.evaluate("document.body && document.body.dataset.ready") == "1",
               "the page has drawn its map")
    return page


def looks_through(page, work):
    last = page.evaluate("scans - 1")
    assert last > 50, last
    slide(page, 0)
    begin, beams = middle(page, POSE), middle(page, BEAM)
    assert begin[0] > 25 and beams[0] > 100, (begin, beams)
    told = page.evaluate("document.querySelector('.panel output').textContent")
    assert told.endswith("m off"), told
    # Particles where they are: here all of them 2 m beside the pose.
    page.evaluate("drive.tracks[0].particles[0] = Array.from({length: 40}, (_, k) => k % 2 ? 0 : 200)")
    slide(page, 0)
    dots = middle(page, PARTICLE)
    scale = page.evaluate("Math.min(panels[0].canvas.width / drive.map.width_m, panels[0].canvas.height / drive.map.height_m)")
    assert dots[0] > 4 and abs(dots[1] - begin[1] - 2 * scale) < 10 and abs(dots[2] - begin[2]) < 10, (dots, begin, scale)
    assert middle(page, TRUTH)[0] > 10, "the truth is drawn"
    slide(page, last // 2)
    there = middle(page, POSE)
    assert abs(there[1] - begin[1]) + abs(there[2] - begin[2]) > 20, (begin, there)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.shoot(f"{work}/replay.png")
    # It plays from where the slider is, and pauses.
    page.evaluate("at('speed').value = '16'; at('play').click()")
    comes_true(lambda: page.evaluate("Number(at('time').value)") > last // 2, "it plays")
    assert page.text("play") == "Pause"
    page.evaluate("at('play').click()")
    stopped = page.evaluate("at('time').value")
    assert page.text("play") == "Play"
    assert page.evaluate("new Promise((done) => requestAnimationFrame(() => done(0))), "
                         "at('time').value") == stopped
    # Where nothing was recorded for minutes it goes on at once.
    gap = page.evaluate("drive.times.findIndex((t, i) => drive.times[i + 1] - t > 300000)")
    assert gap > 0, gap
    slide(page, gap)
    page.evaluate("at('speed').value = '1'; at('play').click()")
    comes_true(lambda: page.evaluate("Number(at('time').value)") > gap, "it skips what is empty")
    page.evaluate("at('play').click()")
    # To the end, where it stops by itself.
    page.evaluate("at('speed').value = '64'; at('play').click()")
    comes_true(lambda: page.text("play") == "Play", "it stops at the end")
    assert page.evaluate("Number(at('time').value)") == last


def opened_with(browser, path, work, name, more):
    """The page with more tracks: what `more` makes of its first."""
    text = open(path).read()
    head = '<script id="drive" type="application/json">'
    at = text.index(head) + len(head)
    end = text.index("</script>", at)
    drive = json.loads(text[at:end])
    drive["tracks"] += more(drive["tracks"][0])
    with open(f"{work}/{name}.html", "w") as out:
        out.write(text[:at] + json.dumps(drive).replace("<", "\\u003c") + text[end:])
    return opened(browser, f"{work}/{name}.html", work, name)


def every_model_has_a_panel(browser, path, work):
    """A second way, moved by 2 m, shows up beside the first."""
    page = opened_with(browser, path, work, "two", lambda track: [
        {**track, "name": "<b>other", "poses": [[x + 2000, y, theta] for x, y, theta in track["poses"]]}])
    try:
        names = json.loads(page.evaluate(
            "JSON.stringify([...document.querySelectorAll('.panel h2 span')].map((n) => n.textContent))"))
        assert names == ["patch", "<b>other"], names
        slide(page, 10)
        one, two = middle(page, POSE, 0), middle(page, POSE, 1)
        assert two[0] > 25 and two[1] > one[1] + 10, (one, two)
        page.shoot(f"{work}/two.png")
    finally:
        page.close()


def many_models_are_in_view_at_once(browser, path, work):
    page = opened_with(browser, path, work, "six", lambda track: [{**track, "name": f"{i}"} for i in range(5)])
    try:
        assert page.evaluate("panels.length") == 6
        assert page.evaluate("at('panels').scrollHeight <= at('panels').clientHeight")
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        page.shoot(f"{work}/six.png")
    finally:
        page.close()


def a_comparison_shows_its_models(browser, strata, work):
    subprocess.run([strata, "compare", f"{work}/world/log.clf", "--truth", f"{work}/world/truth.tum",
                    "--models", "filtered,patch", "--seeds", "1", "--out", f"{work}/comparison",
                    "--set", "protocol.memory_steps=0", "--quiet"], check=True)
    page = opened(browser, f"{work}/comparison/replay.html", work, "compared")
    try:
        names = page.evaluate("drive.tracks.map((track) => track.name).join()")
        assert names == "filtered,patch", names
        slide(page, 40)
        for panel in (0, 1):
            assert middle(page, POSE, panel)[0] > 25, panel
        assert page.evaluate("drive.tracks[0].areas.length") == 0
        assert page.evaluate("drive.tracks.every((track) => track.particles.length === scans)")
        assert page.evaluate("panels[1].track.particles[40].length") == 40, "20 particles, x and y in turn"
        assert page.evaluate("drive.tracks[1].areas.length") > 0
        assert page.evaluate("Object.keys(panels[1].believed[scans - 1]).length") > 0, "states"
        # What the page tells is what the comparison measured, but for the spread of the particles.
        off = page.evaluate("Math.max(...drive.times.map((_, i) => value(drive.tracks[1], i)))")
        assert 0 < off < 0.5, off
        page.shoot(f"{work}/compared.png")
    finally:
        page.close()


def main():
    strata, hall, work = sys.argv[1:4]
    browser = find_browser()
    log = simulated(strata, hall, work)
    truth = f"{work}/world/truth.tum"
    subprocess.run([strata, "learn", log, "--truth", truth, "--out", f"{work}/maps", "--quiet"],
                   check=True)
    subprocess.run([strata, "localize", log, "--truth", truth, "--maps", f"{work}/maps", "--out",
                    f"{work}/out", "--quiet"], check=True)
    path = f"{work}/out/replay.html"
    text = open(path).read()
    assert len(text) < 5_000_000, len(text)
    assert "http://" not in text and "https://" not in text, "nothing is asked of the network"
    assert '"areas":[[' in text, "patch has areas that change"
    subprocess.run([strata, "localize", log, "--truth", truth, "--maps", f"{work}/maps", "--model", "filtered",
                    "--out", f"{work}/filtered", "--quiet"], check=True)
    assert '"areas":[]' in open(f"{work}/filtered/replay.html").read(), "a map without any shows none"
    page = opened(browser, path, work, "one")
    try:
        looks_through(page, work)
    finally:
        page.close()
    every_model_has_a_panel(browser, path, work)
    many_models_are_in_view_at_once(browser, path, work)
    a_comparison_shows_its_models(browser, strata, work)
    return 0


if __name__ == "__main__":
    sys.exit(main())
