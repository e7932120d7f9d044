#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Nights of a site: every night a robot's day is learned and `strata site take` decides (docs/site.md).

    python3 tests/bench/nights.py build/release/bin/strata /tmp/nights [--nights 60] [--seed 1] [--rate-hz 5] [--beams 181]

A hall with doors and a box that move by chance, a cabinet that is moved for good and a shelf that
comes for good. Six nights are bad: a recording of a hall that is like it, a clock that was set back,
odometry that goes astray, things that stand about for a day, a broken map, and a store that was half written. Prints a line a
night and, as JSON, what it comes to: releases, refusals, whether robots of the next day do worse in
what was released than in the version before, after how many nights the released maps show what moved
for good, how far their frame moved, and what a night costs. At the end what is active is corrupted in
fifty ways, and the site goes back by a version.
"""
import argparse
import json
import math
import os
import random
import shutil
import subprocess
import sys
import time

from nights_measures import PLACES, contents, moved, moved_back, poses, read_map, rigid, summary

WORLD = """version: 1
name: {name}
days: {days}
night_s: 36000.0
walls:
  - points: [0, 0, {width}, 0, {width}, 8, 0, 8, 0, 0]
  - points: [0, 3.2, 2.2, 3.2]
  - points: [3.2, 3.2, 7.0, 3.2]
  - points: [8.0, 3.2, {width}, 3.2]
  - points: [5.0, 0, 5.0, 3.2]
blocks:
  - {{rect: [0.2, 6.9, 1.6, 7.8]}}
  - {{rect: [{pillar}, 5.8, {pillar_end}, 6.2]}}
  - {{rect: [9.2, 0.2, 10.6, 0.9]}}
doors:
  - {{id: west, at: [2.2, 3.2, 3.2, 3.2], open_deg: -90, states: {{probabilities: [0.5, 0.0, 0.5]}}}}
  - {{id: east, at: [8.0, 3.2, 7.0, 3.2], open_deg: 90, states: {{probabilities: [0.3, 0.0, 0.7]}}}}
boxes:
  - id: box
    places: [{{name: a, x_m: 2.6, y_m: 7.5}}, {{name: b, x_m: 5.2, y_m: 7.5}}]
  - id: cabinet
    length_m: 1.2
    places: [{{name: old, x_m: 8.6, y_m: 7.6}}, {{name: new, x_m: 10.9, y_m: 5.6, theta_deg: 90}}]
    states: {{schedule: [{{day: 1, state: old}}, {{day: {moved}, state: new}}]}}
  - id: shelf
    length_m: 1.6
    width_m: 0.4
    places: [{{name: here, x_m: 6.0, y_m: 4.4}}]
    states: {{schedule: [{{day: 1, state: absent}}, {{day: {came}, state: here}}]}}
{crowd}robot:
  route: [1.0, 5.2, 9.6, 5.2, 9.6, 6.8, 6.4, 6.8, 3.8, 6.4, 1.0, 5.6]
  speed_mps: 0.6
