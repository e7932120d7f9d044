# SPDX-License-Identifier: Apache-2.0
"""A picture that cannot be drawn costs no result, in any verb that draws."""
import os

import outputs

# Drawn by rsvg-convert, which is not there.
OF_PLOTS = {"topology": "topologies.png, landmarks.png", "compare": "more"}
MISSING = "warning: all results are there but for pictures .*rsvg-convert.*install librsvg2-bin"


def run(tries, material):
    outputs.prepare(material)
    for verb, (words, _) in outputs.verbs_of(material).items():
        out = material.at("undrawn_" + verb)
        told = tries.strata_try(f"{verb} without rsvg-convert", [*words, "--quiet", "--out", out],
                                0, MISSING if verb in OF_PLOTS else "",
                                "export PATH=/nowhere; exec STRATA")
        tries.hold(f"{verb}: what is missing is told", OF_PLOTS.get(verb, "") in told, told[-300:])
        whole = material.at("drawn_" + verb)
        tries.strata_try(f"{verb} with it", [*words, "--quiet", "--out", whole], 0)
        lacks = set(os.listdir(whole)) - set(os.listdir(out))
        tries.hold(f"{verb}: only pictures are missing",
                   all(name.endswith(".png") for name in lacks), " ".join(sorted(lacks)))
