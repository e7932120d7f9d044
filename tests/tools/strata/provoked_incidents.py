# SPDX-License-Identifier: Apache-2.0
"""Logs in which something goes wrong: a robot that is carried away, rooms that change, a scanner
that dies. Made of a CARMEN log that `strata simulate` wrote."""
import json
import math
import os
import subprocess

KINDS = ("kidnapping", "changed_rooms", "killed_scanner")


class Scan:
    """A ROBOTLASER1 line: ranges, pose of the laser, odometry, stamp."""

    def __init__(self, line):
        words = line.split()
        end = 9 + int(words[8])
        self.head, self.ranges = words[:9], [float(word) for word in words[9:end]]
        self.laser = [float(word) for word in words[end + 1:end + 4]]  # behind remissions: none
        self.odometry = [float(word) for word in words[end + 4:end + 7]]
        self.limits = words[end + 7:end + 12]
        self.stamp, self.host = float(words[end + 12]), words[end + 13]

    def line(self):
        numbers = [f"{one:.9f}" for one in self.ranges], [f"{one:.9f}" for one in
                                                          self.laser + self.odometry]
        return " ".join([*self.head, *numbers[0], "0", *numbers[1], *self.limits,
                         f"{self.stamp:.6f}", self.host, f"{self.stamp:.6f}"]) + "\n"


def one_long_day(hall, out):
    """The scenario of a hall with several days as one day, in which the robot goes round four times."""
    with open(hall) as scenario:
        lines = scenario.read().replace("days: 5", "days: 1").split("\n")
    for i, line in enumerate(lines):
        if line.strip().startswith("route: ["):
            head, places = line.split("[")
            lines[i] = f"{head}[{', '.join([places.split(']')[0]] * 4)}]"
    with open(out, "w") as scenario:
        scenario.write("\n".join(line for line in lines if "{day: " not in line or "{day: 1" in line))
    return out


def read_log(path):
    """Lines before the first scan, and the scans."""
    head, scans = [], []
    with open(path) as lines:
        for line in lines:
            if line.startswith("ROBOTLASER1"):
                scans.append(Scan(line))
            elif not scans:
                head.append(line)
    return head, scans


def compose(a, b):
    c, s = math.cos(a[2]), math.sin(a[2])
    return [a[0] + c * b[0] - s * b[1], a[1] + s * b[0] + c * b[1], a[2] + b[2]]


def inverse(a):
    c, s = math.cos(a[2]), math.sin(a[2])
    return [-c * a[0] - s * a[1], s * a[0] - c * a[1], -a[2]]


def carried_away(scans, at, away_s):
    """What was driven for `away_s` seconds after `at` is left out: odometry felt nothing of it."""
    before = [scan for scan in scans if scan.stamp <= at]
    after = [scan for scan in scans if scan.stamp > at + away_s]
    for attribute in ("laser", "odometry"):
        now_from_then = compose(getattr(before[-1], attribute),
                                inverse(getattr(after[0], attribute)))
        for scan in after:
            setattr(scan, attribute, compose(now_from_then, getattr(scan, attribute)))
    for scan in after:
        scan.stamp -= away_s
    return before + after


def changed(scans, at):
    """From then on walls stand closer on one side, and others are gone."""
    for scan in scans:
        if scan.stamp <= at:
            continue
        count = len(scan.ranges)
        scan.ranges = [one * 0.5 if 3 * i < count else min(one * 2.0, 7.9) if 3 * i < 2 * count
                       else one for i, one in enumerate(scan.ranges)]
    return scans


def provoke(kind, log, out, at, until):
    """Writes a log in which that happens `at` seconds after its beginning, and which ends at
    `until`."""
    head, scans = read_log(log)
    begin = scans[0].stamp
    if kind == "kidnapping":
        scans = carried_away(scans, begin + at, 6.0)
    elif kind == "changed_rooms":
        scans = changed(scans, begin + at)
    else:
        assert kind == "killed_scanner", kind
        scans = [scan for scan in scans if scan.stamp <= begin + at]
    with open(out, "w") as lines:
        lines.writelines(head)
        lines.writelines(scan.line() for scan in scans if scan.stamp <= begin + until)


def incidents_in(strata, folder):
    """What `strata incidents --json` lists; none while there is no folder."""
    if not os.path.isdir(folder):
        return []
    listed = subprocess.run([strata, "incidents", folder, "--json"], capture_output=True,
                            text=True, check=True)
    return json.loads(listed.stdout)


def replayed(strata, incident, out):
    """What the replay of an incident found of its localizer, its exit status and what it said."""
    run = subprocess.run([strata, "incidents", "replay", incident, "--out", out, "--force"],
                         capture_output=True, text=True)
    try:
        with open(f"{out}/summary.json") as summary:
            found = json.load(summary)["localizers"]["/localizer"]
    except OSError:
        found = {}
    return found, run.returncode, run.stdout + run.stderr
