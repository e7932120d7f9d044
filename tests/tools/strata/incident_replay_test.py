#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Something goes wrong with a robot that runs; its incident gives the same poses again, to the bit.

usage: incident_replay_test.py KIND STRATA HALL.yaml WORK

KIND: kidnapping, changed_rooms or killed_scanner; learning: a kidnapping with a model that learns while
it localizes; topics: one in a map that comes over a topic.
"""
import os
import shutil
import subprocess
import sys

from provoked_incidents import KINDS, incidents_in, one_long_day, provoke, replayed
from robot_process import comes_true, simulated, started

COMPOSITION = """version: 1
transport: loopback
processes:
  - name: robot
    executor: multi_threaded
    components:
      - {{type: strata::Player, name: player, parameters: {{log: {log}, rate: 3.0}}}}
{others}      - type: strata::Localizer
        name: localizer
        parameters:
          maps: {maps}
          model: {model}
          start: {{pose: {start}}}
          restore_point_s: 3.0
          localizer: {{recovery: {{inject: true, restart_after: 5}}}}
      - type: strata::IncidentRecorder
        name: incidents
        parameters:
          out: {work}/incidents
          before_s: 12.0
          after_s: 2.0
          when: {{score_below: 0.4}}
"""
MAP_SERVER = "      - {{type: strata::MapServer, name: map_server, parameters: {{map: {work}/maps/occupancy.yaml}}}}\n"
# Where the maps come from, and the model.
WAYS = {"learning": {"model": "timescale"}, "topics": {"model": "occupancy", "maps": "''", "others": MAP_SERVER}}


def test(kind, strata, hall, work):
    log = simulated(strata, one_long_day(hall, f"{work}.yaml"), work)
    subprocess.run([strata, "learn", log, "--out", f"{work}/maps", "--quiet"], check=True)
    way = {"model": "patch", "maps": "{work}/maps", "others": "", **WAYS.get(kind, {})}
    provoke("kidnapping" if kind in WAYS else kind, log, f"{work}/provoked.clf", at=30.0, until=70.0)
    robot = started(strata, COMPOSITION, work, log=f"{work}/provoked.clf", start="[0, 0, 0]",
                    **{name: text.format(work=work) for name, text in way.items()})
    try:
        incidents = comes_true(lambda: [one for one in incidents_in(strata, f"{work}/incidents")
                                        if one["complete"]], f"an incident of {kind} is kept")
    finally:
        robot.terminate()
        robot.wait()
    incident = incidents[0]
    assert not incident["lost"], incident
    shutil.rmtree(f"{work}/maps")  # the copy in the incident has to do
    for how in ("incidents replay", "replay"):
        out = f"{work}/{how.replace(' ', '_')}"
        run = subprocess.run([strata, *how.split(), incident["folder"], "--out", out],
                             capture_output=True, text=True)
        assert run.returncode == 0, run.stdout + run.stderr
        assert "to the same bits" in run.stdout, run.stdout
        with open(f"{out}/localizer/trajectory.tum") as poses:
            assert len(poses.readlines()) > 10
    found, code, said = replayed(strata, incident["folder"], f"{work}/again")
    assert code == 0, said
    assert found["same"] == found["replayed"] > 10, found
    # The filter, too, came to where it was: at every restore point but the first.
    assert found["states_same"] == found["states_compared"] > 0, found
    # At most what comes before the first restore point is left out.
    assert found["scans"] - found["replayed"] <= 3.0 * 5 + 1, found
    print(f"{kind}: {incident['reasons'][0]['text']}: {found}")


def test_refusals(strata, work):
    """Maps that are no longer those, and no incident."""
    files = f"{work}/incidents/files"
    shutil.rmtree(files)
    incident = incidents_in(strata, f"{work}/incidents")[0]["folder"]
    run = subprocess.run([strata, "incidents", "replay", incident], capture_output=True, text=True)
    assert run.returncode == 2 and "--maps" in run.stderr, run.stderr
    os.makedirs(f"{work}/empty")
    run = subprocess.run([strata, "incidents", "replay", f"{work}/empty"], capture_output=True,
                         text=True)
    assert run.returncode == 2 and "is no incident" in run.stderr, run.stderr


def main():
    kind, strata, hall, work = sys.argv[1:5]
    assert kind in (*KINDS, *WAYS), kind
    test(kind, strata, hall, work)
    if kind != "topics":  # needs no folder
        test_refusals(strata, work)
    shutil.rmtree(work)


main()
