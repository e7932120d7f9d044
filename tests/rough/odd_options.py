# SPDX-License-Identifier: Apache-2.0
"""Every option of every verb that takes a number is given what is none. The options are those that
--help lists, so that a new one is tried as well."""
import re
import subprocess

# Of each type that --help names: what no option of that type takes.
ODD = {"FLOAT": ["nan", "-nan", "NAN", "nan(1)", "abc", "", "1,5", "1e999", "--"],
       "UINT": ["-1", "1.5", "nan", "abc", "", "99999999999999999999999"],
       "INT": ["1.5", "nan", "inf", "abc", "", "99999999999999999999999"]}
INFINITE = ["inf", "-inf", "infinity"]


def help_of(strata, *words):
    return subprocess.run([strata, *words, "--help"], capture_output=True, text=True).stdout


def verbs_of(strata):
    text = help_of(strata).split("Subcommands:")[1]
    return re.findall(r"^  ([a-z]+) ", text, re.MULTILINE)


def numbers_of(strata, *verb):
    """Names and types of the options that take a number."""
    return re.findall(r"^  (--[a-z-]+) (FLOAT|UINT|INT)\b", help_of(strata, *verb), re.MULTILINE)


def run(tries, material):
    for verb in verbs_of(tries.strata):
        for i, (option, kind) in enumerate(numbers_of(tries.strata, verb)):
            values = ODD[kind] + (INFINITE if kind == "FLOAT" and option != "--to" else [])
            for j, value in enumerate(values):
                if tries.is_due(i, j):
                    tries.strata_try(f"{verb}: {option} '{value}'", [verb, f"{option}={value}"], 2,
                                     "command line: ")
        tries.strata_try(f"{verb}: --no-such-option", [verb, "--no-such-option"], 2)
        tries.strata_try(f"{verb}: --config of a file that is missing",
                         [verb, "--config", material.at("missing.yaml")], 2)
        tries.strata_try(f"{verb}: --set without value", [verb, "--set"], 2)
    odd_values(tries, material)


def odd_values(tries, material):
    """Numbers, but none that make sense; and settings."""
    log, maps, out = material.log, material.at("maps"), material.at("out_of_odd")
    learn = ["learn", log, "--out", out]
    localize = ["localize", log, "--maps", maps, "--out", out]
    for words in (
            [*learn, "--from", "-1"], [*learn, "--from", "1e9"], [*learn, "--to", "-5"],
            [*learn, "--from", "5", "--to", "2"], [*learn, "--truth-offset", "1e300"],
            [*learn, "--only", "everything"], [*learn, "--only", ""], [*learn, "--threads", "-1"],
            [*learn, "--threads", "100000"], [*learn, "--scan-topic", "/nobody", "--poses", "x"],
            [*learn, "--set", "slam.em.iterations=-1"], [*learn, "--set", "slam.em.iterations=nan"],
            [*learn, "--set", "slam"], [*learn, "--set", "=1"], [*learn, "--set", "no.such=1"],
            [*learn, "--set", "preset=none"], [*learn, "--min-height", "2", "--max-height", "1"],
            [*localize, "--model", "oracle"], [*localize, "--model", ""],
            [*localize, "--initial-pose", "1,2"], [*localize, "--initial-pose", "nan,0,0"],
            [*localize, "--initial-pose", "inf,0,0"], [*localize, "--initial-pose", "a,b,c"],
            [*localize, "--set", "localizer.particles=0"],
            [*localize, "--set", "localizer.particles=-5"],
            ["changes", maps, "--path", "1", "0", "1"], ["changes", maps, "--path", "1,0,1"],
            ["changes", maps, "--path", "1,0,1,nan"], ["changes", maps, "--now", "yearly"],
            ["changes", maps, "--radius", "0"], ["changes", maps, "--radius", "-1"],
            ["compare", log, "--folds", "1", "--out", out],
            ["compare", log, "--seeds", "0", "--out", out],
            ["compare", log, "--models", "oracle", "--out", out],
            ["compare", log, "--train-until", "-1", "--out", out],
            ["compare", log, "--train", log, "--out", out],
            ["compare", "--train", log, "--out", out], ["compare", "--out", out],
            ["topology", log, "--truth-precision", "9", "--out", out],
            ["volume", material.bag, "--resolution", "0", "--out", out],
            ["volume", material.bag, "--resolution", "-1", "--out", out],
            ["volume", material.bag, "--moving", "maybe", "--out", out],
            ["volume", material.bag, "--slice", "1", "--out", out],
            ["volume", material.bag, "--slice", "2:1", "--out", out],
            ["volume", material.bag, "--slice", "nan:1", "--out", out],
            ["evaluate", material.truth], ["evaluate", material.truth, "--against", material.truth],
            ["evaluate", material.truth, "--truth", material.truth, "--mounting", "1,2"],
            ["evaluate", material.truth, "--truth", material.truth, "--frame", "laser"],
            ["evaluate", material.truth, "--truth", material.truth, "--delta", "0"],
            ["info", material.bag, "--min-height", "2", "--max-height", "1"],
            ["info", material.bag, "--scan-topic", "/nobody"],
            ["info", log, "--scan-topic", "/scan"],
            ["convert", material.bag, material.at("x.clf"), "--scan-topic", "/nobody"],
            ["convert", log, material.at("x.clf"), "--scan-topic", "/scan"],
            ["convert", material.bag, material.at("x.mcap"), "--scan-topic", "/scan"],
            ["convert", log, material.at("x.abc")], ["convert", log, material.at("x")],
            ["convert", log, material.at("x.mcap"), "--to", "nan"],
            ["convert", log, material.at("x.mcap"), "--to", "rosbag"],
            ["convert", log, material.at("x.mcap"), "--compression", "rar"],
            ["convert", log, material.at("x.clf"), "--compression-mode", "file"],
            ["simulate", material.scenario, "--set", "laser.beams=0", "--out", out],
            ["simulate", material.scenario, "--set", "robot.speed_mps=-1", "--out", out],
            ["simulate", material.scenario, "--storage", "paper", "--out", out],
            ["replay", log, "--out", out], ["lern", log], ["info"], ["info", log, log], [""]):
        tries.strata_try("strata " + " ".join(words).replace(material.work, ""), words, 2)
    tries.strata_try("strata without a verb", [], 2)
