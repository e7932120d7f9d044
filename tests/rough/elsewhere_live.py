# SPDX-License-Identifier: Apache-2.0
"""Row 20 of the component: the localizer's score says whether its maps explain what it sees, for
every map model in lockstep, and for one beside a robot that goes on by itself."""
import json
import math
import os
import sqlite3
import struct

import elsewhere
from live import Domain, Running, play, run_composition

SCORE = "/localization_score"
DIAGNOSTICS = "/diagnostics"
# Of a whole drive in lockstep, of its second half live; in the mean.
EXPLAINED = 0.5
NOT_EXPLAINED = 0.3


def judge(tries, name, mean, is_low):
    holds = mean is not None and (mean < NOT_EXPLAINED if is_low else mean > EXPLAINED)
    tries.hold(f"{name}: the score is {'low' if is_low else 'high'}", holds, str(mean))


def replayed(tries, material, name, log, is_low, *more):
    out = material.at("scored")
    told = tries.strata_try(f"{name}: replay", [
        "replay", log, "--composition", material.compositions + "/localize.yaml", "--out", out,
        "--force", "--set", "localizer.maps=" + material.at("maps"), *more], 0)
    tries.hold(f"{name}: replay says {'so' if is_low else 'nothing of it'}",
               (elsewhere.NOT_EXPLAINED in told) == is_low, told[-200:])
    with open(os.path.join(out, "metrics.json")) as file:
        return json.load(file)["score"]["mean"]


def messages(folder, topic):
    """Of a bag, as bytes."""
    for file in sorted(os.listdir(folder)):
        if file.endswith(".db3"):
            with sqlite3.connect(os.path.join(folder, file)) as bag:
                yield from (data for (data,) in bag.execute(
                    "SELECT data FROM messages JOIN topics ON topics.id = topic_id WHERE name = ? ORDER BY timestamp",
                    (topic,)))


def value_of(data, key):
    """Of a diagnostic_msgs/KeyValue in a message, as text; None where it has none of that key."""
    at = data.find(key.encode() + b"\0")
    if at < 0:
        return None
    at = 4 + (at + len(key) + 1 - 4 + 3) // 4 * 4
    size, = struct.unpack_from("<I", data, at)
    return data[at + 4:at + 3 + size].decode()


def heard_live(tries, material, name, log, *more):
    """The mean score, None where too few came: a machine with much else to do loses scans; and how often the search
    beside the pose took over."""
    domain = Domain()
    folder = material.at("score_" + name)
    recorder = Running(tries.strata, material, "score_recorder_" + name, [
        "record", "--out", folder, "--transport", "loopback", "--domain", str(domain.number),
        "--storage", "sqlite3", "--topics", SCORE + ":std_msgs/msg/Float64",
        DIAGNOSTICS + ":diagnostic_msgs/msg/DiagnosticArray"], "recording into")
    localizing = run_composition(tries, material, "localizing_" + name, material.compositions +
                                 "/localize.yaml", domain, "--set",
                                 "localizer.maps=" + material.at("maps"), *more)
    tries.strata_try(f"{name}: play", play(log, domain, "--rate", "4"), 0)
    ends = (localizing.stop(), recorder.stop())
    tries.hold(f"{name}: both end well", ends == (0, 0), localizing.told()[-200:])
    scores = [struct.unpack("<d", data[4:12])[0] for data in messages(folder, SCORE)]
    took_over = [value for data in messages(folder, DIAGNOSTICS) if (value := value_of(data, "relocations"))]
    later = scores[len(scores) // 2:]
    return sum(later) / len(later) if len(later) >= 5 else None, int(took_over[-1]) if took_over else 0


def run(tries, material):
    scenario = os.path.join(os.path.dirname(material.scenario), "side_door.yaml")
    if not os.path.exists(material.at("elsewhere")):
        material.make("simulate", scenario, "--out", material.at("elsewhere"), "--quiet")
    other = material.at("elsewhere_short.clf")
    material.make("convert", material.at("elsewhere/log.clf"), other, "--to", "25", "--quiet")
    with open(material.at("maps/trajectory.tum")) as way:
        first = [float(word) for word in way.readline().split()]
    heading = 2 * math.atan2(first[6], first[7])
    begin = ("--set", f"localizer.start.pose=[{first[1]}, {first[2]}, {heading}]")
    # And it stays there: else the whole map would be searched, and the robot found.
    wrong = ("--set", "localizer.start.pose=[2.5, 1.0, 2.0]",
             "--set", "localizer.localizer.global_search.watch.is_used=false")
    for model in ("occupancy", "filtered", "patch", "timescale"):
        chosen = ("--set", "localizer.model=" + model)
        for name, log, start, is_low in (
                ("its own log", material.log, begin, False),
                ("its own log from anywhere", material.log, (), False),
                ("another building", other, (), True), ("a wrong start", material.log, wrong, True)):
            what = f"{model}, {name}"
            judge(tries, what, replayed(tries, material, what, log, is_low, *chosen, *start), is_low)
    chosen = ("--set", "localizer.model=filtered")
    # The first scans may be lost, and with them where a given start was right: it is found anyway.
    # Wherever it was said to begin, a robot in its own building is found.
    for name, log, start, is_low in (("own", material.log, begin, False),
                                     ("own_wrong_start", material.log, wrong[:2], False),
                                     ("other", other, (), True)):
        mean, took_over = heard_live(tries, material, name, log, *chosen, *start)
        judge(tries, "live, " + name, mean, is_low)
        if name == "own_wrong_start":
            tries.hold("live, a wrong start: diagnostics tell that another place took over", took_over >= 1,
                       str(took_over))
