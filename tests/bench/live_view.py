#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the live view costs and how fast it is, with a scanner of 1,080 beams at 10 Hz.

usage: live_view.py STRATA HALL.yaml WORK

The robot localizes in one process; the live view is a process of its own, so that its CPU time is
its own. Prints the time from opening the page to its first picture, how many scans a second the
page draws, and the CPU time of the view with no viewer, with one and with 20.
"""
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.request

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../tools/strata"))
from browser_page import Page, find_browser  # noqa: E402
from live_viewer import Viewer  # noqa: E402
from robot_process import comes_true, free_port, listens, started  # noqa: E402

MEASURED_S = 20.0
COMPOSITION = """version: 1
transport: loopback
processes:
  - name: robot
    executor: multi_threaded
    components:
      - {{type: strata::Player, name: player, parameters: {{log: {work}/world/log.clf, loop: true}}}}
      - type: strata::Localizer
        name: localizer
        parameters: {{maps: {work}/maps, model: filtered, start: {{pose: [0, 0, 0]}}}}
  - name: view
    components:
      - {{type: strata::LiveView, name: live_view, parameters: {{port: {port}}}}}
"""


def cpu_s(port):
    with urllib.request.urlopen(f"http://localhost:{port}/metrics") as answer:
        for line in answer.read().decode().splitlines():
            if line.startswith("process_cpu_seconds_total "):
                return float(line.split()[1])
    raise RuntimeError("no process_cpu_seconds_total")


def percent_of_a_core(port):
    before, begin = cpu_s(port), time.monotonic()
    time.sleep(MEASURED_S)
    return 100 * (cpu_s(port) - before) / (time.monotonic() - begin)


def make_world(strata, hall, work):
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    with open(hall) as scenario:
        text = scenario.read()
    for old, new in (("beams: 181", "beams: 1080"), ("rate_hz: 5", "rate_hz: 10"),
                     ("field_of_view_deg: 180", "field_of_view_deg: 270"), ("days: 5", "days: 1")):
        assert old in text, old
        text = text.replace(old, new)
    text = "\n".join(line for line in text.split("\n") if "{day: " not in line or "{day: 1" in line)
    with open(f"{work}/hall.yaml", "w") as out:
        out.write(text)
    for verb in (["simulate", f"{work}/hall.yaml", "--seed", "1", "--out", f"{work}/world"],
                 ["learn", f"{work}/world/log.clf", "--only", "em", "--out", f"{work}/maps"]):
        subprocess.run([strata, *verb, "--quiet"], check=True)


def first_pictures(browser, port, work):
    """Seconds from asking for the page to the first picture with map, scan and pose, five times."""
    times = []
    page = Page(browser, "about:blank", tempfile.mkdtemp(dir=work))
    for _ in range(5):
        page.call("Page.navigate", url=f"http://localhost:{port}/")
        comes_true(lambda: page.evaluate(
            "typeof robot !== 'undefined' && !!(robot.map && robot.pose && (robot.scan || robot.labeled))"
            " && (window.firstPicture = window.firstPicture || performance.now())"),
            "the first picture")
        times.append(page.evaluate("window.firstPicture") / 1e3)
    return page, times


def main():
    strata, hall, work = sys.argv[1:4]
    browser = find_browser()
    make_world(strata, hall, work)
    port = free_port()
    robot = started(strata, COMPOSITION, work, port=port)
    page = None
    try:
        comes_true(lambda: listens(port), "the live view listens")
        time.sleep(5)
        print(f"no viewer: {percent_of_a_core(port):.1f}% of a core")
        page, times = first_pictures(browser, port, work)
        print(f"first picture: median {statistics.median(times):.2f} s, "
              f"longest {max(times):.2f} s of {len(times)}")
        page.evaluate("window.scans = 0; const take = takers['sensor_msgs/msg/LaserScan'];"
                      "for (const s of subscriptions.values()) if (s.take === take)"
                      " s.take = (m, topic) => { ++window.scans; take(m, topic); };"
                      "window.drawnBefore = drawn; window.begin = performance.now()")
        print(f"one viewer, the page: {percent_of_a_core(port):.1f}% of a core")
        scans, pictures, seconds = json.loads(page.evaluate(
            "JSON.stringify([window.scans, drawn - window.drawnBefore,"
            " (performance.now() - window.begin) / 1e3])"))
        print(f"the page: {scans / seconds:.1f} scans and {pictures / seconds:.1f} pictures a second")
        viewers = [Viewer(port) for _ in range(19)]
        time.sleep(3)
        before = [viewer.scans for viewer in viewers]
        begin = time.monotonic()
        print(f"20 viewers, 19 of them reading every topic: {percent_of_a_core(port):.1f}% of a core")
        rates = [(viewer.scans - count) / (time.monotonic() - begin)
                 for viewer, count in zip(viewers, before)]
        print(f"the 19: {min(rates):.1f} to {max(rates):.1f} scans a second")
    finally:
        robot.terminate()
        robot.wait()
        if page is not None:
            page.close()


if __name__ == "__main__":
    main()
