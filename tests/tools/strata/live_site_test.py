#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the live page shows of a site and what is decided there, in headless Chromium.

usage: live_site_test.py STRATA HALL.yaml WORK

Exits with 77 when no Chromium is installed (Debian: chromium-headless-shell or chromium).
"""
import json
import shutil
import subprocess
import sys

from browser_page import find_browser, viewed
from robot_process import ONE_PROCESS, comes_true, free_port, simulated

COMPOSITION = ONE_PROCESS + """\
      - {{type: strata::Player, name: player, parameters: {{log: {work}/world/log.clf, rate: 1.0}}}}
      - type: strata::Localizer
        name: localizer
        parameters: {{maps: {work}/site, model: filtered, start: {{pose: [0, 0, 0]}}}}
      - {{type: strata::LiveView, name: live_view, parameters: {{port: {port}}}}}
      - {{type: strata::LiveView, name: shop_window, parameters: {{port: {closed}, allow_commands: false}}}}
"""


class Hall:
    """A site with version 1 active, and 2 and 3 to be decided on."""

    def __init__(self, strata, hall, work):
        self.strata, self.folder = strata, f"{work}/site"
        subprocess.run([strata, "learn", simulated(strata, hall, work), "--out", f"{work}/maps",
                        "--quiet"], check=True)
        self.site("init", "--id", "hall")
        for number in (1, 2, 3):
            maps = f"{work}/maps{number}"
            shutil.copytree(f"{work}/maps", maps)
            with open(f"{maps}/trajectory.tum", "a") as out:
                out.write("\n" * number)
            self.site("add", maps, "--note", f"tour {number}")
        self.site("approve", "1", "--unchecked")
        self.site("activate", "1")

    def site(self, action, *words):
        subprocess.run([self.strata, "site", action, self.folder, *words, "--quiet"], check=True)

    def asked(self, action, *words):
        return json.loads(subprocess.run([self.strata, "site", action, self.folder, *words, "--json"],
                                         check=True, capture_output=True, text=True).stdout)

    def version(self, number):
        return next(v for v in self.asked("list") if v["number"] == number)


def button(page, version, words):
    """Presses it in the row of a version; '' when there is none."""
    return page.evaluate(
        f"(() => {{ const row = [...document.querySelectorAll('#versions li')].find((li) => "
        f"li.textContent.startsWith('Version {version} ')); const b = row && "
        f"[...row.querySelectorAll('button')].find((b) => b.textContent === {json.dumps(words)});"
        "if (!b || b.disabled) return ''; b.click(); return 'pressed'; })()")


def answer(page, who):
    """Says yes in the dialog, as `who`."""
    assert page.evaluate("$('ask').open") is True
    page.evaluate(f"$('askwho').value = {json.dumps(who)}; $('askyes').click()")


def test_what_there_is(page):
    comes_true(lambda: page.text("siteactive") == "Version 1 is active", "the site")
    assert page.text("sitename") == "Site hall", page.text("sitename")
    rows = json.loads(page.evaluate("JSON.stringify([...document.querySelectorAll('#versions li')]"
                                    ".map((li) => li.textContent))"))
    assert len(rows) == 3, rows
    assert rows[0].startswith("Version 1 active") and "tour 1" in rows[0], rows
    assert rows[1].startswith("Version 3 candidate") and rows[2].startswith("Version 2 candidate"), rows
    assert page.text("back") == "", "there is nothing to go back to"


def test_approving(page, hall):
    assert button(page, 2, "Activate") == "", "it was not approved"
    assert button(page, 2, "Approve") == "pressed"
    page.evaluate("$('askno').click()")
    assert page.evaluate("$('ask').open") is False
    assert hall.version(2)["state"] == "candidate", "who says no changes nothing"
    assert button(page, 2, "Approve") == "pressed"
    assert page.text("asktitle") == "Approve version 2?", page.text("asktitle")
    assert "strata site check" in page.text("asktext"), page.text("asktext")
    answer(page, "Grace")
    comes_true(lambda: "is approved" in page.text("siteword"), "the page says so")
    approved = hall.version(2)
    assert approved["state"] == "approved", approved
    assert "Grace over /localizer" in json.dumps(approved), approved


def test_activating_and_going_back(page, hall):
    comes_true(lambda: button(page, 2, "Activate") == "pressed", "it may be activated now")
    assert page.evaluate("$('askwho').value") == "Grace", "the name is kept"
    answer(page, "Grace")
    new = hall.version(2)["hash"][:12]
    comes_true(lambda: page.text("siteactive") == "Version 2 is active" and page.text("version") == new,
               "the robot follows")
    page.evaluate("document.querySelector('#back button').click()")
    assert page.text("asktitle") == "Roll back to version 1?", page.text("asktitle")
    answer(page, "")
    old = hall.version(1)["hash"][:12]
    comes_true(lambda: page.text("siteactive") == "Version 1 is active" and page.text("version") == old,
               "the robot goes back")
    assert hall.version(2)["state"] == "retired", hall.version(2)


def test_a_refusal(page, hall):
    with open(f"{hall.folder}/versions/{hall.version(3)['hash']}/maps/summary.json", "a") as out:
        out.write(" ")
    assert button(page, 3, "Approve") == "pressed"
    answer(page, "Grace")
    comes_true(lambda: "summary.json was changed" in page.text("siteword"), "the reason is shown")
    assert page.evaluate("$('siteword').className") == "bad"
    assert hall.version(3)["state"] == "candidate", hall.version(3)


# How many pixels have a colour.
PROBE = """window.probeOf = (name) => { const data = pen.getImageData(0, 0, canvas.width, canvas.height).data,
  c = rgb(colors[name]); let n = 0; for (let i = 0; i < data.length; i += 4)
  n += data[i] === c[0] && data[i + 1] === c[1] && data[i + 2] === c[2]; return n; }; 0"""


def test_the_map_of_a_day(page):
    page.evaluate(PROBE)
    assert page.text("dayname") == "As it is now", page.text("dayname")
    before = page.evaluate("shown.plain = shown.pose = shown.particles = false; draw(); probeOf('memory')")
    assert before == 0, before
    page.evaluate("$('day').value = 1; $('day').dispatchEvent(new Event('input'));"
                  "$('day').dispatchEvent(new Event('change'))")
    assert page.text("dayname").startswith("As on ") and "(version 2)" in page.text("dayname")
    comes_true(lambda: page.evaluate("draw(); probeOf('memory')") > 300, "its walls are drawn")
    page.evaluate("$('day').value = $('day').max; $('day').dispatchEvent(new Event('input'));"
                  "$('day').dispatchEvent(new Event('change'))")
    comes_true(lambda: page.evaluate("draw(); probeOf('memory')") == 0, "and now again")


def test_a_page_that_only_looks(page, hall):
    comes_true(lambda: page.text("siteactive") == "Version 1 is active", "the site")
    comes_true(lambda: page.evaluate("services.size") == 1, "maps of days, and nothing else")
    assert page.evaluate("document.querySelectorAll('#versions button, #back button').length") == 0
    page.evaluate("services.set(4, { request: { types: { r: [] }, root: 'r' } });"
                  "socket.send(new Uint8Array([2, 4, 0, 0, 0, 9, 0, 0, 0, 3, 0, 0, 0, 99, 100, 114, 0, 1, 0, 0]))")
    comes_true(lambda: page.text("hint") == "there is no such service", "who asks all the same is refused")
    assert hall.version(1)["state"] == "active"


def main():
    strata, hall_file, work = sys.argv[1:4]
    browser = find_browser()
    hall = Hall(strata, hall_file, work)
    with viewed(browser, strata, COMPOSITION, work, port=free_port(),
                closed=free_port()) as (page, shop_window):
        test_what_there_is(page)
        test_approving(page, hall)
        test_activating_and_going_back(page, hall)
        test_a_refusal(page, hall)
        test_the_map_of_a_day(page)
        test_a_page_that_only_looks(shop_window, hall)


main()