laser: {{beams: {beams}, field_of_view_deg: 360, rate_hz: {rate_hz}, range_max_m: 10.0, noise_m: 0.015}}
"""


def crowd(day):
    """Things as large as people that stand about on one day."""
    places = [(3.0, 4.6), (4.4, 6.9), (7.6, 5.9), (2.0, 6.0), (8.6, 4.2)]
    text = ""
    for number, (x, y) in enumerate(places):
        text += (f"  - {{id: stander_{number}, length_m: 0.35, width_m: 0.35, "
                 f"places: [{{name: here, x_m: {x}, y_m: {y}}}], states: {{schedule: "
                 f"[{{day: 1, state: absent}}, {{day: {day}, state: here}}, {{day: {day + 1}, state: absent}}]}}}}\n")
    return text


class Nights:
    def __init__(self, strata, work, nights, seed, rate_hz, beams):
        self.strata, self.work, self.nights, self.seed = os.path.abspath(strata), work, nights, seed
        self.rate_hz, self.beams, self.frame = rate_hz, beams, None
        self.site = f"{work}/site"
        step = max(2, nights // 8)
        # The middle of the time for what is moved for good, the rest for what is bad.
        self.moved, self.came = 3 * step, 5 * step
        self.bad = {2 * step + step // 2: "lost"} | dict(zip((step, 2 * step, 4 * step, 6 * step, 7 * step),
                            ("foreign", "clock", "crowd", "broken", "half")))

    def run(self, *words, refused_with=None):
        done = subprocess.run([self.strata, *words], capture_output=True, text=True)
        if done.returncode not in (0, refused_with):
            sys.exit(f"strata {' '.join(words)}: {done.stderr}")
        return done

    def simulate(self, name, days, crowd_day, width=12.0, pillar=7.0):
        folder = f"{self.work}/{name}"
        with open(f"{self.work}/{name}.yaml", "w") as file:
            file.write(WORLD.format(name=name, days=days, width=width, pillar=pillar,
                                    pillar_end=pillar + 0.4, moved=self.moved, came=self.came,
                                    crowd=crowd(crowd_day), rate_hz=self.rate_hz, beams=self.beams))
        self.run("simulate", f"{self.work}/{name}.yaml", "--seed", str(self.seed), "--per-day", "--quiet",
                 "--out", folder)
        return folder

    def begin(self):
        shutil.rmtree(self.work, ignore_errors=True)
        os.makedirs(self.work)
        crowd_day = next(day for day, kind in self.bad.items() if kind == "crowd")
        self.days = self.simulate("hall", self.nights + 1, crowd_day)
        self.foreign = self.simulate("other", 2, 1, width=13.5, pillar=3.4)
        self.run("site", "init", self.site, "--id", "hall", "--quiet")

    def log(self, day):
        return f"{self.days}/day_{day}/log.clf"

    def learn(self, log, out, *more):
        shutil.rmtree(out, ignore_errors=True)
        self.run("learn", log, "--out", out, "--quiet", "--seed", "1", *more)

    def learned(self, day, kind):
        """What was learned of a day, as its night has it."""
        out = f"{self.work}/next"
        update = ["--update", f"{self.site}/active", "--force"] if self.active() else [
            "--truth", f"{self.days}/day_{day}/truth.tum"]
        if kind == "foreign":
            self.learn(f"{self.foreign}/day_1/log.clf", out, *update)
        elif kind == "clock":
            self.learn(self.edited(day, lambda words: shift_clock(words, -4e6)), out, *update)
        elif kind == "lost":
            self.learn(self.edited(day, Astray(self.seed)), out, *update)
        elif kind == "broken":
            self.learn(self.edited(day, shorten), out, "--set", "slam.closure.enabled=false", "--set",
                       "slam.em.track_again=false", "--only", "em", "--no-odometry")
        else:
            self.learn(self.log(day), out, *update)
        if kind == "half":
            with open(f"{out}/strata.db", "r+b") as store:
                store.truncate(os.path.getsize(f"{out}/strata.db") // 2)
        return out

    def edited(self, day, edit):
        path = f"{self.work}/edited.clf"
        with open(self.log(day)) as source, open(path, "w") as out:
            for line in source:
                words = line.split()
                out.write(" ".join(edit(words)) + "\n" if words and words[0] == "ROBOTLASER1" else line)
        return path

    def error_tomorrow(self, day, maps):
        out = f"{self.work}/localized"
        shutil.rmtree(out, ignore_errors=True)
        self.run("localize", self.log(day), "--maps", maps, "--model", "patch", "--truth",
                 f"{self.days}/day_{day}/truth.tum", "--out", out, "--quiet", "--seed", "1")
        with open(f"{out}/metrics.json") as file:
            metrics = json.load(file)
        return metrics["error_m"]["mean"], metrics["lost"]

    def active(self):
        status = json.loads(self.run("site", "status", self.site, "--json").stdout)
        return status["active"]["mapHash"] if status["active"] else None

    def night(self, day):
        kind = self.bad.get(day, "")
        before = self.active()
        maps_before = os.path.realpath(f"{self.site}/active") if before else None
        begin = time.monotonic()
        out = self.learned(day, kind)
        learn_s = time.monotonic() - begin
        begin = time.monotonic()
        done = self.run("site", "take", self.site, out, "--quiet", refused_with=2)
        took_s = time.monotonic() - begin
        is_taken = self.active() != before
        if kind not in ("foreign", "clock", "lost", "broken"):
            self.run("site", "keep", self.site, self.log(day), "--max-mb", "20", "--quiet")
        result = {"night": day, "bad": kind, "taken": is_taken, "take_s": round(took_s, 2),
                  "why": done.stderr.strip().split("\n")[-1][:160] if done.returncode else ""}
        result["error_m"], result["lost"] = self.error_tomorrow(day + 1, f"{self.site}/active")
        if is_taken and maps_before:
            result["before_m"], result["before_lost"] = self.error_tomorrow(day + 1, maps_before)
        result["learn_s"] = round(learn_s, 2)
        result["store_mb"] = round(os.path.getsize(f"{self.site}/active/strata.db") / 1e6, 3)
        if not kind or kind == "crowd":
            result.update(self.frame_of(day, out))
        if self.frame:
            result["shows"] = self.shown()
        self.run("site", "gc", self.site, "--quiet")
        return result


    def frame_of(self, day, maps):
        """How far the frame lies from the first night's, at the hall's middle, and turned."""
        truth = poses(f"{self.days}/day_{day}/truth.tum")
        learned = poses(f"{maps}/trajectory.tum")
        pairs = [(truth[stamp], learned[stamp]) for stamp in truth if stamp in learned]
        frame = rigid(pairs)
        self.frame = self.frame or frame
        middle = (6.0, 4.0)
        here, first = moved(frame, middle), moved(self.frame, middle)
        return {"frame_moved_m": round(math.dist(here, first), 4),
                "frame_turned_deg": round(math.degrees(frame[0] - self.frame[0]), 3)}

    def shown(self):
        """Obstacle cells of the active patch map, as is likeliest, where things stand or stood."""
        shape, resolution, origin, cells = read_map(f"{self.site}/active/patches.yaml")
        count = {}
        for name, (x0, y0, x1, y1) in PLACES.items():
            count[name] = 0
            for row in range(shape[1]):
                for column in range(shape[0]):
                    place = (origin[0] + (column + 0.5) * resolution,
                             origin[1] + (shape[1] - row - 0.5) * resolution)
                    x, y = moved_back(self.frame, place)
                    if cells[row * shape[0] + column] < 90 and x0 <= x <= x1 and y0 <= y <= y1:
                        count[name] += 1
        return count

    def end(self):
        """Fifty corrupted candidates: how many are taken, and how many more have the same content, since
        the bytes that were hit hold none. How long going back lasts."""
        source, broken = os.path.realpath(f"{self.site}/active"), f"{self.work}/broken"
        chance, taken, same, whole = random.Random(self.seed), 0, 0, contents(f"{source}/strata.db")
        corrupted = 0
        while corrupted < 50:
            shutil.rmtree(broken, ignore_errors=True)
            shutil.copytree(source, broken)
            with open(f"{broken}/strata.db", "r+b") as store:
                size = os.path.getsize(store.name)
                if chance.random() < 0.3:
                    store.truncate(chance.randrange(size))
                else:
                    for _ in range(chance.choice((1, 20))):
                        store.seek(chance.randrange(size))
                        store.write(chance.randbytes(chance.choice((64, 4096))))
            if contents(f"{broken}/strata.db") == whole:
                same += 1
                continue
            corrupted += 1
            before = self.active()
            subprocess.run([self.strata, "site", "take", self.site, broken, "--quiet"], capture_output=True)
            taken += self.active() != before
        begin = time.monotonic()
        self.run("site", "rollback", self.site, "--quiet")
        return {"corrupted_taken_of_50": taken, "hit_without_effect": same, "rollback_s": round(time.monotonic() - begin, 3)}


def shift_clock(words, seconds):
    """Of a ROBOTLASER1 line: its stamp, and the logger's."""
    return words[:-3] + [f"{float(words[-3]) + seconds:.6f}", words[-2], f"{float(words[-1]) + seconds:.6f}"]


