#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Recomputes a comparison from errors.csv and checks comparison.json and its verdict against it.

usage: recompute_comparison.py FOLDER

Python's standard library only, and nothing of the program under test: the definitions are those of
the contracts, written a second time.
"""
import csv
import itertools
import json
import math
import pathlib
import random
import statistics
import sys

FAILED_M = 0.5
LOST_M = 1.0
HOLD_S = 5.0
MATTERS_M = 0.025
ALPHA = 0.05

problems = []


def check(what, found, expected, tolerance):
    if found is None or expected is None:
        if found is not expected:
            problems.append(f"{what}: {found}, expected {expected}")
    elif abs(found - expected) > tolerance:
        problems.append(f"{what}: {found}, expected {expected}")


def longest_runs(times, flags):
    """(index, duration) of each stretch in which the flag holds."""
    begin = None
    for i, flag in enumerate(flags):
        if flag and begin is None:
            begin = i
        if begin is not None and (not flag or i + 1 == len(flags)):
            last = i if flag else i - 1
            yield begin, times[last] - times[begin], last
            begin = None


def recovery(times, errors):
    """Seconds from where a run is lost until it holds below 0.5 m again; None: not lost, or never."""
    for begin, duration, _ in longest_runs(times, [e > LOST_M for e in errors]):
        if duration < HOLD_S:
            continue
        low = [e < FAILED_M for e in errors[begin:]]
        for found, length, last in longest_runs(times[begin:], low):
            if length >= HOLD_S or begin + last + 1 == len(errors):
                return times[begin + found] - times[begin]
        return None
    return None


def judge_run(rows):
    """What comparison.json tells of one run of (time, error, changed)."""
    times = [row[0] for row in rows]
    errors = [row[1] for row in rows]
    start = 0
    for begin, duration, last in longest_runs(times, [e < FAILED_M for e in errors]):
        if duration >= HOLD_S or last + 1 == len(rows):
            start = begin
            break
    counted = errors[start:]
    lost = any(
        duration >= HOLD_S
        for _, duration, _ in longest_runs(times[start:], [e > LOST_M for e in counted])
    )
    ordered = sorted(errors)
    changed = [row[1] for row in rows if row[2]]
    return {
        "mean": statistics.fmean(errors),
        "median": statistics.median(errors),
        "p95": ordered[min(len(ordered), max(1, math.ceil(0.95 * len(ordered)))) - 1],
        "failure_rate": sum(e > FAILED_M for e in counted) / len(counted),
        "lost": lost,
        "max": max(errors),
        "recovery": recovery(times[start:], counted),
        "changed": statistics.fmean(changed) if changed else None,
        "changed_failures": statistics.fmean([e > FAILED_M for e in changed]) if changed else None,
    }


def wilcoxon(differences):
    values = sorted((abs(d), d > 0) for d in differences if d != 0.0)
    n = len(values)
    if n == 0:
        return 1.0
    ranks = []
    for _, group in itertools.groupby(enumerate(values, 1), key=lambda entry: entry[1][0]):
        group = list(group)
        shared = sum(rank for rank, _ in group) / len(group)
        ranks += [(shared, positive) for _, (_, positive) in group]
    total = sum(rank for rank, _ in ranks)
    plus = sum(rank for rank, positive in ranks if positive)
    smaller = min(plus, total - plus)
    if n <= 25:
        ways = {0.0: 1}
        for rank, _ in ranks:
            following = dict(ways)
            for value, count in ways.items():
                following[value + rank] = following.get(value + rank, 0) + count
            ways = following
        tail = sum(count for value, count in ways.items() if value <= smaller + 1e-9)
        return min(1.0, 2.0 * tail / 2**n)
    z = (smaller - total / 2 + 0.5) / math.sqrt(sum(rank * rank for rank, _ in ranks) / 4)
    return min(1.0, 2.0 * statistics.NormalDist().cdf(z))


def holm(p_values):
    adjusted = [0.0] * len(p_values)
    largest = 0.0
    for step, i in enumerate(sorted(range(len(p_values)), key=lambda k: p_values[k])):
        largest = max(largest, min(1.0, (len(p_values) - step) * p_values[i]))
        adjusted[i] = largest
    return adjusted


def mcnemar(first, second):
    n = first + second
    tail = sum(math.comb(n, k) for k in range(min(first, second) + 1))
    return 1.0 if n == 0 else min(1.0, 2.0 * tail / 2**n)


def bootstrap(values, resamples=4000):
    draw = random.Random(1)
    means = sorted(statistics.fmean(draw.choices(values, k=len(values))) for _ in range(resamples))
    return means[int(0.025 * resamples)], means[int(0.975 * resamples)]


def check_interval(what, found, values):
    """Another kind of bootstrap with other random numbers: alike, not equal."""
    low, high = bootstrap(values)
    slack = 0.4 * (high - low) + 1e-6
    check(what + " low", found[0], low, slack)
    check(what + " high", found[1], high, slack)


def read_units(path):
    units = {}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            unit = units.setdefault(row["model"], {}).setdefault((row["part"], row["seed"]), [])
            unit.append((float(row["time_s"]), float(row["error_m"]), row["changed"] == "1"))
    return {m: {u: judge_run(rows) for u, rows in runs.items()} for m, runs in units.items()}


def check_model(name, runs, claimed):
    means = [run["mean"] for run in runs.values()]
    for key in ("mean", "median", "p95", "max"):
        value = statistics.fmean(run[key] for run in runs.values())
        check(f"{name} error {key}", claimed["error_m"][key], value, 1e-7)
    check_interval(f"{name} ci95", claimed["error_m"]["ci95"], means)
    rate = statistics.fmean(run["failure_rate"] for run in runs.values())
    check(f"{name} failure rate", claimed["failure_rate"], rate, 1e-9)
    check(f"{name} lost", claimed["lost_runs"], sum(run["lost"] for run in runs.values()), 0)
    recovered = sum(run["recovery"] is not None for run in runs.values())
    check(f"{name} recovered", claimed["recovered_runs"], recovered, 0)
    changed = [run["changed"] for run in runs.values() if run["changed"] is not None]
    there = claimed["where_it_changed"]
    check(
        f"{name} error where it changed",
        there["error_m"]["mean"] if there["error_m"] else None,
        statistics.fmean(changed) if changed else None,
        1e-7,
    )
    failures = [run["changed_failures"] for run in runs.values() if run["changed"] is not None]
    check(
        f"{name} failures where it changed",
        there["failure_rate"],
        statistics.fmean(failures) if failures else None,
        1e-9,
    )


def check_predictions(path, models):
    """Log p per beam, of which every beam of every scan weighs the same."""
    sums = {}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            total = sums.setdefault(row["model"], [0.0, 0])
            total[0] += float(row["log_likelihood"])
            total[1] += int(row["beams"])
    for name, claimed in models.items():
        if claimed["scan_prediction"] is None:
            continue
        nats, beams = sums[name]
        found = claimed["scan_prediction"]
        check(f"{name} log p", found["log_likelihood_per_beam"], nats / beams, 1e-6)
        check(f"{name} beams", found["beams"], beams, 0)


def check_pairs(models, wins):
    for win in wins:
        name = f"{win['better']} against {win['worse']}"
        better, worse = models[win["better"]], models[win["worse"]]
        win["differences"] = [worse[unit]["mean"] - better[unit]["mean"] for unit in better]
        check(f"{name} mean", win["mean_difference_m"], statistics.fmean(win["differences"]), 1e-7)
        check(
            f"{name} median", win["median_difference_m"], statistics.median(win["differences"]), 1e-7
        )
        check_interval(f"{name} ci95", win["ci95_m"], win["differences"])
        pairs = itertools.product(worse.values(), better.values())
        signs = [(a["mean"] > b["mean"]) - (a["mean"] < b["mean"]) for a, b in pairs]
        check(f"{name} Cliff's delta", win["cliffs_delta"], statistics.fmean(signs), 1e-9)
        only_better = sum(better[u]["lost"] and not worse[u]["lost"] for u in better)
        only_worse = sum(worse[u]["lost"] and not better[u]["lost"] for u in better)
        check(f"{name} lost by the better", win["lost_only_better"], only_better, 0)
        check(f"{name} lost by the worse", win["lost_only_worse"], only_worse, 0)
        win["p_lost"] = mcnemar(only_better, only_worse)
    for win, p in zip(wins, holm([wilcoxon(win["differences"]) for win in wins])):
        name = f"{win['better']} against {win['worse']}"
        check(f"{name} p", win["p_holm"], p, 1e-9)
        if win["significant"] != (p < 0.05 and win["ci95_m"][0] > 0.0):
            problems.append(f"{name}: significant is {win['significant']}, p is {p}")
    for win, p in zip(wins, holm([win["p_lost"] for win in wins])):
        check(f"{win['better']} against {win['worse']} p lost", win["p_lost_holm"], p, 1e-9)


def check_verdict(models, wins, verdict):
    best = min(models, key=lambda m: statistics.fmean(run["mean"] for run in models[m].values()))
    if not verdict.startswith(best + " has the lowest mean error"):
        problems.append(f"verdict: {best} has the lowest mean error, not as it says: {verdict}")
    phrases = verdict.split(";")
    for win in wins:
        if win["better"] != best:
            continue
        matters = win["significant"] and win["mean_difference_m"] >= MATTERS_M
        phrase = (
            "significantly below"
            if matters
            else "equal for practical purposes" if win["significant"] else "no significant difference"
        )
        named = [p for p in phrases if phrase in p and f"{win['worse']} (" in p]
        if not named:
            problems.append(f"verdict: does not say '{phrase}' of {win['worse']}: {verdict}")
        lost_more = win["p_lost_holm"] < ALPHA and win["lost_only_worse"] > win["lost_only_better"]
        if lost_more != (f"{win['worse']} got lost in " in verdict):
            problems.append(f"verdict: is wrong about how often {win['worse']} got lost: {verdict}")


def main():
    folder = pathlib.Path(sys.argv[1])
    claimed = json.loads((folder / "comparison.json").read_text(encoding="utf-8"))
    models = read_units(folder / "errors.csv")
    if set(models) != set(claimed["models"]):
        problems.append(f"models: {sorted(models)}, expected {sorted(claimed['models'])}")
    for name, runs in models.items():
        if len(runs) != claimed["seeds"] * len(claimed["parts"]):
            problems.append(f"{name}: {len(runs)} units")
        check_model(name, runs, claimed["models"][name])
    check_predictions(folder / "predictions.csv", claimed["models"])
    check_pairs(models, claimed["wins"])
    check_verdict(models, claimed["wins"], claimed["verdict"])
    for problem in problems:
        print(problem)
    print(f"{len(models)} models, {len(claimed['wins'])} pairs: {len(problems)} disagreements")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
