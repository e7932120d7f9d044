#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Viewers that come and go for a long time: memory of the live view, and how late scans come.

usage: live_soak.py STRATA HALL.yaml WORK [--minutes M] [--rate R]

The robot localizes in one process and the live view is another. Up to 8 viewers read every topic;
every second one leaves, by closing or by vanishing, and another comes. One more viewer stays from the
first minute to the last and measures by its own clock how far scans are apart. Prints the memory of both processes
once a minute, then what lateness there was.
"""
import argparse
import os
import random
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "../tools/strata"))
from provoked_incidents import one_long_day  # noqa: E402
from robot_process import comes_true, free_port, listens, simulated, started  # noqa: E402
from live_viewer import Viewer  # noqa: E402

COMPOSITION = """version: 1
transport: loopback
processes:
  - name: robot
    executor: multi_threaded
    components:
      - {{type: strata::Player, name: player, parameters: {{log: {work}/world/log.clf, loop: true, rate: {rate}}}}}
      - type: strata::Localizer
        name: localizer
        parameters: {{maps: {work}/maps, model: filtered, start: {{pose: [0, 0, 0]}}}}
  - name: view
    components:
      - {{type: strata::LiveView, name: live_view, parameters: {{port: {port}}}}}
"""


def children(pid):
    with open(f"/proc/{pid}/task/{pid}/children") as file:
        return [int(one) for one in file.read().split()]


def resident_mb(pid):
    with open(f"/proc/{pid}/status") as status:
        return next(int(line.split()[1]) / 1024 for line in status if line.startswith("VmRSS"))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("strata")
    parser.add_argument("hall")
    parser.add_argument("work")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--rate", type=float, default=4.0, help="of the log, which has 5 scans a second")
    options = parser.parse_args()
    log = simulated(options.strata, one_long_day(options.hall, f"{options.work}.yaml"), options.work)
    subprocess.run([options.strata, "learn", log, "--only", "em", "--out", f"{options.work}/maps",
                    "--quiet"], check=True)
    port = free_port()
    robot = started(options.strata, COMPOSITION, options.work, port=port, rate=options.rate)
    try:
        comes_true(lambda: listens(port), "the live view listens")
        comes_true(lambda: len(children(robot.pid)) == 2, "both processes run")
        time.sleep(5)
        steady = Viewer(port)
        comes_true(lambda: steady.scans > 20, "scans come")
        steady.gaps_s.clear()
        guests, came = [], 0
        begin = time.monotonic()
        chance = random.Random(1)
        memory = []
        while (passed := time.monotonic() - begin) < 60 * options.minutes:
            guests.append(Viewer(port))
            came += 1
            if len(guests) > 8:
                guests.pop(chance.randrange(len(guests))).leave(vanish=chance.random() < 0.5)
            if passed >= 60 * len(memory):
                memory.append([resident_mb(pid) for pid in children(robot.pid)])
                print(f"{len(memory) - 1} min: {', '.join(f'{one:.1f} MB' for one in memory[-1])}; "
                      f"{came} viewers came", flush=True)
            time.sleep(1.0)
        memory.append([resident_mb(pid) for pid in children(robot.pid)])
        print(f"end: {', '.join(f'{one:.1f} MB' for one in memory[-1])}; {came} viewers came")
        gaps = sorted(steady.gaps_s)
        due = 0.2 / options.rate
        print(f"{len(gaps)} scans, one every {1e3 * due:.0f} ms: median gap {1e3 * gaps[len(gaps) // 2]:.0f} ms, "
              f"99th percentile {1e3 * gaps[int(0.99 * len(gaps))]:.0f} ms, longest {1e3 * gaps[-1]:.0f} ms; "
              f"{sum(gap > due + 0.1 for gap in gaps)} came more than 100 ms late")
    finally:
        robot.terminate()
        robot.wait()


main()