class Astray:
    """Odometry that goes anywhere, as of a robot that slips and is carried about."""

    def __init__(self, seed):
        self.chance, self.pose = random.Random(seed), [0.0, 0.0, 0.0]

    def __call__(self, words):
        count = int(words[8])
        at = 9 + count + 1 + int(words[9 + count])  # behind ranges and remissions: laser, then robot
        self.pose = [value + self.chance.gauss(0.0, 0.4) for value in self.pose]
        for place in (at, at + 3):
            words[place:place + 3] = [f"{value:.6f}" for value in self.pose]
        return words


def shorten(words):
    """Ranges of a metre at most, which hold no map together."""
    count = int(words[8])
    ranges = [f"{min(float(word), 1.0):.3f}" for word in words[9:9 + count]]
    return words[:9] + ranges + words[9 + count:]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("strata")
    parser.add_argument("work")
    parser.add_argument("--nights", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rate-hz", type=float, default=5.0)
    parser.add_argument("--beams", type=int, default=181)
    options = parser.parse_args()
    nights = Nights(options.strata, options.work, options.nights, options.seed, options.rate_hz,
                    options.beams)
    nights.begin()
    results = []
    for day in range(1, options.nights + 1):
        results.append(nights.night(day))
        print(json.dumps(results[-1]), flush=True)
    print(json.dumps(summary(results, nights) | nights.end(), indent=2))


if __name__ == "__main__":
    main()
