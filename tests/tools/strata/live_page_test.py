#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The live page of a robot that maps, in headless Chromium: what it draws, and that it says so when
the robot falls silent.

usage: live_page_test.py STRATA HALL.yaml WORK [SCREENSHOT.png]

Exits with 77 when no Chromium is installed (Debian: chromium-headless-shell or chromium).
"""
import os
import sys
import tempfile

from browser_page import Page, find_browser, shows_a_robot
from robot_process import ONE_PROCESS, comes_true, free_port, listens, simulated, started

COMPOSITION = ONE_PROCESS + """\
      - {{type: strata::Player, name: player, parameters: {{log: {log}, rate: 20.0}}}}
      - {{type: strata::ScanMatcher, name: scan_matcher, parameters: {{maps: {{publish_every_s: 0.5, folder: {work}/maps}}}}}}
      - {{type: strata::BeamFilter, name: beam_filter}}
      - {{type: strata::LiveView, name: live_view, parameters: {{port: {port}}}}}
"""


def main():
    strata, hall, work = sys.argv[1:4]
    browser = find_browser()
    log = simulated(strata, hall, work)
    port = free_port()
    robot = started(strata, COMPOSITION, work, log=log, port=port)
    page = None
    try:
        comes_true(lambda: listens(port), "the live view listens")
        page = Page(browser, f"http://localhost:{port}/?probe", tempfile.mkdtemp(dir=work))
        comes_true(lambda: shows_a_robot(page.drawn()), "map, scan and pose are drawn")
        comes_true(lambda: page.text("verdict") == "Mapping", "the page says that it maps")
        assert page.text("link") == "live", page.text("link")
        assert page.evaluate("document.getElementById('place').disabled") is False
        comes_true(lambda: not page.evaluate("document.getElementById('save').disabled"), "saving is offered")
        page.evaluate("document.getElementById('save').click()")
        comes_true(lambda: page.text("hint") == "The maps are saved", "the mapper is asked to save")
        assert os.path.exists(f"{work}/maps/strata.db"), os.listdir(work)
        if len(sys.argv) > 4:
            page.shoot(sys.argv[4])
        robot.terminate()
        robot.wait()
        comes_true(lambda: page.text("verdict") == "No news", "the page says that news is old")
        assert page.text("link") == "not connected", page.text("link")
        assert page.evaluate("document.getElementById('place').disabled") is True
        print("drawn:", page.drawn())
        # The page stays open. Had the robot localized before, it would have known a better map and another pose.
        page.evaluate("robot.mapRank = 2; robot.hasLocalizer = true; robot.map = null; robot.pose = null")
        robot = started(strata, COMPOSITION, work, log=log, port=port)
        comes_true(lambda: page.text("link") == "live", "the page finds the robot again")
        comes_true(lambda: page.text("verdict") == "Mapping" and shows_a_robot(page.drawn()), "the new map and pose are drawn")
    finally:
        robot.kill()
        if page is not None:
            page.close()


main()
