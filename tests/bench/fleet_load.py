#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a fleet costs its server (docs/fleet.md).

    python3 tests/bench/fleet_load.py build/release/bin/strata WORLD.yaml /tmp/fleet_load [--robots 10 100 1000]

A PostgreSQL server with TLS gets so many robots, each a role of its own. Every robot pushes one visit, pulls a
version, and then asks twice for another one without news, as a FleetMember does once a minute. Prints the server's CPU time of each of
these and what they add on disk, and what a day and a year of them come to. Robots are programs beside the
server on this machine; their own CPU time does not count.
"""
import argparse
import json
import os
import shutil
import sys
import time
from concurrent.futures import ThreadPoolExecutor

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../components/fleet"))
from fleet_server import SITE, FleetServer, ran  # noqa: E402

AT_ONCE = 4
POLLS = 2
VISITS_A_DAY, RELEASES_A_DAY, POLLS_A_DAY = 8, 1, 24 * 60


def learned(strata, world, work):
    """A site with one version, and a folder of maps with one visit more."""
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    ran([strata, "simulate", world, "--set", "days=2", "--per-day", "--seed", "1", "--out", f"{work}/days", "--quiet"])
    ran([strata, "learn", f"{work}/days/day_1/log.clf", "--out", f"{work}/one", "--quiet"])
    ran([strata, "site", "init", f"{work}/site", "--id", SITE])
    ran([strata, "site", "take", f"{work}/site", f"{work}/one"])
    ran([strata, "learn", f"{work}/days/day_2/log.clf", "--update", f"{work}/one", "--out", f"{work}/two", "--quiet"])


class Load:
    def __init__(self, strata, work, server):
        self.strata, self.work, self.server = strata, work, server

    def pull(self, robot, url):
        site = f"{self.work}/robots/{robot}"
        if not os.path.exists(site):
            ran([self.strata, "site", "init", site, "--id", SITE])
        self.server.fleet("pull", url, site, "--activate")

    def push(self, robot, url):
        self.server.fleet("push", url, f"{self.work}/two", "--site", SITE)

    def poll(self, robot, url):
        for _ in range(POLLS):
            self.pull(robot, url)

    def of(self, job, robots):
        """The server's CPU seconds, bytes on disk and the wall clock, of all robots."""
        cpu, size, begin = self.server.cpu_s(), self.server.database_bytes(), time.monotonic()
        with ThreadPoolExecutor(AT_ONCE) as pool:
            list(pool.map(lambda robot: job(*robot), robots.items()))
        time.sleep(1.0)  # processes of the last connections end
        return self.server.cpu_s() - cpu, self.server.database_bytes() - size, time.monotonic() - begin


def measured(strata, work, count):
    shutil.rmtree(f"{work}/robots", ignore_errors=True)
    os.makedirs(f"{work}/robots")
    server = FleetServer(strata, f"{work}/server")
    try:
        ada = server.add("operator", "ada")
        server.fleet("release", ada, f"{work}/site", "active")
        robots = {f"robot-{i}": server.add("robot", f"robot-{i}") for i in range(count)}
        load = Load(strata, work, server)
        pulls, pushes, polls = (load.of(job, robots) for job in (load.pull, load.push, load.poll))
        visit = json.loads(server.sql("SELECT json_build_object('bytes', avg(bytes), 'path_m', avg(path_m), 'count', "
                                      "count(*)) FROM strata.visit"))
        version = int(server.sql("SELECT sum(octet_length(payload)) FROM strata.version_file"))
    finally:
        server.stop()
    assert visit["count"] == count, visit
    a_poll = polls[0] / count / POLLS
    day = count * (VISITS_A_DAY * pushes[0] / count + RELEASES_A_DAY * pulls[0] / count + POLLS_A_DAY * a_poll)
    return {"robots": count, "push_ms": 1000 * pushes[0] / count, "pull_ms": 1000 * pulls[0] / count,
            "poll_ms": 1000 * a_poll, "visit_kb": visit["bytes"] / 1000, "visit_m": visit["path_m"],
            "disk_a_visit_kb": pushes[1] / count / 1000, "version_kb": version / 1000,
            "cpu_share_of_a_core": day / 86400,
            "disk_mb_a_km": pushes[1] / count / 1e3 / visit["path_m"],
            "wall_s": {"pull": pulls[2], "push": pushes[2], "poll": polls[2]}}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("strata")
    parser.add_argument("world")
    parser.add_argument("work")
    parser.add_argument("--robots", type=int, nargs="+", default=[10, 100, 1000])
    options = parser.parse_args()
    learned(options.strata, options.world, options.work)
    for count in options.robots:
        print(json.dumps(measured(options.strata, options.work, count)), flush=True)


if __name__ == "__main__":
    main()
