#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What learning loses when a fleet's robots send a scan every so far only (docs/fleet.md).

    python3 tests/bench/spaced_visits.py build/release/bin/strata /tmp/spaced corridor_box:301 ward_new_carts:301

Worlds of tools/simulate/scenarios by NAME:SEED. All days but the last are thinned as `strata fleet push
--spacing` does, by odometry, and learned at their true poses; robots are localized on the whole last
day. Prints the mean error and the lost runs of each model.
"""
import argparse
import json
import math
import os
import subprocess

SCENARIOS = os.path.join(os.path.dirname(__file__), "../../tools/simulate/scenarios")
STANDS_S = 10.0


def thin(source, out, spacing):
    """Keeps the ROBOTLASER1 lines that are as far, turned or late; radians and metres alike."""
    last, lines = None, 0
    with open(source) as file, open(out, "w") as kept:
        for line in file:
            words = line.split()
            if words and words[0] == "ROBOTLASER1":
                at = 9 + int(words[8])
                at += 1 + int(words[at]) + 3  # behind ranges, remissions and the laser's pose
                x, y, turn, now = *map(float, words[at:at + 3]), float(words[-3])
                if last and math.hypot(x - last[0], y - last[1]) < spacing and abs(
                        math.remainder(turn - last[2], math.tau)) < spacing and now - last[3] < STANDS_S:
                    continue
                last, lines = (x, y, turn, now), lines + 1
            kept.write(line)
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("strata")
    parser.add_argument("work")
    parser.add_argument("worlds", nargs="+", metavar="NAME:SEED")
    parser.add_argument("--spacings", type=float, nargs="+", default=[0.0, 0.5, 1.0])
    parser.add_argument("--seeds", default="5")
    options = parser.parse_args()
    for world in options.worlds:
        name, seed = world.split(":")
        folder = f"{options.work}/{name}_{seed}"
        subprocess.run([options.strata, "simulate", f"{SCENARIOS}/{name}.yaml", "--per-day", "--seed", seed,
                        "--out", folder, "--quiet", "--force"], check=True)
        days = [f"{folder}/day_{day}" for day in
                range(1, 1 + sum(entry.startswith("day_") for entry in os.listdir(folder)))]
        for spacing in options.spacings:
            scans = sum(thin(f"{day}/log.clf", f"{day}/thinned.clf", spacing) for day in days[:-1])
            subprocess.run([options.strata, "compare", "--train", *[f"{day}/thinned.clf" for day in days[:-1]],
                            "--test", f"{days[-1]}/log.clf", "--poses", *[f"{day}/truth.tum" for day in days],
                            "--seeds", options.seeds, "--models", "filtered,patch,timescale", "--set",
                            "protocol.memory_steps=0", "--out", f"{folder}/compared", "--force", "--quiet"],
                           check=True, stdout=subprocess.DEVNULL)
            with open(f"{folder}/compared/comparison.json") as file:
                models = json.load(file)["models"]
            print(world, f"every {spacing} m: {scans} scans;", "; ".join(
                f"{model} {one['error_m']['mean']:.3f} m, {one['lost_runs']} lost" for model, one in models.items()), flush=True)


if __name__ == "__main__":
    main()
