# SPDX-License-Identifier: Apache-2.0
"""Every verb that reads a log is given what is none: one line, exit status 2, nothing left."""
import os
import re


def run(tries, material):
    at = material.at
    out = at("out_of_damaged")
    log = material.log
    # Where the damaged file goes is {}.
    verbs = {
        "info": ["info", "{}"],
        "convert to mcap": ["convert", "{}", out, "--to", "mcap"],
        "convert to carmen": ["convert", "{}", out + ".clf"],
        "learn": ["learn", "{}", "--out", out],
        "learn, second of two": ["learn", log, "{}", "--out", out],
        "learn at poses": ["learn", log, "--poses", "{}", "--out", out],
        "learn with truth": ["learn", log, "--truth", "{}", "--out", out],
        "learn on": ["learn", log, "--update", "{}", "--out", out],
        "localize": ["localize", "{}", "--maps", at("maps"), "--out", out],
        "localize in maps": ["localize", log, "--maps", "{}", "--out", out],
        "topology": ["topology", "{}", "--out", out],
        "topology at landmarks": ["topology", log, "--landmarks", "{}", "--out", out],
        "compare": ["compare", "{}", "--seeds", "1", "--out", out],
        "compare with a map": ["compare", log, "--map", "{}", "--seeds", "1", "--out", out],
        "evaluate": ["evaluate", "{}", "--truth", material.truth],
        "evaluate against": ["evaluate", material.truth, "--truth", "{}"],
        "evaluate by relations": ["evaluate", material.truth, "--relations", "{}"],
        "volume": ["volume", "{}", "--out", out],
        "changes": ["changes", "{}", "--out", out],
        "replay": ["replay", "{}", "--composition", material.compositions + "/mapping.yaml",
                   "--out", out],
        "replay a composition": ["replay", log, "--composition", "{}", "--out", out],
        "run": ["run", "--check", "{}"],
        "simulate": ["simulate", "{}", "--out", out],
        "settings": ["learn", log, "--config", "{}", "--out", out],
        "play": ["play", "{}", "--transport", "loopback", "--domain", "199"],
        "incidents": ["incidents", "{}"],
        "site": ["site", "status", "{}"],
    }
    # An option with an empty name is one that is not given.
    takes = {(verb, "empty name") for verb in ("learn on", "compare with a map", "settings")}
    # A folder in which no incident is yet.
    takes |= {("incidents", name) for name in ("empty folder", "folder of rubbish")}
    for i, (verb, words) in enumerate(verbs.items()):
        for j, (name, path) in enumerate(material.damaged().items()):
            if (verb, name) in takes or not tries.is_due(i, j):
                continue
            arguments = [path if word == "{}" else word for word in words]
            tries.strata_try(f"{verb}: {name}", arguments, 2, names(path))
    left = [name for name in os.listdir(material.work) if name.startswith(("out_of", ".out_of"))]
    tries.hold("what failed left nothing", not left, " ".join(left))


def names(path):
    """What a line has that says which file it is about: its name, or that there is none."""
    return re.escape(os.path.basename(path)) if path else "''|empty name|required|is missing|nothing to compare|landmark"


def unreadable(tries, material):
    """As a user who may not read; root may everything."""
    locked = material.at("locked")
    os.makedirs(locked, exist_ok=True)
    for name in ("log.clf", "bag.mcap"):
        material.write("locked/" + name, open(material.log).read())
    secret = material.write("secret.clf", open(material.log).read())
    os.chmod(locked, 0)
    os.chmod(secret, 0)
    try:
        for verb in ("info", "evaluate", "convert"):
            more = {"evaluate": ["--truth", material.truth], "convert": [material.at("x.mcap")]}
            for name, path in (("folder", locked), ("file", secret),
                               ("file in a folder", locked + "/log.clf")):
                tries.strata_try(f"{verb}: {name} that may not be read",
                                 [verb, path, *more.get(verb, [])], (1, 2),
                                 "ermission|is a folder", user="nobody")
    finally:
        os.chmod(locked, 0o755)
        os.chmod(secret, 0o644)


def cut_anywhere(tries, material):
    """Whatever is left of a log that was cut is read, or refused in one line."""
    whole_scans = {"world/log.clf": 112, "good.mcap": 112, "good.db3": 112, "good.bag": 3}
    for name, scans in whole_scans.items():
        whole = material.bytes_of(name)
        for share in range(5, 100, 5):
            ending = os.path.splitext(name)[1]
            path = material.write("cut" + ending, whole[:len(whole) * share // 100])
            ended = tries.strata_try(f"info: {name} cut at {share}%", ["info", path], (0, 2))
            if ": error:" not in ended and ending != ".clf":
                whole_or_told = "damaged" in ended or re.search(f"scans +{scans},", ended)
                tries.hold(f"info: {name} cut at {share}% is told", whole_or_told)
