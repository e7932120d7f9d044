#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How long it takes until all robots of a fleet know what one of them saw (docs/fleet.md).

    python3 tests/bench/fleet_spread.py build/release/bin/strata WORLD.yaml /tmp/fleet_spread [--robots 10] [--rounds 5] [--outage-s 200]

So many processes with a FleetMember, a PostgreSQL server with TLS, and beside it, again and again, what a timer of
the site does: learn, gate with a kept recording, release. In each round another robot has a day that nobody knows yet.
The clock begins when the maps with its visit are in its folder, and ends when every robot's site has a version active that
holds it. With --outage-s there was no server for so long, and the clock begins when there is one again.
"""
import argparse
import json
import os
import random
import shutil
import statistics
import subprocess
import sys
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../components/fleet"))
from fleet_server import SITE, FleetServer, ran  # noqa: E402

PATIENCE_S = 300.0
COMPOSITION = """version: 1
transport: loopback
processes:
  - name: robot
    components:
      - type: strata::FleetMember
        name: fleet_member
        parameters: {{server: '{url}', site: {site}, maps: [{home}/maps], site_folder: {home}/site, pulled: activate}}
"""


def without_password(url):
    """The URL, and the password that was in it."""
    role, rest = url.split("@", 1)
    role, _, password = role.rpartition(":")
    return f"{role}@{rest}", password


class Fleet:
    def __init__(self, strata, world, work, robots, rounds, outage_s):
        self.strata, self.work, self.outage_s = os.path.abspath(strata), work, outage_s
        shutil.rmtree(work, ignore_errors=True)
        os.makedirs(work)
        self.run("simulate", world, "--set", f"days={rounds + 2}", "--per-day", "--seed", "1", "--out", f"{work}/days")
        self.run("learn", self.log(1), "--out", f"{work}/one")
        self.run("site", "init", self.site, "--id", SITE)
        self.run("site", "take", self.site, f"{work}/one")
        self.run("site", "keep", self.site, self.log(rounds + 2))
        self.server = FleetServer(self.strata, f"{work}/server")
        self.ada = self.server.add("operator", "ada")
        self.run("fleet", "release", self.ada, self.site, "active")
        self.stops = threading.Event()
        self.urls = [self.server.add("robot", f"robot-{i}") for i in range(robots)]
        self.members = [self.member(i) for i in range(robots)]
        self.learner = threading.Thread(target=self.learn_again_and_again)

    @property
    def site(self):
        return f"{self.work}/site"

    def home(self, robot):
        return f"{self.work}/robots/{robot}"

    def log(self, day):
        return f"{self.work}/days/day_{day}/log.clf"

    def run(self, *words):
        return ran([self.strata, *words, "--quiet"])

    def member(self, robot):
        os.makedirs(self.home(robot))
        self.run("site", "init", f"{self.home(robot)}/site", "--id", SITE)
        with open(f"{self.home(robot)}/robot.yaml", "w") as out:
            url, password = without_password(self.urls[robot])
            out.write(COMPOSITION.format(url=url, site=SITE, home=self.home(robot)))
        with open(f"{self.home(robot)}/log.txt", "w") as log:
            return subprocess.Popen([self.strata, "run", f"{self.home(robot)}/robot.yaml", "--quiet"],
                                    env={**os.environ, "PGPASSWORD": password}, stdout=log, stderr=log)

    def learn_again_and_again(self):
        """As a timer, but without its pause."""
        while not self.stops.wait(1.0):
            together = f"{self.work}/together"
            shutil.rmtree(together, ignore_errors=True)
            learned = subprocess.run([self.strata, "fleet", "learn", self.ada, self.site, "--out", together, "--quiet"],
                                     capture_output=True, text=True)
            if learned.returncode == 2 and "has no visit" not in learned.stderr:
                sys.exit(f"fleet learn: {learned.stderr}")
            if learned.returncode != 0:  # nothing to learn, or no server
                continue
            self.run("site", "take", self.site, together)
            self.run("fleet", "release", self.ada, self.site, "active")

    def runs_of(self, site):
        """How many runs its active version was learned of; 0 without one."""
        listed = json.loads(ran([self.strata, "site", "list", site, "--json"]))
        return max((one["made_of"]["runs"] for one in listed if one["state"] == "active"), default=0)

    def all_know(self, runs):
        return all(self.runs_of(f"{self.home(i)}/site") >= runs for i in range(len(self.members)))

    def wait(self, runs):
        begin = time.monotonic()
        while not self.all_know(runs):
            ended = [i for i, member in enumerate(self.members) if member.poll() is not None]
            if ended:
                sys.exit(f"{self.home(ended[0])}/log.txt says why a robot ended")
            if self.learner.ident is not None and not self.learner.is_alive():
                sys.exit("whoever learns has ended")
            if time.monotonic() - begin > PATIENCE_S:
                sys.exit(f"not all robots know {runs} runs after {PATIENCE_S} s")
            time.sleep(0.2)
        return time.monotonic() - begin

    def round(self, number):
        robot = number % len(self.members)
        home = self.home(robot)
        self.run("learn", self.log(number + 2), "--update", f"{home}/site/active", "--out", f"{home}/next")
        time.sleep(random.Random(number).uniform(0.0, 20.0))  # at no particular moment
        if self.outage_s > 0.0:
            self.server.stop()
            time.sleep(self.outage_s)
        shutil.rmtree(f"{home}/maps", ignore_errors=True)
        os.rename(f"{home}/next", f"{home}/maps")
        if self.outage_s > 0.0:
            self.server.start()
        return self.wait(number + 2)

    def stop(self):
        self.stops.set()
        if self.learner.is_alive():
            self.learner.join()
        for member in self.members:
            member.terminate()
        for member in self.members:
            member.wait()
        self.server.stop()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("strata")
    parser.add_argument("world")
    parser.add_argument("work")
    parser.add_argument("--robots", type=int, default=10)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--outage-s", type=float, default=0.0, help="so long there is no server before each round")
    options = parser.parse_args()
    fleet = Fleet(options.strata, options.world, options.work, options.robots, options.rounds, options.outage_s)
    try:
        fleet.wait(1)
        fleet.learner.start()
        times = []
        for number in range(options.rounds):
            times.append(fleet.round(number))
            print(f"round {number + 1}: all {options.robots} robots after {times[-1]:.1f} s", flush=True)
        print(json.dumps({"robots": options.robots, "outage_s": options.outage_s, "median_s": statistics.median(times),
                          "longest_s": max(times)}))
    finally:
        fleet.stop()


if __name__ == "__main__":
    main()
