#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Viewers that come and go for a long time: memory of the live view, and how late scans come.

usage: live_soak.py STRATA HALL.yaml WORK [--minutes M] [--rate R] [--alone A] [--real-time]

The robot localizes in one process and the live view is another. For A minutes nobody looks. Then up to 8
viewers read every topic; every second one leaves, by closing or by vanishing, and another comes. One more viewer
stays from the first minute to the last and measures by its own clock how far scans are apart. Prints the memory
of both processes once a minute; then how late the localizer was with its scans, alone and with viewers, as its
own figures on /metrics tell, and how late the scans came to the viewer that stays.

--real-time: the robot's processes go before all others of the machine, viewers among them, as if those looked
from elsewhere.
"""
import argparse
import os
import random
import subprocess
import sys
import time
import urllib.request

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


def waited(port):
    """Scans by how long the localizer was behind, {bound in s: scans that took at most that}."""
    head = 'strata_component_latency_seconds_bucket{component="/localizer",topic="/scan",le="'
    with urllib.request.urlopen(f"http://localhost:{port}/metrics") as answer:
        lines = [line[len(head):].split('"} ') for line in answer.read().decode().splitlines()
                 if line.startswith(head)]
    return {float(bound): int(float(count)) for bound, count in lines}


def told(before, after):
    scans = {bound: after[bound] - before.get(bound, 0) for bound in sorted(after)}
    total = scans[float("inf")]
    late = {f"{1e3 * bound:g} ms": total - scans[bound] for bound in scans if 0.005 <= bound < 1e9}
    return f"{total} scans, later than " + ", ".join(f"{bound}: {n}" for bound, n in late.items())


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("strata")
    parser.add_argument("hall")
    parser.add_argument("work")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--rate", type=float, default=4.0, help="of the log, which has 5 scans a second")
    parser.add_argument("--alone", type=float, default=0.0, help="minutes without a viewer before")
    parser.add_argument("--real-time", action="store_true")
    options = parser.parse_args()
    log = simulated(options.strata, one_long_day(options.hall, f"{options.work}.yaml"), options.work)
    subprocess.run([options.strata, "learn", log, "--only", "em", "--out", f"{options.work}/maps",
                    "--quiet"], check=True)
    port = free_port()
    if options.real_time:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(10))
    robot = started(options.strata, COMPOSITION, options.work, port=port, rate=options.rate)
    if options.real_time:
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    try:
        comes_true(lambda: listens(port), "the live view listens")
        comes_true(lambda: len(children(robot.pid)) == 2, "both processes run")
        time.sleep(5)
        begun = waited(port)
        time.sleep(60 * options.alone)
        alone = waited(port)
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
        if options.alone > 0:
            print(f"alone: {told(begun, alone)}")
        print(f"with viewers: {told(alone, waited(port))}")
        gaps = sorted(steady.gaps_s)
        due = 0.2 / options.rate
        print(f"{len(gaps)} scans, one every {1e3 * due:.0f} ms: median gap {1e3 * gaps[len(gaps) // 2]:.0f} ms, "
              f"99th percentile {1e3 * gaps[int(0.99 * len(gaps))]:.0f} ms, longest {1e3 * gaps[-1]:.0f} ms; "
              f"{sum(gap > due + 0.1 for gap in gaps)} came more than 100 ms late")
    finally:
        robot.terminate()
        robot.wait()


if __name__ == "__main__":
    main()
