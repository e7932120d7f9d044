#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The areas that change, and the zones, on the live page of a robot whose localizer has a site, in
headless Chromium.

usage: live_areas_test.py STRATA HALL.yaml WORK

Exits with 77 when no Chromium is installed (Debian: chromium-headless-shell or chromium).
"""
import json
import shutil
import subprocess
import sys

from browser_page import find_browser, layer, mouse, screen, viewed
from robot_process import ONE_PROCESS, approve_version, comes_true, free_port, simulated, site

# The site's maps are of a localizer alone: nobody publishes /patch_map.
COMPOSITION = ONE_PROCESS + """\
      - {{type: strata::Player, name: player, parameters: {{log: {work}/world/log.clf, rate: 4.0}}}}
      - type: strata::Localizer
        name: localizer
        parameters: {{maps: {work}/site, model: patch, start: {{pose: [0, 0, 0]}}}}
      - {{type: strata::LiveView, name: live_view, parameters: {{port: {port}}}}}
"""
AREA = """JSON.stringify((() => { const a = robot.patches.submaps[0], r = areaRect(a);
  return { id: a.id, x: r.x + r.w / 2, y: r.y + r.h / 2, count: a.configurations.length }; })())"""


def make_site(strata, hall, work):
    """The hall's maps as version 1, which is active, and the same as version 2."""
    subprocess.run([strata, "learn", simulated(strata, hall, work), "--out", f"{work}/maps", "--quiet"],
                   check=True)
    shutil.copytree(f"{work}/maps", f"{work}/again")
    with open(f"{work}/again/trajectory.tum", "a") as out:
        out.write("\n")
    site(strata, "init", f"{work}/site", "--id", "hall")
    approve_version(strata, f"{work}/site", f"{work}/maps", 1)
    approve_version(strata, f"{work}/site", f"{work}/again", 2)
    site(strata, "activate", f"{work}/site", "1")


def test_areas_are_drawn_and_clickable(page):
    comes_true(lambda: page.evaluate("robot.patches !== null && robot.map !== null"), "areas")
    assert page.evaluate("robot.patchesTopic") == "/localizer/patch_map"
    page.evaluate("setFollow(false); fitMap(); view.isChosen = true")
    assert layer(page, "areas")["count"] > 100
    comes_true(lambda: page.evaluate("robot.patches.submaps.every((a) => robot.states.has(a.id) && "
                                     "robot.states.get(a.id).length === a.configurations.length)"),
               "what the localizer believes of each")
    area = json.loads(page.evaluate(AREA))
    x, y = screen(page, area["x"], area["y"])
    mouse(page, "mousePressed", x, y)
    mouse(page, "mouseReleased", x, y)
    comes_true(lambda: page.evaluate("$('area').hidden") is False, "a click opens the area's card")
    text = page.text("area")
    assert text.startswith(f"Area {area['id']}"), text
    assert text.count("Configuration ") == area["count"], text
    # In one turn of the page's: what is shown is what is believed.
    shown = json.loads(page.evaluate(
        "draw(); JSON.stringify([[...document.querySelectorAll('#area .bar p span:last-child')].map((s) => "
        f"s.textContent), robot.states.get({area['id']}).map((p) => Math.round(p * 100) + '%')])"))
    assert shown[0] == shown[1], shown


def test_another_version(page, strata, work):
    """Its areas come in the place of the others, and what was believed of those goes."""
    page.evaluate("window.before = robot.patches; robot.states.set(-1, [1])")
    site(strata, "activate", f"{work}/site", "2")
    comes_true(lambda: page.evaluate("robot.patches !== window.before"), "the next version's areas")
    assert page.evaluate("robot.patchesTopic") == "/localizer/patch_map"
    assert page.evaluate("robot.states.has(-1)") is False
    assert layer(page, "areas")["count"] > 100
    comes_true(lambda: page.evaluate("robot.states.size > 0"), "what is believed of them")


