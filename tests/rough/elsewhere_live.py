# SPDX-License-Identifier: Apache-2.0
"""Row 20 beside a robot: the localizer's score says whether its maps explain what it sees, whichever
map model it has. A log is played to it, and the score is recorded."""
import math
import os
import sqlite3
import struct

from live import Domain, Running, play, run_composition

TOPIC = "/localization_score"
# Of the second half of the drive, in the mean.
EXPLAINED = 0.5
NOT_EXPLAINED = 0.3


def scores_of(tries, material, name, log, *more):
    """Of the second half of the drive; empty where none came."""
    domain = Domain()
    folder = material.at("score_" + name)
    recorder = Running(tries.strata, material, "score_recorder_" + name, [
        "record", "--out", folder, "--transport", "loopback", "--domain", str(domain.number),
        "--storage", "sqlite3", "--topics", TOPIC + ":std_msgs/msg/Float64"], "recording into")
    localizing = run_composition(tries, material, "localizing_" + name, material.compositions +
                                 "/localize.yaml", domain, "--set",
                                 "localizer.maps=" + material.at("maps"), *more)
    tries.strata_try(f"{name}: play", play(log, domain, "--rate", "5"), 0)
    ends = (localizing.stop(), recorder.stop())
    tries.hold(f"{name}: both end well", ends == (0, 0), localizing.told()[-200:])
    scores = []
    for file in sorted(os.listdir(folder)):
        if file.endswith(".db3"):
            with sqlite3.connect(os.path.join(folder, file)) as bag:
                scores += [struct.unpack("<d", data[4:12])[0] for (data,) in bag.execute(
                    "SELECT data FROM messages ORDER BY timestamp")]
    return scores[len(scores) // 2:]


def run(tries, material):
    scenario = os.path.join(os.path.dirname(material.scenario), "side_door.yaml")
    if not os.path.exists(material.at("elsewhere")):
        material.make("simulate", scenario, "--out", material.at("elsewhere"), "--quiet")
    other = material.at("elsewhere_short.clf")
    material.make("convert", material.at("elsewhere/log.clf"), other, "--to", "25", "--quiet")

    def judge(name, log, is_low, *more):
        scores = scores_of(tries, material, name, log, *more)
        mean = sum(scores) / max(1, len(scores))
        holds = len(scores) >= 5 and (mean < NOT_EXPLAINED if is_low else mean > EXPLAINED)
        tries.hold(f"{name}: the score is {'low' if is_low else 'high'}", holds,
                   f"{mean:.2f}, of {len(scores)} scans")

    with open(material.at("maps/trajectory.tum")) as way:
        first = [float(word) for word in way.readline().split()]
    begin = f"[{first[1]}, {first[2]}, {2 * math.atan2(first[6], first[7])}]"
    for model in ("occupancy", "filtered", "patch", "timescale"):
        chosen = ("--set", "localizer.model=" + model)
        judge(model + " its own log", material.log, False, *chosen, "--set",
              "localizer.start.pose=" + begin)
        judge(model + " another building", other, True, *chosen)
        judge(model + " a wrong initial pose", material.log, True, *chosen, "--set",
              "localizer.start.pose=[2.5, 1.0, 2.0]")
