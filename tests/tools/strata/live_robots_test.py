#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the live page shows of two robots on a domain, in headless Chromium.

usage: live_robots_test.py STRATA HALL.yaml WORK

Exits with 77 when no Chromium is installed (Debian: chromium-headless-shell or chromium).
"""
import json
import subprocess
import sys

from browser_page import find_browser, viewed
from robot_process import comes_true, free_port, simulated

ROBOT = """      - {{type: strata::Player, name: player, namespace: /ROBOT, remappings: {{scan: SCAN}}, parameters: {{log: {work}/world/log.clf, rate: 2.0}}}}
      - type: strata::Localizer
        name: localizer
        namespace: /ROBOT
        remappings: {{scan: SCAN}}
        parameters: {{maps: {work}/maps, model: filtered, start: {{pose: [0, 0, 0]}}}}
"""
COMPOSITION = """version: 1
transport: loopback
processes:
  - name: robots
    executor: multi_threaded
    components:
""" + ROBOT.replace("ROBOT", "ada").replace("SCAN", "scan") + ROBOT.replace("ROBOT", "bob").replace("SCAN", "base_scan") + """
      - {{type: strata::LiveView, name: live_view, namespace: /bob, parameters: {{port: {of_bob}}}}}
      - {{type: strata::LiveView, name: live_view, parameters: {{port: {of_nobody}}}}}
"""
COMMANDS = ("place", "relocalize", "save")
OWN = [False, False, True]  # neither robot maps


def owners(page):
    """Whose topics the page has asked for; those that all share left out."""
    topics = json.loads(page.evaluate("JSON.stringify([...subscriptions.values()].map((s) => s.topic))"))
    return {topic.split("/")[1] for topic in topics if topic.count("/") > 1}


def shows(page, name):
    """Pose, map and verdict are of this robot, and nothing of another one is asked for."""
    comes_true(lambda: page.evaluate("robot.pose !== null && robot.map !== null"), "pose and map")
    assert page.evaluate("robot.map.topic").startswith(f"/{name}/"), page.evaluate("robot.map.topic")
    comes_true(lambda: page.evaluate("robot.verdict && robot.verdict.name") == f"{name}/localizer: health",
               "the verdict")
    comes_true(lambda: page.evaluate("robot.scan !== null"), "the scan, whatever its topic is called")
    assert owners(page) == {name}, owners(page)


def chosen(page, name):
    # In one go: nothing comes in between.
    assert page.evaluate(f"$('robots').value = '/{name}'; $('robots').dispatchEvent(new Event('change'));"
                         "robot.pose === null && robot.map === null"), "the other one is forgotten"
    shows(page, name)


def are_disabled(page):
    return [page.evaluate(f"$('{button}').disabled") for button in COMMANDS]


def test_a_long_name(page):
    """Words stay in their card."""
    page.evaluate("tellState = ((told) => () => { robot.map.topic = '/ward_3_on_the_second_floor/map'; told(); })(tellState)")
    comes_true(lambda: "/ward_3" in page.text("mapname"), "the map's name is told")
    assert page.evaluate("[...document.querySelectorAll('#state dd')].every((one) => one.getBoundingClientRect().right "
                         "< $('state').getBoundingClientRect().right)"), "a word leaves its card"


def test_its_own_robot_first(page):
    comes_true(lambda: page.evaluate("fleet.robots.size") == 2, "both robots are heard")
    assert page.evaluate("$('robots').hidden") is False and page.evaluate("$('robots').value") == "/bob"
    shows(page, "bob")
    assert are_disabled(page) == OWN, are_disabled(page)


def test_choosing_the_other(page):
    chosen(page, "ada")
    assert are_disabled(page) == [True] * 3, "this live view commands bob"
    assert "/ada" in page.evaluate("$('place').title"), page.evaluate("$('place').title")
    chosen(page, "bob")
    assert are_disabled(page) == OWN and page.evaluate("$('place').title") == ""


def test_a_view_of_neither(page):
    comes_true(lambda: page.evaluate("fleet.robots.size") == 2, "both robots are heard")
    shows(page, page.evaluate("$('robots').value").strip("/"))
    assert are_disabled(page) == [True] * 3, are_disabled(page)


def main():
    strata, hall, work = sys.argv[1:4]
    browser = find_browser()
    subprocess.run([strata, "learn", simulated(strata, hall, work), "--out", f"{work}/maps", "--quiet"],
                   check=True)
    with viewed(browser, strata, COMPOSITION, work, of_bob=free_port(), of_nobody=free_port()) as (bob, nobody):
        test_its_own_robot_first(bob)
        test_choosing_the_other(bob)
        test_a_view_of_neither(nobody)
        test_a_long_name(bob)


main()
