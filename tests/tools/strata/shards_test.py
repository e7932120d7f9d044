# SPDX-License-Identifier: Apache-2.0
"""packaging/cluster/compare-parallel, run by GNU parallel on this machine: what it merges is what one
process writes, bit for bit but for times.
    shards_test.py STRATA SCENARIO SCRIPT FOLDER"""
import json
import os
import shutil
import subprocess
import sys

TIMES = ("update_ms", "query_ms")


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(item) for key, item in value.items() if key not in TIMES}
    if isinstance(value, list):
        return [without_times(item) for item in value]
    return value


def files_of(folder):
    found = {}
    for path, _, names in os.walk(folder):
        for name in names:
            if name in ("report.html", "comparison.json"):  # they hold times
                continue
            with open(os.path.join(path, name), "rb") as file:
                found[os.path.relpath(os.path.join(path, name), folder)] = file.read()
    return found


def comparison_of(folder):
    with open(os.path.join(folder, "comparison.json"), encoding="utf-8") as file:
        return without_times(json.load(file))


def require(holds, text):
    if not holds:
        sys.exit("shards_test: " + text)


def main():
    strata, scenario, script, folder = sys.argv[1:]
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    os.chdir(folder)
    run = lambda *arguments: subprocess.run(arguments, check=True)
    run(strata, "simulate", scenario, "--per-day", "--seed", "3", "--out", "world", "--quiet",
        "--set", "days=2")
    logs = [f"world/day_{day}/log.clf" for day in (1, 2)]
    what = ["--poses", *[f"world/day_{day}/truth.tum" for day in (1, 2)], "--models",
            "occupancy,patch", "--seeds", "6", "--folds", "2", "--set", "protocol.memory_steps=0",
            "--set", "protocol.memory_seeds=1", "--set", "localizer.kld.max_particles=400"]
    run(strata, "compare", *logs, *what, "--out", "whole", "--quiet")
    with open("hosts", "w", encoding="utf-8") as file:
        file.write("2/:\n")
    environment = dict(os.environ, STRATA=strata, HOME=folder)
    subprocess.run([script, "3", "hosts", "merged", *logs, *what], check=True, env=environment)
    require(comparison_of("merged") == comparison_of("whole"), "comparison.json differs")
    whole, merged = files_of("whole"), files_of("merged")
    require(sorted(whole) == sorted(merged), f"files differ: {sorted(set(whole) ^ set(merged))}")
    for name, content in whole.items():
        require(merged[name] == content, name + " differs")
    require(len(whole) > 20, "too few files to say anything")
    # The drive can be played, and both reports lead there.
    require("replay.html" in whole, "replay.html is missing")
    for result in ("whole", "merged"):
        with open(os.path.join(result, "report.html"), encoding="utf-8") as file:
            require('href="replay.html"' in file.read(), f"{result}/report.html does not link to replay.html")

    # What cannot be drawn costs no shard.
    without = subprocess.run([strata, "compare", *logs, *what, "--shard", "1/1", "--out", "undrawn", "--quiet"],
                             capture_output=True, text=True, check=False, env=dict(os.environ, PATH="/nowhere"))
    require(without.returncode == 0, without.stderr)
    require("results are there but for pictures (node_levels.png" in without.stderr, without.stderr)
    require(os.path.exists("undrawn/results.bin"), "the shard has no results")

    # A lost shard is named, and the sample runs only that one again.
    shutil.rmtree("merged.shards/2")
    kept = os.stat("merged.shards/1/shard.json").st_mtime_ns
    shards = [f"merged.shards/{i}" for i in (1, 3)]
    lost = subprocess.run([strata, "compare", "--merge", *shards, "--out", "lost"],
                          capture_output=True, text=True, check=False)
    require(lost.returncode == 2 and "has no shard 2/3" in lost.stderr, lost.stderr)
    require(not os.path.exists("lost"), "something was merged")
    subprocess.run([script, "3", "hosts", "merged", *logs, *what], check=True, env=environment)
    require(os.stat("merged.shards/1/shard.json").st_mtime_ns == kept, "a whole shard ran again")
    require(comparison_of("merged") == comparison_of("whole"), "it differs after a shard was lost")


if shutil.which("parallel") is None:
    sys.exit(77)
main()
