#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`strata run --view`, `strata replay --view` and `strata view MAPS`, in headless Chromium.

usage: view_verbs_test.py run|replay|maps STRATA HALL.yaml WORK

Exits with 77 when no Chromium is installed (Debian: chromium-headless-shell or chromium).
"""
import subprocess
import sys
import tempfile
import urllib.request

from browser_page import Page, find_browser, shows_a_robot
from robot_process import comes_true, free_port, listens, simulated

# Two processes: the page is in neither.
RUN = """version: 1
transport: loopback
processes:
  - name: player
    components: [{{type: strata::Player, name: player, parameters: {{log: {log}, rate: 20.0}}}}]
  - name: mapping
    components:
      - {{type: strata::ScanMatcher, name: scan_matcher, parameters: {{maps: {{publish_every_s: 0.5}}}}}}
"""
REPLAY = """version: 1
transport: loopback
processes:
  - name: robot
    components:
      - {type: strata::ScanMatcher, name: scan_matcher}
      - {type: strata::BeamFilter, name: beam_filter}
      - {type: strata::PatchLearner, name: patch_learner}
      - {type: strata::TimescaleMemory, name: timescale_memory}
"""
LOCALIZE = """version: 1
transport: loopback
processes:
  - name: robot
    components:
      - {type: strata::Localizer, name: localizer, parameters: {maps: MAPS, model: patch, start: {pose: [0, 0, 0]}}}
"""


def write(path, text):
    with open(path, "w") as out:
        out.write(text)


def open_page(browser, port, work):
    comes_true(lambda: listens(port), "the live view listens")
    return Page(browser, f"http://localhost:{port}/?probe", tempfile.mkdtemp(dir=work))


def test_run(strata, work, log, browser):
    write(f"{work}/run.yaml", RUN.format(log=log))
    port = free_port()
    robot = subprocess.Popen([strata, "run", f"{work}/run.yaml", f"--view={port}", "--quiet"])
    page = None
    try:
        page = open_page(browser, port, work)
        comes_true(lambda: shows_a_robot(page.drawn()), "map, scan and pose are drawn")
        def are_told():
            with urllib.request.urlopen(f"http://localhost:{port}/metrics") as answer:
                text = answer.read().decode()
            return all(f'strata_component_up{{component="/{component}"}} 1' in text
                       for component in ("player", "scan_matcher", "live_view"))
        comes_true(are_told, "the metrics tell of both processes and of the page's own component")
    finally:
        robot.terminate()
        robot.wait()
        if page is not None:
            page.close()
    assert robot.returncode == 0, robot.returncode
    # A composition that has a page needs no second one.
    write(f"{work}/has_one.yaml", REPLAY + "      - {type: strata::LiveView, name: page}\n")
    refused = subprocess.run([strata, "run", f"{work}/has_one.yaml", f"--view={port}"], text=True,
                             capture_output=True)
    assert refused.returncode == 2 and "already" in refused.stderr, refused


def test_replay(strata, work, log, browser):
    """The page shows it, and nothing comes out otherwise."""
    subprocess.run([strata, "learn", log, "--out", f"{work}/maps", "--quiet"], check=True)
    write(f"{work}/localize.yaml", LOCALIZE.replace("MAPS", f"{work}/maps"))
    replay = [strata, "replay", log, "--composition", f"{work}/localize.yaml", "--quiet"]
    subprocess.run([*replay, "--out", f"{work}/alone"], check=True)
    port = free_port()
    watched = subprocess.Popen([*replay, "--out", f"{work}/watched", f"--view={port}", "--rate",
                                "4"])  # half a minute: a busy machine opens the page late
    page = None
    try:
        page = open_page(browser, port, work)
        comes_true(lambda: shows_a_robot(page.drawn()), "map, scan and pose are drawn")
        comes_true(lambda: page.text("verdict") == "Localized", "the page says that it localizes")
        assert watched.wait() == 0, watched.returncode
    finally:
        watched.kill()
        if page is not None:
            page.close()
    for name in ("trajectory.tum", "states.csv"):
        with open(f"{work}/alone/{name}") as alone, open(f"{work}/watched/{name}") as seen:
            assert alone.read() == seen.read(), name


def test_maps(strata, work, log, browser):
    subprocess.run([strata, "learn", log, "--out", f"{work}/maps", "--quiet"], check=True)
    port = free_port()
    viewing = subprocess.Popen([strata, "view", f"{work}/maps", "--port", str(port), "--quiet"])
    page = None
    try:
        page = open_page(browser, port, work)
        comes_true(lambda: page.drawn().get("free", 0) > 2000 and page.drawn().get("wall", 0) > 20,
                   "the map is drawn")
        comes_true(lambda: page.text("verdict") == "Map", "the page says what it shows")
        areas = page.evaluate("robot.patches.submaps.length")
        assert areas > 0, areas
        assert page.evaluate("document.getElementById('relocalize').disabled") is True
        viewing.terminate()
        assert viewing.wait() == 0, viewing.returncode
    finally:
        viewing.kill()
        if page is not None:
            page.close()
    for words, told in (([f"{work}/nowhere"], "nowhere"),
                        ([f"{work}/maps", "--set", "tokens=x"], "tokens"),
                        ([f"{work}/maps", "--set", "address=0.0.0.0"], "token")):
        refused = subprocess.run([strata, "view", *words], text=True, capture_output=True)
        assert refused.returncode == 2 and told in refused.stderr, refused


def main():
    mode, strata, hall, work = sys.argv[1:5]
    browser = find_browser()
    log = simulated(strata, hall, work)
    {"run": test_run, "replay": test_replay, "maps": test_maps}[mode](strata, work, log, browser)


main()
