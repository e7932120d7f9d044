#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a fleet's robots send, and what learning loses by sending less (docs/fleet.md).

    python3 tests/bench/fleet_bytes.py build/release/bin/strata /tmp/fleet_bytes corridor_box:301 ward_new_carts:301
    python3 tests/bench/fleet_bytes.py build/release/bin/strata /tmp/fleet_bytes --log intel.clf.gz:intel.ref.txt --parts 3
    python3 tests/bench/fleet_bytes.py build/release/bin/strata /tmp/fleet_bytes --log monday.clf tuesday.clf

Worlds of tools/simulate/scenarios by NAME:SEED, at their true poses, or one site's logs LOG or LOG:POSES (CARMEN; at
these poses). A log of a single day is cut into --parts of equal time. The first day is released as the site's version;
each further one is a robot's, learned on top of it and pushed to a PostgreSQL server in each of the ways; `fleet learn`
makes one map of them. Where poses are known the last day is not pushed: robots are localized on it.
"""
import argparse
import gzip
import json
import os
import shutil
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../components/fleet"))
from fleet_server import SITE, FleetServer, ran  # noqa: E402

SCENARIOS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../tools/simulate/scenarios")


class Site:
    def __init__(self, strata, work, first):
        """first: arguments of `learn` for the first day."""
        self.strata, self.work = strata, work
        self.run("learn", *first, "--out", f"{work}/first")
        self.run("site", "init", f"{work}/site", "--id", SITE)
        self.run("site", "take", f"{work}/site", f"{work}/first")

    def run(self, *words):
        return ran([self.strata, *words, "--quiet"])

    def learn_days(self, days):
        for number, day in enumerate(days):
            self.run("learn", *day, "--update", f"{self.work}/site/active", "--out", f"{self.work}/robot_{number}")
        return [f"{self.work}/robot_{number}" for number in range(len(days))]

    def pushed(self, way, folders, learns):
        """Bytes and metres; learns: what all learn of them lies in `together`."""
        spacing, tolerance = way
        server = FleetServer(self.strata, f"{self.work}/server")
        try:
            ada = server.add("operator", "ada")
            self.run("fleet", "release", ada, f"{self.work}/site", "active")
            size, path_m = 0, 0.0
            for number, folder in enumerate(folders):
                robot = server.add("robot", f"robot-{number}")
                told = json.loads(self.run("fleet", "push", robot, folder, "--site", SITE, "--spacing", str(spacing),
                                           "--against", f"{self.work}/site", "--tolerance", str(tolerance), "--json"))
                size, path_m = size + told["bytes"], path_m + told["path_m"]
            shutil.rmtree(f"{self.work}/together", ignore_errors=True)
            if learns:
                self.run("fleet", "learn", ada, f"{self.work}/site", "--unchecked", "--out",
                         f"{self.work}/together")
            return size, path_m
        finally:
            server.stop()

    def errors(self, day, models, seeds):
        """Of each model the mean error in metres, over seeds, and how many were lost. day: a log and its poses."""
        found = {}
        for model in models:
            means, lost = [], 0
            for seed in range(1, seeds + 1):
                told = json.loads(self.run("localize", day[0], "--truth", day[1], "--maps", f"{self.work}/together",
                                           "--model", model, "--seed", str(seed), "--force", "--out",
                                           f"{self.work}/localized", "--json"))
                means.append(told["error_m"]["mean"])
                lost += told["lost"]
            found[model] = f"{sum(means) / len(means):.4f} m" + (f" ({lost} lost)" if lost else "")
        return found


def days_of(strata, world, work):
    name, seed = world.split(":")
    ran([strata, "simulate", f"{SCENARIOS}/{name}.yaml", "--per-day", "--seed", seed, "--out", f"{work}/days", "--quiet"])
    count = sum(entry.startswith("day_") for entry in os.listdir(f"{work}/days"))
    folders = [f"{work}/days/day_{day}" for day in range(1, count + 1)]
    return [(f"{folder}/log.clf", f"{folder}/truth.tum") for folder in folders]


def parts_of(log, count, work):
    """A log by the stamps of its lines, which end in `stamp host stamp` (README of the logs: sort by the former)."""
    def opened(path):
        return gzip.open(path, "rt") if path.endswith(".gz") else open(path)

    lines, params = [], []
    with opened(log) as file:
        for line in file:
            words = line.split()
            if words and words[0] in ("FLASER", "ODOM", "ROBOTLASER1"):
                lines.append((float(words[-3]), line))
            elif words and words[0] == "PARAM":
                params.append(line)
    lines.sort(key=lambda stamped: stamped[0])
    parts = [f"{work}/part_{part + 1}.clf" for part in range(count)]
    begin, whole = lines[0][0], lines[-1][0] - lines[0][0]
    files = [open(part, "w") for part in parts]
    for file in files:
        file.writelines(params)
    for stamp, line in lines:
        files[min(count - 1, int(count * (stamp - begin) / whole))].write(line)
    for file in files:
        file.close()
    return parts


def days_of_logs(logs, parts, work):
    if len(logs) > 1:
        return [tuple(log.partition(":")[::2]) for log in logs]
    path, _, poses = logs[0].partition(":")
    return [(part, poses) for part in parts_of(path, parts, work)]


def line(what, way, size, path_m, errors):
    told = "; ".join(f"{model} {error}" for model, error in errors.items())
    print(f"{what} every {way[0]} m, within {way[1]} cells: {size / path_m:.1f} kB/km over {path_m:.0f} m {told}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("strata")
    parser.add_argument("work")
    parser.add_argument("worlds", nargs="*", metavar="NAME:SEED")
    parser.add_argument("--log", nargs="+", default=[], metavar="LOG[:POSES]", help="days of one site")
    parser.add_argument("--parts", type=int, default=2, help="of a log of one day")
    parser.add_argument("--ways", nargs="+", metavar="SPACING:CELLS", default=["0:0", "0.5:0", "0.5:0.5", "0.5:1"])
    parser.add_argument("--models", nargs="+", default=["filtered", "patch", "timescale"])
    parser.add_argument("--bytes-only", action="store_true", help="learn nothing of what is pushed")
    parser.add_argument("--seeds", type=int, default=5)
    options = parser.parse_args()
    strata = os.path.abspath(options.strata)
    for world in options.worlds or ([""] if options.log else []):
        work = f"{options.work}/{world.replace(':', '_') or 'log'}"
        shutil.rmtree(work, ignore_errors=True)
        os.makedirs(work)
        days = days_of(strata, world, work) if world else days_of_logs(options.log, options.parts, work)
        is_known = all(poses for _, poses in days) and not options.bytes_only
        taught = days[:-1] if is_known else days
        only = ["--only", "em"] if options.bytes_only else []
        learned = [[log, *(["--poses", poses] if poses else []), *only] for log, poses in taught]
        site = Site(strata, work, learned[0])
        folders = site.learn_days(learned[1:])
        for way in (tuple(float(number) for number in way.split(":")) for way in options.ways):
            size, path_m = site.pushed(way, folders, is_known)
            errors = site.errors(days[-1], options.models, options.seeds) if is_known else {}
            line(world or os.path.basename(options.log[0]), way, size, path_m, errors)


if __name__ == "__main__":
    main()
