#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What an incident recorder costs, with a scanner of 1,080 beams at 10 Hz.

usage: recorder_cost.py STRATA HALL.yaml WORK

The robot localizes in one process; a recorder keeps every topic, in a process of its own or in the robot's, and
no incident comes. Prints the CPU time of the processes, in turn without and with a recorder, since a localizer that
is recorded writes a journal for it.
"""
import os
import statistics
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "../tools/strata"))
from live_view import make_world  # noqa: E402
from live_soak import children  # noqa: E402
from robot_process import comes_true, started  # noqa: E402

SETTLE_S = 15.0
MEASURED_S = 30.0
TURNS = 3
ROBOT = """version: 1
transport: loopback
processes:
  - name: robot
    executor: multi_threaded
    components:
      - {{type: strata::Player, name: player, parameters: {{log: {work}/world/log.clf, loop: true}}}}
      - type: strata::Localizer
        name: localizer
        parameters: {{maps: {work}/maps, model: filtered, start: {{pose: [0, 0, 0]}}}}
"""
PROCESS = """  - name: recorder
    components:
"""
RECORDER = """      - type: strata::IncidentRecorder
        name: incidents
        parameters: {{out: {work}/incidents, when: {{on_recovery: false, on_lost: false, on_outdated: false, on_error: false, score_below: 0.0}}}}
"""


def cpu_s(pid):
    with open(f"/proc/{pid}/stat") as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def all_of(robot):
    return children(robot.pid) or [robot.pid]


def shares(strata, work, composition, processes):
    """CPU time of each process, in percent of a core."""
    robot = started(strata, composition, work)
    try:
        comes_true(lambda: len(all_of(robot)) == processes, "all processes run")
        time.sleep(SETTLE_S)
        pids = all_of(robot)
        before, begin = [cpu_s(pid) for pid in pids], time.monotonic()
        time.sleep(MEASURED_S)
        passed = time.monotonic() - begin
        return [100 * (cpu_s(pid) - one) / passed for pid, one in zip(pids, before)]
    finally:
        robot.terminate()
        robot.wait()


def told(when, alone, recorded, recorder, together):
    print(f"{when}: robot {alone:.2f}% of a core alone, {recorded:.2f}% recorded; recorder {recorder:.2f}%; "
          f"both in one process {together:.2f}%", flush=True)


def main():
    strata, hall, work = sys.argv[1:]
    make_world(strata, hall, work)
    alone, recorded, recorder, together = [], [], [], []
    for turn in range(TURNS):
        alone += shares(strata, work, ROBOT, 1)
        both = shares(strata, work, ROBOT + PROCESS + RECORDER, 2)
        recorded.append(both[0])
        recorder.append(both[1])
        together += shares(strata, work, ROBOT + RECORDER, 1)
        told(f"turn {turn + 1}", alone[-1], *both, together[-1])
    told("in the median", *map(statistics.median, (alone, recorded, recorder, together)))


if __name__ == "__main__":
    main()
