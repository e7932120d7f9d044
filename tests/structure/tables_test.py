#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""tools/tables makes the Markdown of small results. usage: tables_test.py tools/tables"""
import json
import subprocess
import sys


def tables(*words, data):
    return subprocess.run([sys.executable, sys.argv[1], *words, "-"], input=json.dumps(data),
                          capture_output=True, text=True)


def expect(found, expected):
    if found != expected:
        sys.exit(f"found\n{found}\nexpected\n{expected}")


def model(mean, failures, lost):
    return {"error_m": {"mean": mean, "ci95": [mean - 0.001, mean + 0.001], "p95": 2 * mean,
                        "per_seed": [mean, mean]}, "failure_rate": failures, "lost_runs": lost}


comparison = {"truth": "given", "models": {"occupancy": model(0.2, 0.125, 1), "patch": model(0.1, 0, 0)}}
result = tables("compare", "--no-origin", data=comparison)
expect(result.stdout, """\
| model | mean error [m] | 95% interval | 95th percentile [m] | failures | lost runs |
|---|---|---|---|---|---|
| patch | 0.100 | 0.099 to 0.101 | 0.20 | 0.0% | 0 of 2 |
| occupancy | 0.200 | 0.199 to 0.201 | 0.40 | 12.5% | 1 of 2 |
""")
origin = tables("compare", data=comparison).stdout.splitlines()[-1]
if "commit " not in origin or "load " not in origin or "2 runs, truth: given" not in origin:
    sys.exit(f"does not name its origin: {origin}")

entry = {"name": "match/360", "run_name": "match/360", "run_type": "iteration", "iterations": 9,
         "cpu_time": 0.19712, "real_time": 0.2, "time_unit": "ms", "mean_error_mm": 4.6}
other = {key: value for key, value in entry.items() if key != "mean_error_mm"} | {"run_name": "empty"}
expect(tables("bench", "--no-origin", data={"benchmarks": [entry, other]}).stdout, """\
| benchmark | CPU time | wall time | mean_error_mm |
|---|---|---|---|
| match/360 | 0.1971 ms | 0.2 ms | 4.6 |
| empty | 0.1971 ms | 0.2 ms |  |
""")
median = entry | {"name": "match/360_median", "run_type": "aggregate", "aggregate_name": "median",
                  "cpu_time": 0.15}
if "0.15 ms" not in tables("bench", data={"benchmarks": [entry, median]}).stdout.splitlines()[2]:
    sys.exit("takes one repetition where there is a median")

wrong = tables("compare", data={"benchmarks": []})
if wrong.returncode == 0 or "no compare JSON" not in wrong.stderr:
    sys.exit(f"takes what is no comparison: {wrong.stdout}{wrong.stderr}")