def test_a_learner_comes_first(page):
    """Messages as they may come, in any order."""
    other = "(n) => ({ base: robot.patches.base, submaps: robot.patches.submaps.slice(0, n) })"
    page.evaluate(f"window.make = {other}; window.one = make(1); window.two = make(1);"
                  "takers['strata_msgs/msg/PatchMap'](one, '/patch_map');"
                  "takers['strata_msgs/msg/PatchMap'](two, '/localizer/patch_map')")
    assert page.evaluate("robot.patches === one") is True, "the localizer's does not replace it"
    page.evaluate("takers['strata_msgs/msg/PatchMap'](two, '/patch_map')")
    assert page.evaluate("robot.patches === two") is True, "the learner's next one does"
    page.evaluate("takers['strata_msgs/msg/PatchMap'](one, '/other/patch_map')")
    assert page.evaluate("robot.patches === two") is True
    # States of other areas say nothing of these.
    assert page.evaluate("robot.states.set(two.submaps[0].id, [1, 0, 0, 0, 0, 0, 0]);"
                         "beliefOf(two.submaps[0]).length === two.submaps[0].configurations.length") is True


def square(name, kind, low, high, **properties):
    x, y = low
    u, v = high
    return {"type": "Feature", "properties": {"name": name, "kind": kind, **properties},
            "geometry": {"type": "Polygon", "coordinates": [[[x, y], [u, y], [u, v], [x, v], [x, y]]]}}


def test_zones(page, strata, work):
    """They are drawn where they lie as soon as somebody has drawn them, and a click says what holds there."""
    features = [square("stairs", "keepout", (1.0, -0.5), (2.0, 0.5)),
                square("slow", "speed", (1.5, 0.0), (3.0, 1.0), speed_percent=40),
                square("calm", "learn", (-1.0, -1.0), (0.0, 0.0), control="never_learn")]
    with open(f"{work}/zones.geojson", "w") as out:
        json.dump({"type": "FeatureCollection", "features": features}, out)
    assert layer(page, "zones")["count"] == 0
    site(strata, "zones", f"{work}/site", "set", f"{work}/zones.geojson")
    kinds = "[...zones.masks].filter(([k, m]) => isSet(k, m)).map(([k]) => k).sort().join()"
    comes_true(lambda: page.evaluate(kinds) == "keepout,never_learn,speed", "the zones")
    page.evaluate("setFollow(false); fitMap(); view.isChosen = true; chosen = null")
    corners = screen(page, -1.0, 1.0) + screen(page, 3.0, -1.0)
    drawn = layer(page, "zones")["box"]
    assert all(abs(at - wanted) < 4 for at, wanted in zip(drawn, corners)), (drawn, corners)
    said = {(1.2, -0.2): ["No robots here"], (1.7, 0.2): ["No robots here", "Speed at most 40%"],
            (2.5, 0.5): ["Speed at most 40%"], (-0.5, -0.5): ["Nothing is learned here"], (1.2, 0.8): []}
    for (x, y), words in said.items():  # what the values mean comes after the mask
        comes_true(lambda: json.loads(page.evaluate(f"JSON.stringify(zonesAt({x}, {y}))")) == words,
                   f"what holds at ({x}, {y})")
    # Whichever mask comes first.
    both = ["No robots here", "Speed at most 40%"]
    for order in ("", ".reverse()"):
        page.evaluate(f"zones.masks = new Map([...zones.masks]{order})")
        said = json.loads(page.evaluate("JSON.stringify(zonesAt(1.7, 0.2))"))
        assert said == both, (order, said)
    page.evaluate("robot.patches = null")  # no area below the pointer
    x, y = screen(page, 2.5, 0.5)
    mouse(page, "mousePressed", x, y)
    mouse(page, "mouseReleased", x, y)
    assert page.text("hint") == "Speed at most 40%", page.text("hint")
    site(strata, "zones", f"{work}/site", "remove", "stairs")
    comes_true(lambda: page.evaluate(kinds) == "never_learn,speed", "one of them is gone")


def main():
    strata, hall, work = sys.argv[1:4]
    browser = find_browser()
    make_site(strata, hall, work)
    with viewed(browser, strata, COMPOSITION, work, port=free_port()) as (page,):
        test_areas_are_drawn_and_clickable(page)
        test_another_version(page, strata, work)
        test_a_learner_comes_first(page)
        test_zones(page, strata, work)


main()
