# SPDX-License-Identifier: Apache-2.0
"""--out that cannot be written, or that holds what must not be replaced: told before the work."""
import os
import shutil


def verbs_of(material):
    """Of each verb that writes a folder: its words, but for --out, and the kind it writes."""
    log, maps = material.log, material.at("maps")
    return {
        "learn": (["learn", log], "maps"),
        "localize": (["localize", log, "--maps", maps], "localization"),
        "topology": (["topology", log, "--landmarks", material.at("landmarks.txt")], "topology"),
        "compare": (["compare", log, "--seeds", "1", "--models", "occupancy"], "comparison"),
        "volume": (["volume", material.at("corner.log")], "volume"),
        "changes": (["changes", maps], "changes"),
        "simulate": (["simulate", material.scenario], "simulation"),
    }


def prepare(material):
    material.write("landmarks.txt", "1\n5\n9\n")
    wall = "".join(f"{1 + 0.01 * i} {1 - 0.01 * i} 0.1\n" for i in range(50))
    material.write("corner.log", "NODE 0 0 0 0 0 0\n" + wall + "NODE 0.1 0 0 0 0 0\n" + wall)


def cannot_be_written(tries, material):
    prepare(material)
    out = material.at("places")
    os.makedirs(out + "/locked", exist_ok=True)
    material.write("places/file", "mine\n")
    os.chmod(out, 0o777)
    os.chmod(out + "/locked", 0o555)
    places = {
        "a file": (out + "/file", None), "below a file": (out + "/file/x", None),
        "a device": ("/dev/null", None), "a long name": (out + "/" + "n" * 300, None),
        "no name": ("", None), "in /proc": ("/proc/strata", None),
        "in a folder that may not be written": (out + "/locked/x", "nobody"),
        "a folder that may not be written": (out + "/locked", "nobody"),
    }
    verbs = {verb: words for verb, (words, _) in verbs_of(material).items()}
    verbs["replay"] = ["replay", material.log, "--composition",
                       material.compositions + "/mapping.yaml"]
    # Before the work: without a log that could be worked on, --out is what is told.
    for verb, words in verbs.items():
        for name, (place, user) in places.items():
            if verb == "changes" and not place:
                continue  # as without
            tries.strata_try(f"{verb} --out: {name}", [*words, "--out", place], (1, 2),
                             "cannot be written|is not a folder|is empty|is missing|required",
                             user=user)
        absent = [material.at("absent.clf") if word == material.log else word for word in words]
        if absent != words:
            tries.strata_try(f"{verb} --out: told before the log is looked at",
                             [*absent, "--out", out + "/file"], 1, "is not a folder")
    for name, (place, user) in places.items():
        if not place or name == "a device":
            continue
        for ending in (".clf", ".mcap", ".db3"):
            end = place if place.endswith("x") else place + "/x"
            tries.strata_try(f"convert to {ending}: below {name}",
                             ["convert", material.log, end + ending], (1, 2), user=user)
        tries.strata_try(f"record --out: {name}",
                         ["record", "--transport", "loopback", "--out", place], (1, 2), user=user)
        tries.strata_try(f"messages: {name}", ["messages", place], (1, 2), user=user)
        if not name.startswith("a folder"):  # an empty one makes room
            tries.strata_try(f"keystore create: {name}", ["keystore", "create", place], (1, 2),
                             user=user)
    os.makedirs(out + "/folder.clf", exist_ok=True)
    tries.strata_try("convert: OUT is a folder",
                     ["convert", material.log, out + "/folder.clf"], 1, "is a folder")
    tries.strata_try("convert: OUT is told before IN is read",
                     ["convert", material.at("nan.clf"), out + "/no/x.clf"], 1, "folder")
    tries.hold("nothing is left beside them", sorted(os.listdir(out)) ==
               ["file", "folder.clf", "locked"], " ".join(os.listdir(out)))
    tries.hold("the file in the way is as it was", open(out + "/file").read() == "mine\n")


