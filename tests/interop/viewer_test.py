#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A robot's live view read by a client that others wrote (viewer_tool.mjs), over both of its protocols.

usage: viewer_test.py STRATA HALL.yaml PREPARE TOOLS WORK

Exits with 77 when Node.js is not there or its libraries cannot be had.
"""
import json
import os
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../tools/strata"))
from provoked_incidents import one_long_day  # noqa: E402
from robot_process import comes_true, free_port, listens, simulated, started  # noqa: E402

ROBOT = """version: 1
transport: loopback
processes:
  - name: robot
    executor: multi_threaded
    components:
      - {{type: strata::Player, name: player, parameters: {{log: {log}, loop: true, rate: 5.0}}}}
"""
VIEW = """      - {{type: strata::LiveView, name: live_view, parameters: {{port: {port}}}}}
"""
LOCALIZES = """      - type: strata::Localizer
        name: localizer
        parameters: {{maps: {work}/maps, model: patch, start: {{pose: [0, 0, 0]}}}}
"""
MAPS = """      - {{type: strata::ScanMatcher, name: scan_matcher, parameters: {{maps: {{publish_every_s: 0.5}}}}}}
      - {{type: strata::BeamFilter, name: beam_filter}}
      - {{type: strata::TimescaleMemory, name: memory}}
"""
# What runs, what must be read of it, and its answer when it is asked to search everywhere.
ROBOTS = (
    (LOCALIZES, ["/scan", "/odom", "/tf", "/amcl_pose", "/map_current", "/particle_cloud",
                 "/submap_states", "/localization_health", "/localizer/patch_map", "/diagnostics"], "call 1"),
    (MAPS, ["/scan", "/labeled_scan", "/map", "/node_map", "/diagnostics"],
     "refused: /reinitialize_global_localization: nobody has answered"),
)


def read_by(tools, port, protocol, names):
    told = subprocess.run(["node", f"{tools}/viewer_tool.mjs", str(port), protocol, *names],
                          stdout=subprocess.PIPE, text=True)
    assert told.stdout, "the client said nothing"
    found = json.loads(told.stdout)
    assert told.returncode == 0, found
    return found


def check(found, protocol, answer):
    assert found["protocol"] == protocol, found
    assert found["different"] == [], found["different"]
    assert found["answer"].startswith(answer), found["answer"]
    topics = found["topics"]
    kinds = {(one["encoding"], one["schemaEncoding"]) for one in topics.values()}
    assert kinds == {("cdr", "ros2msg")}, kinds
    assert topics["/scan"]["type"] == "sensor_msgs/msg/LaserScan", topics["/scan"]
    print(protocol, "read:", {name: one["count"] for name, one in topics.items()})
    print("nothing came on:", found["without"])


def main():
    strata, hall, prepare, tools, work = sys.argv[1:]
    ready = subprocess.run([prepare, tools], stdout=subprocess.PIPE, text=True)
    if ready.returncode == 3:
        print(ready.stdout)
        sys.exit(77)
    assert ready.returncode == 0, ready.stdout
    log = simulated(strata, hall, work)
    subprocess.run([strata, "learn", log, "--out", f"{work}/maps", "--quiet"], check=True)
    day = simulated(strata, one_long_day(hall, f"{work}_day.yaml"), f"{work}_day")
    for components, topics, answer in ROBOTS:
        port = free_port()
        robot = started(strata, ROBOT + components + VIEW, work, port=port, log=day)
        try:
            comes_true(lambda: listens(port), "the live view listens")
            for protocol in ("foxglove.websocket.v1", "foxglove.sdk.v1"):
                check(read_by(tools, port, protocol, topics), protocol, answer)
        finally:
            robot.kill()
            robot.wait()


main()
