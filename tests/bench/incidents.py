#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Provokes incidents of every kind at many moments, and has each replayed.

usage: incidents.py STRATA HALL.yaml WORK [--count N]

A line an incident: what was provoked, why it was kept, and how many poses came out to the same
bits. At the end how many were kept, and how many of those were replayed to the same bits whole.
"""
import argparse
import os
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../tools/strata"))
from provoked_incidents import KINDS, incidents_in, one_long_day, provoke, replayed  # noqa: E402
from robot_process import simulated, started  # noqa: E402

PATIENCE_S = 60
RATE = 6.0
COMPOSITION = """version: 1
transport: loopback
processes:
  - name: robot
    executor: multi_threaded
    components:
      - {{type: strata::Player, name: player, parameters: {{log: {log}, rate: {rate}}}}}
      - type: strata::Localizer
        name: localizer
        parameters:
          maps: {work}/maps
          model: {model}
          start: {{pose: [0, 0, 0]}}
          restore_point_s: 3.0
          localizer: {{recovery: {{inject: true, restart_after: 5}}, global_search: {{is_used: {search}}}}}
      - type: strata::IncidentRecorder
        name: incidents
        parameters:
          out: {work}/incidents_{number}
          before_s: 10.0
          after_s: 1.5
          when: {{score_below: 0.4}}
"""


def one(strata, work, number):
    """What was provoked, the incident (none: nothing was kept) and what its replay found."""
    kind = KINDS[number % len(KINDS)]
    model = ("patch", "filtered", "occupancy")[number // len(KINDS) % 3]
    search = "true" if number // 9 % 2 else "false"
    at = 15.0 + 1.1 * (number // len(KINDS)) % 40.0
    provoke(kind, f"{work}/world/log.clf", f"{work}/provoked.clf", at=at, until=at + 30.0)
    robot = started(strata, COMPOSITION, work, log=f"{work}/provoked.clf", rate=RATE, model=model,
                    search=search, number=number)
    incident = None
    until = time.monotonic() + PATIENCE_S
    while incident is None and time.monotonic() < until:
        time.sleep(0.3)
        incident = next((one for one in incidents_in(strata, f"{work}/incidents_{number}")
                         if one["complete"]), None)
    robot.terminate()
    robot.wait()
    what = f"{kind} at {at:.0f} s, {model}" + (", global search" if search == "true" else "")
    if incident is None:
        return what, None, {}
    found, _, said = replayed(strata, incident["folder"], f"{work}/replayed")
    return what, incident, found or {"said": said}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("strata")
    parser.add_argument("hall")
    parser.add_argument("work")
    parser.add_argument("--count", type=int, default=100)
    options = parser.parse_args()
    log = simulated(options.strata, one_long_day(options.hall, f"{options.work}.yaml"), options.work)
    subprocess.run([options.strata, "learn", log, "--out", f"{options.work}/maps", "--quiet"], check=True)
    kept = same = poses = 0
    for number in range(options.count):
        what, incident, found = one(options.strata, options.work, number)
        kept += incident is not None
        is_same = bool(found.get("replayed")) and found["same"] == found["replayed"] \
            and found["states_same"] == found["states_compared"]
        same += is_same
        poses += found.get("same", 0)
        why = incident["reasons"][0]["kind"] if incident else "NOT KEPT"
        print(f"{number + 1}: {what}: {why}: {found}", flush=True)
    print(f"{options.count} provoked, {kept} kept, {same} replayed to the same bits whole, {poses} poses")


main()
