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

TOPIC = "/localization_score"
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


def heard_live(tries, material, name, log, *more):
    """None where too few came: a machine with much else to do loses scans."""
    domain = Domain()
    folder = material.at("score_" + name)
    recorder = Running(tries.strata, material, "score_recorder_" + name, [
        "record", "--out", folder, "--transport", "loopback", "--domain", str(domain.number),
        "--storage", "sqlite3", "--topics", TOPIC + ":std_msgs/msg/Float64"], "recording into")
    localizing = run_composition(tries, material, "localizing_" + name, material.compositions +
                                 "/localize.yaml", domain, "--set",
                                 "localizer.maps=" + material.at("maps"), *more)
    tries.strata_try(f"{name}: play", play(log, domain, "--rate", "4"), 0)
    ends = (localizing.stop(), recorder.stop())
    tries.hold(f"{name}: both end well", ends == (0, 0), localizing.told()[-200:])
    scores = []
    for file in sorted(os.listdir(folder)):
        if file.endswith(".db3"):
            with sqlite3.connect(os.path.join(folder, file)) as bag:
                scores += [struct.unpack("<d", data[4:12])[0] for (data,) in bag.execute(
                    "SELECT data FROM messages ORDER BY timestamp")]
    later = scores[len(scores) // 2:]
    return sum(later) / len(later) if len(later) >= 5 else None


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
        judge(tries, "live, " + name, heard_live(tries, material, name, log, *chosen, *start), is_low)
