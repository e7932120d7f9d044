# SPDX-License-Identifier: Apache-2.0
"""Row 13: every verb under limits on its address space, down to where it cannot begin. It does its
work, or says on one line what ran out, and what to do about it."""
import os
import shutil

SAYS = ("memory: ran out under the limit of [0-9]+ MB on address space.*(ulimit -v|--)|"
        "threads: no more can be made|limits of this process: leave too little|"
        "memory or threads ran out")
# Where a verb is known to need more than there is, by far: the setting that makes it less is told.
HUNGRY = {
    "learn": (["--set", "slam.beam_filter.resolution_m=0.005"], "slam.beam_filter.resolution_m="),
    "localize": (["--set", "localizer.particles=20000000"], "--set localizer.particles=N"),
    "volume": (["--resolution", "0.002"], "--resolution 0.2"),
}


def verbs_of(material):
    log, maps, out = material.log, material.at("maps"), ["--out", material.at("out_of_memory")]
    dds = ["--transport", "loopback", "--domain", "198"]
    return {
        "info": ["info", log],
        "convert": ["convert", log, material.at("out_of_memory.mcap")],
        "learn": ["learn", log, *out],
        "localize": ["localize", log, "--maps", maps, "--initial-pose", "0,0,0", *out],
        "compare": ["compare", log, "--seeds", "1", "--models", "occupancy", *out],
        "evaluate": ["evaluate", material.truth, "--truth", material.truth],
        "changes": ["changes", maps, *out],
        "topology": ["topology", log, "--landmarks", material.at("marks.txt"), *out],
        "volume": ["volume", material.at("walls.log"), *out],
        "simulate": ["simulate", material.scenario, *out],
        "replay": ["replay", log, "--composition", material.compositions + "/mapping.yaml", *out],
        "play": ["play", log, "--rate", "100", *dds],
        "doctor": ["doctor", "--seconds", "0.2", *dds],
        "incidents": ["incidents", material.work],
        "messages": ["messages", material.at("out_of_memory")],
        "keystore": ["keystore", "create", material.at("out_of_memory")],
    }


def run(tries, material):
    walls = "".join(f"{3 + 0.01 * i} {3 - 0.01 * i} {0.001 * i}\n" for i in range(500))
    material.write("walls.log", "NODE 0 0 0 0 0 0\n" + walls)
    material.write("marks.txt", "1\n5\n9\n")
    before = sorted(os.listdir(material.work))
    for verb, words in verbs_of(material).items():
        # The loader and the libraries begin with 62.
        for megabytes in (65, 70, 80, 90, 100, 120, 150, 190, 220, 250):
            tries.strata_try(f"{verb} within {megabytes} MB", words, 0,
                             shell=f"ulimit -c 0; ulimit -v {megabytes * 1000}; exec STRATA",
                             or_fails=SAYS + ("|1 error was found" if verb == "doctor" else ""))
            for left in ("out_of_memory", "out_of_memory.mcap"):
                path = material.at(left)
                shutil.rmtree(path) if os.path.isdir(path) else None
                if os.path.exists(path):
                    os.remove(path)
    for verb, (more, setting) in HUNGRY.items():
        tries.strata_try(f"{verb}: much more than there is", [*verbs_of(material)[verb], *more], 1,
                         f"needed [0-9.]+ MB more, beside [0-9.]+ MB in use; .*{setting}",
                         shell="ulimit -c 0; ulimit -v 130000; exec STRATA")
    tries.hold("what ran out of memory left nothing", sorted(os.listdir(material.work)) == before,
               " ".join(set(os.listdir(material.work)) - set(before)))
