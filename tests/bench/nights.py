#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Nights of a site: every night a robot's day is learned and `strata site take` decides (docs/site.md).

    python3 tests/bench/nights.py build/release/bin/strata /tmp/nights [--nights 60] [--seed 1]

A hall with doors and a box that move by chance, a cabinet that is moved for good and a shelf that
comes for good. Five nights are bad: a recording of another building, a clock that was set back,
things that stand about for a day, a broken map, and a store that was half written. Prints a line a
night and, as JSON, what it comes to: releases, refusals, and whether robots of the next day do worse
in what was released than in the version before.
"""
import argparse
import json
import os
import shutil
import subprocess
import sys
import time

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
laser: {{beams: 181, field_of_view_deg: 360, rate_hz: 5, range_max_m: 10.0, noise_m: 0.015}}
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
    def __init__(self, strata, work, nights, seed):
        self.strata, self.work, self.nights, self.seed = os.path.abspath(strata), work, nights, seed
        self.site = f"{work}/site"
        self.maps = f"{work}/maps"
        step = max(2, nights // 8)
        # The middle of the time for what is moved for good, the rest for what is bad.
        self.moved, self.came = 3 * step, 5 * step
        self.bad = dict(zip((step, 2 * step, 4 * step, 6 * step, 7 * step),
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
                                    crowd=crowd(crowd_day)))
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
        update = ["--update", self.maps] if os.path.exists(self.maps) else [
            "--truth", f"{self.days}/day_{day}/truth.tum"]
        if kind == "foreign":
            self.learn(f"{self.foreign}/day_1/log.clf", out, *update)
        elif kind == "clock":
            self.learn(self.edited(day, lambda words: shift_clock(words, -4e6)), out, *update)
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
                out.write(" ".join(edit(words)) + "\n" if words and words[0] in ("FLASER", "ODOM") else line)
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
        out = self.learned(day, kind)
        begin = time.monotonic()
        done = self.run("site", "take", self.site, out, "--quiet", refused_with=2)
        took_s = time.monotonic() - begin
        is_taken = self.active() != before
        if kind not in ("foreign", "clock", "broken"):
            self.run("site", "keep", self.site, self.log(day), "--max-mb", "20", "--quiet")
        result = {"night": day, "bad": kind, "taken": is_taken, "take_s": round(took_s, 2),
                  "why": done.stderr.strip().split("\n")[-1][:160] if done.returncode else ""}
        result["error_m"], result["lost"] = self.error_tomorrow(day + 1, f"{self.site}/active")
        if is_taken and maps_before:
            result["before_m"], result["before_lost"] = self.error_tomorrow(day + 1, maps_before)
        if is_taken:
            shutil.rmtree(self.maps, ignore_errors=True)
            os.rename(out, self.maps)
        self.run("site", "gc", self.site, "--quiet")
        return result


def shift_clock(words, seconds):
    return words[:-3] + [f"{float(words[-3]) + seconds:.6f}", words[-2], f"{float(words[-1]) + seconds:.6f}"]


def shorten(words):
    """Ranges of a metre at most, which hold no map together."""
    if words[0] != "FLASER":
        return words
    count = int(words[1])
    ranges = [f"{min(float(word), 1.0):.3f}" for word in words[2:2 + count]]
    return words[:2] + ranges + words[2 + count:]


def summary(results, nights):
    taken = [one for one in results if one["taken"]]
    worse = [one["night"] for one in taken if "before_m" in one and
             (one["error_m"] > one["before_m"] + 0.02 or (one["lost"] and not one["before_lost"]))]

    def delay(day):
        return next((one["night"] - day for one in taken if one["night"] >= day), None)

    return {"nights": len(results), "releases": len(taken),
            "bad_nights_released": [one["night"] for one in taken if one["bad"]],
            "releases_in_which_the_next_day_is_worse": worse,
            "good_nights_refused": [one["night"] for one in results if not one["bad"] and not one["taken"]],
            "nights_until_the_moved_cabinet": delay(nights.moved),
            "nights_until_the_new_shelf": delay(nights.came),
            "mean_error_m": round(sum(one["error_m"] for one in results) / len(results), 4),
            "days_lost": sum(one["lost"] for one in results),
            "longest_take_s": max(one["take_s"] for one in results)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("strata")
    parser.add_argument("work")
    parser.add_argument("--nights", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    nights = Nights(options.strata, options.work, options.nights, options.seed)
    nights.begin()
    results = []
    for day in range(1, options.nights + 1):
        results.append(nights.night(day))
        print(json.dumps(results[-1]), flush=True)
    print(json.dumps(summary(results, nights), indent=2))


if __name__ == "__main__":
    main()
