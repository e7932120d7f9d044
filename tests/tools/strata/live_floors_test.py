#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The level of a building on the live page, and how it is told there, in headless Chromium.

usage: live_floors_test.py STRATA HALL.yaml WORK [PICTURE.png]

Exits with 77 when no Chromium is installed (Debian: chromium-headless-shell or chromium).
"""
import subprocess
import sys

from browser_page import find_browser, viewed
from robot_process import ONE_PROCESS, approve_version, comes_true, free_port, simulated, site

COMPOSITION = ONE_PROCESS + """\
      - {{type: strata::Player, name: player, parameters: {{log: {work}/world/log.clf, rate: 0.5}}}}
      - type: strata::Localizer
        name: localizer
        parameters: {{maps: {work}/house, model: filtered, start: {{level: Ground, pose: [0, 0, 0]}}}}
      - {{type: strata::LiveView, name: live_view, parameters: {{port: {port}}}}}
      - {{type: strata::LiveView, name: shop_window, parameters: {{port: {closed}, allow_commands: false}}}}
"""


def make_house(strata, hall, work):
    """Two levels that look the same."""
    subprocess.run([strata, "learn", simulated(strata, hall, work), "--out", f"{work}/maps", "--quiet"],
                   check=True)
    site(strata, "init", f"{work}/house", "--id", "house")
    for name, elevation in (("Ground", "0"), ("First", "3.5")):
        site(strata, "levels", f"{work}/house", "add", name, "--elevation", elevation)
        level = f"{work}/house/levels/{name}"
        approve_version(strata, level, f"{work}/maps")
        site(strata, "activate", level, "1")


def tell(page, level, button):
    page.evaluate("$('tellfloor').click()")
    assert page.evaluate("$('askfloor').open") is True
    page.evaluate(f"$('floorname').value = '{level}'; $('{button}').click()")


def test_the_level_is_shown_and_told(page, picture):
    comes_true(lambda: page.text("floor") == "Ground (0.0 m)", "the level of the start")
    comes_true(lambda: page.evaluate("$('tellfloor').hidden") is False, "another one may be told")
    tell(page, "", "floorno")
    tell(page, "Attic", "floorone")
    comes_true(lambda: "there is no level 'Attic'" in page.text("hint"), "a level that is none is refused")
    assert page.text("floor") == "Ground (0.0 m)"
    tell(page, "First", "floorone")
    comes_true(lambda: page.text("floor") == "First (3.5 m)", "the robot is there now")
    comes_true(lambda: page.text("verdict") == "Localized", "and finds its place")
    if picture:
        page.evaluate("$('tellfloor').click()")
        page.shoot(picture)
        page.evaluate("$('floorno').click()")


def test_levels_that_look_the_same(page):
    tell(page, "", "floorall")
    comes_true(lambda: page.text("floor") in ("First or Ground?", "Ground or First?"), "both are possible")
    assert page.evaluate("$('floor').classList.contains('doubt')") is True
    options = page.evaluate("$('tellfloor').click(); const all = [...$('floors').children].map((o) => o.value);"
                            "$('floorno').click(); all.join()")
    assert options == "First,Ground", options


def test_a_page_that_only_looks(page):
    comes_true(lambda: page.evaluate("robot.floor !== null"), "the level")
    assert page.evaluate("$('tellfloor').hidden") is True


def main():
    strata, hall, work = sys.argv[1:4]
    browser = find_browser()
    make_house(strata, hall, work)
    with viewed(browser, strata, COMPOSITION, work, port=free_port(),
                closed=free_port()) as (page, shop_window):
        test_the_level_is_shown_and_told(page, sys.argv[4] if len(sys.argv) > 4 else "")
        test_levels_that_look_the_same(page)
        test_a_page_that_only_looks(shop_window)


main()