def of_another_kind(tries, material):
    prepare(material)
    verbs = verbs_of(material)
    for verb, (words, kind) in verbs.items():
        tries.strata_try(f"{verb} writes {kind}", [*words, "--out", material.at("kind_" + verb)], 0)
        tries.strata_try(f"{verb} replaces its own", [*words, "--out", material.at("kind_" + verb)],
                         0)
    for verb, (words, kind) in verbs.items():
        for other, (_, there) in verbs.items():
            if other == verb:
                continue
            folder = material.at("kind_" + other)
            before = snapshot(folder)
            tries.strata_try(f"{verb} over {there}", [*words, "--out", folder], 1,
                             f"holds {there}, which {kind} would replace; .*--force")
            tries.hold(f"{verb} over {there} changed nothing", snapshot(folder) == before)
        copy = material.at("forced")
        shutil.rmtree(copy, ignore_errors=True)
        shutil.copytree(material.at("kind_changes" if verb != "changes" else "kind_learn"), copy)
        tries.strata_try(f"{verb} --force", [*words, "--out", copy, "--force"], 0)
        old = material.at("old")
        shutil.rmtree(old, ignore_errors=True)
        shutil.copytree(material.at("maps"), old)
        os.remove(old + "/summary.json")  # as of a folder from before it said what it is
        if verb != "learn":
            tries.strata_try(f"{verb} over maps without a summary", [*words, "--out", old], 1,
                             "holds maps")
    # What others than these verbs write, and learned maps would mix with.
    tries.strata_try("make a keystore", ["keystore", "create", material.at("keys")], 0)
    os.makedirs(material.at("incident"))
    material.write("incident/incident.json", "{}\n")
    for name, there in (("keys", "a keystore"), ("world/bag", "a bag"), ("incident", "an incident")):
        folder = material.at(name)
        before = snapshot(folder)
        for verb, (words, kind) in verbs.items():
            tries.strata_try(f"{verb} into {there}", [*words, "--out", folder], 1,
                             f"holds {there}, which {kind} would replace; .*--force")
        tries.strata_try(f"messages into {there}", ["messages", folder], 1, f"holds {there}")
        tries.hold(f"{there} is as it was", snapshot(folder) == before)
    for name in ("keys", "world/bag", "kind_learn"):
        for words in (["record", "--transport", "loopback", "--out", material.at(name)],
                      ["convert", material.log, material.at(name), "--to", "mcap"],
                      ["keystore", "create", material.at(name)]):
            tries.strata_try(f"{words[0]} into {name}", words, 1, "exists already|is there already")
    tries.strata_try("messages over maps", ["messages", material.at("kind_learn")], 1, "holds maps")
    other = material.at("others")
    os.makedirs(other, exist_ok=True)
    material.write("others/notes.txt", "mine\n")
    tries.strata_try("learn into a folder of somebody's",
                     ["learn", material.log, "--out", other], 0)
    tries.hold("what was there stays", open(other + "/notes.txt").read() == "mine\n")


def of_the_users(tries, material):
    """A file of the user's under any name that a verb writes, in a folder that no verb made."""
    prepare(material)
    verbs = {verb: words for verb, (words, _) in verbs_of(material).items()}
    verbs["changes"] += ["--path", "0,0,0.5,0"]
    absent = material.at("absent.clf")
    for verb, words in verbs.items():
        wrote = material.at("wrote_" + verb)
        tries.strata_try(f"{verb} into a new folder", [*words, "--out", wrote], 0)
        for name in sorted(os.listdir(wrote)):
            mine = material.at("mine_" + verb)
            shutil.rmtree(mine, ignore_errors=True)
            os.makedirs(mine)
            material.write(f"mine_{verb}/{name}", "mine\n")
            before = snapshot(mine)
            # Before the work: without a log that could be worked on.
            early = [absent if word == material.log else word for word in words]
            tries.strata_try(f"{verb} beside a {name} of the user's", [*early, "--out", mine], 1,
                             "which .* would replace; .*--force")
            tries.hold(f"{verb}: the user's {name} is as it was", snapshot(mine) == before)
        tries.strata_try(f"{verb} --force beside files of the user's",
                         [*words, "--out", mine, "--force"], 0)
    mine = material.at("mine_replay")
    os.makedirs(mine)
    for composition, name in (("mapping", "patches.pgm"), ("localize", "trajectory.tum"),
                              ("topology", "topology.graphml")):
        material.write("mine_replay/" + name, "mine\n")
        tries.strata_try(f"replay of {composition} beside a {name} of the user's",
                         ["replay", absent, "--composition",
                          f"{material.compositions}/{composition}.yaml", "--out", mine], 1,
                         f"has '{name}', which .* would replace; .*--force")
        os.remove(mine + "/" + name)
    tries.strata_try("messages", ["messages", material.at("package")], 0)
    tries.strata_try("messages again", ["messages", material.at("package")], 0)
    material.write("package/package.xml", "<package><name>mine</name></package>\n")
    tries.strata_try("messages over a package of the user's", ["messages", material.at("package")],
                     1, "would replace; .*--force")


def with_more_runs(tries, material):
    log = material.log
    two = material.at("two")
    tries.strata_try("learn two runs", ["learn", log, log, "--out", two], 0)
    before = snapshot(two)
    tries.strata_try("learn one run over two", ["learn", log, "--out", two], 1,
                     "holds maps of 2 runs, which those of 1 would replace; .*--update .*--force")
    tries.strata_try("replay one run over two",
                     ["replay", log, "--composition", material.compositions + "/mapping.yaml",
                      "--out", two], 1, "holds maps of 2 runs")
    tries.hold("the two runs are there", snapshot(two) == before)
    tries.strata_try("learn two runs over two", ["learn", log, log, "--out", two], 0)
    tries.strata_try("learn on, once more", ["learn", log, "--update", two, "--out", two], 0, "left out")
    tries.strata_try("learn on", ["learn", log, "--update", two, "--out", two, "--again"], 0)
    tries.strata_try("learn from two over three",
                     ["learn", log, log, "--out", two], 1, "holds maps of 3 runs")
    tries.strata_try("learn one run over three, forced",
                     ["learn", log, "--out", two, "--force"], 0)
    info = tries.strata_try("info of what is left", ["info", two + "/strata.db"], 0, "run +0")
    tries.hold("one run is left", "run        1" not in info)


def snapshot(folder):
    found = {}
    for path, _, names in os.walk(folder):
        for name in names:
            with open(os.path.join(path, name), "rb") as file:
                found[os.path.join(path, name)] = file.read()
    return found
