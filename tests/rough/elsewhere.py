# SPDX-License-Identifier: Apache-2.0
"""Maps that do not explain a log are told, whichever map model it is localized with."""
import os

NOT_EXPLAINED = "warning: these maps do not explain this log"


def run(tries, material):
    """Row 20: another building's log, and a wrong initial pose."""
    scenario = os.path.join(os.path.dirname(material.scenario), "side_door.yaml")
    material.make("simulate", scenario, "--out", material.at("elsewhere"), "--quiet")
    other, out = material.at("elsewhere/log.clf"), material.at("somewhere")
    for model in ("occupancy", "filtered", "patch", "timescale"):
        def localize(log, *more):
            return ["localize", log, "--maps", material.at("maps"), "--model", model, "--out", out,
                    *more]

        for start in (["--global"], ["--initial-pose", "1,1,2"]):
            tries.strata_try(f"{model}: the log of another building, {start[0]}",
                             localize(other, *start), 0, NOT_EXPLAINED)
        # Otherwise the robot is looked for, and found.
        tries.strata_try(f"{model}: a wrong initial pose",
                         localize(material.log, "--initial-pose", "2.5,1,2",
                                  "--set", "localizer.global_search.watch.is_used=false"), 0,
                         NOT_EXPLAINED + ".*did the robot begin at --initial-pose")
        tries.strata_try(f"{model}: the log of another building, --quiet",
                         localize(other, "--global", "--quiet"), 0, NOT_EXPLAINED)
        told = tries.strata_try(f"{model}: its own log", localize(material.log, "--global"), 0,
                                "the maps explain [0-9]+% of the drive")
        tries.hold(f"{model}: its own log is explained", NOT_EXPLAINED not in told, told[-200:])
