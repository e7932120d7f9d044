#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The sentence at the end of tools/demo says what a comparison found, and no more.

usage: one_sentence_test.py TOOLS
"""
import importlib.machinery
import importlib.util
import sys

loader = importlib.machinery.SourceFileLoader("one_sentence", sys.argv[1] + "/one_sentence")
tool = importlib.util.module_from_spec(importlib.util.spec_from_loader("one_sentence", loader))
sys.dont_write_bytecode = True
loader.exec_module(tool)


def comparison(wins=(), **models):
    """models: mean error in metres and how many of 10 runs were lost."""
    return {"wins": [{"better": better, "worse": worse, "significant": is_significant,
                      "mean_difference_m": difference}
                     for better, worse, is_significant, difference in wins],
            "models": {name: {"error_m": {"mean": error, "per_seed": [error] * 10},
                              "lost_runs": lost} for name, (error, lost) in models.items()}}


def main():
    shown = tool.sentence(comparison([("patch", "occupancy", True, 0.07)], patch=(0.06, 0),
                                     occupancy=(0.13, 2), filtered=(0.2, 5)))
    assert shown == ("With the map that knows what changes the robot knew its place to 6 cm; with "
                     "an ordinary map it was 13 cm off and got lost in 2 of 10 drives."), shown
    # A large difference that may be chance is told as one.
    for win in (("patch", "occupancy", False, 0.07), ("patch", "filtered", True, 0.07)):
        doubted = tool.sentence(comparison([win], patch=(0.06, 0), occupancy=(0.13, 2),
                                           filtered=(0.13, 0)))
        assert doubted == ("In 10 drives the robot knew its place to 6 cm with the map that knows what "
                           "changes and to 13 cm with an ordinary map and got lost in 2 of 10 drives; "
                           "that is too little to be sure that it was not chance."), doubted
    # One of less than half a cell is none.
    none = tool.sentence(comparison([("patch", "occupancy", True, 0.02)], patch=(0.06, 0),
                                    occupancy=(0.08, 0)))
    assert none.startswith("Here it made no difference that matters"), none
    assert "6 cm" in none and "8 cm" in none, none
    # The ordinary map may be the best one.
    best = tool.sentence(comparison([("occupancy", "timescale", True, 1.9)], occupancy=(0.1, 0),
                                    timescale=(2.0, 4)))
    assert best == ("With an ordinary map the robot knew its place to 10 cm; with the map that "
                    "remembers lately and usually it was 2.0 m off and got lost in 4 of 10 "
                    "drives."), best
    # The least error is no praise when it is that of a robot that got lost.
    lost = tool.sentence(comparison([("patch", "occupancy", True, 3.0)], patch=(4.0, 5),
                                    occupancy=(7.0, 9)))
    assert lost.startswith("Here the robot got lost with every map"), lost


main()
