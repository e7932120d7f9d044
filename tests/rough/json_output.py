# SPDX-License-Identifier: Apache-2.0
"""--json of every verb that has it: one JSON document on stdout, and nothing else there, whatever
files are called."""
import json
import os
import shutil
import subprocess

ODD = os.fsdecode(b"odd \xff\xe4\"'\n name")


def not_in_json(constant):
    raise ValueError(constant + " is no JSON")


def json_try(tries, name, words, codes=(0,)):
    ended = subprocess.run([tries.strata, *words], stdin=subprocess.DEVNULL, capture_output=True,
                           timeout=120)
    err = ended.stderr.decode(errors="replace")
    faults = [] if ended.returncode in codes else [f"exit status {ended.returncode}: {err[-200:]}"]
    try:
        json.loads(ended.stdout.decode(), parse_constant=not_in_json)
    except ValueError as error:
        faults.append(f"{error}: {ended.stdout[:200]}")
    tries.judge(name, faults, f"{ended.returncode} {len(ended.stdout)} bytes")


def run(tries, material):
    log, maps = material.log, material.at("maps")
    odd_log, odd_maps = material.at(ODD + ".clf"), material.at(ODD)
    shutil.copy(log, odd_log)
    tries.strata_try("learn from a log with an odd name", ["learn", odd_log, "--out", odd_maps], 0)
    tries.strata_try("topology of a log with an odd name", ["topology", odd_log, "--landmarks",
                     material.write("marks.txt", "1\n5\n9\n"), "--out", material.at("odd_places")],
                     0)
    keys = material.at("json_keys")
    tries.strata_try("make a keystore", ["keystore", "create", keys], 0)
    rounds = {
        "info": [["info", path] for path in
                 (log, odd_log, material.bag, material.at("good.mcap"), material.at("good.bag"), maps,
                  odd_maps, maps + "/strata.db", odd_maps + "/strata.db", material.at("odd_places"))],
        "localize": [["localize", odd_log, "--maps", odd_maps, "--out", material.at("odd_place"),
                      *start] for start in (["--global"], ["--initial-pose", "3,1,2"])],
        "changes": [["changes", odd_maps], ["changes", odd_maps, "--path", "1,0,90,90"]],
        "compare": [["compare", odd_log, "--seeds", "1", "--models", "occupancy", "--out",
                     material.at("odd_comparison")]],
        "evaluate": [["evaluate", odd_maps + "/trajectory.tum", "--truth", material.truth]],
        "doctor": [["doctor", "--seconds", "0.2", "--transport", "loopback", "--domain", "195"]],
        "incidents": [["incidents", material.work]],
        "keystore": [["keystore", "list", keys]],
    }
    shown = subprocess.run([tries.strata, "--help"], capture_output=True, text=True).stdout
    verbs = [line.split()[0] for line in shown.split("Subcommands:")[-1].splitlines() if line.strip()]
    for verb in verbs:
        said = subprocess.run([tries.strata, verb, "--help"], capture_output=True, text=True).stdout
        tries.hold(f"{verb}: --json is tried where it is", ("--json" not in said) or verb in rounds)
    for verb, all_words in rounds.items():
        for words in all_words:
            name = " ".join(words[:2]).replace(material.work, "").encode(errors="replace").decode()
            name = name.replace("\n", " ")
            for more in (["--quiet"], []):
                codes = (0, 1) if verb == "doctor" else (0,)
                json_try(tries, f"{name} --json {' '.join(more)}", [*words, "--json", *more], codes)
