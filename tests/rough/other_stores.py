# SPDX-License-Identifier: Apache-2.0
"""A component's store that names a file of another: refused by its setting, and left as it is."""
import os
import shutil

COMPONENTS = {"ScanMatcher": "store: {file: FILE}", "BeamFilter": "store: {file: FILE}",
              "TopologyMapper": "store: {file: FILE}", "VolumeMapper": "store: FILE",
              "Localizer": "start: {store: {file: FILE}}"}


def run(tries, material):
    for component, parameter in COMPONENTS.items():
        maps = material.at("kept_maps")
        shutil.rmtree(maps, ignore_errors=True)
        shutil.copytree(material.at("maps"), maps)
        file = maps + "/strata.db"
        before = material.bytes_of("kept_maps/strata.db")
        composition = material.write("slip.yaml", "version: 1\ntransport: loopback\nprocesses:\n"
                                     "  - name: slip\n    components:\n"
                                     f"      - {{type: strata::{component}, name: slip, parameters: "
                                     f"{{{parameter.replace('FILE', file)}}}}}\n")
        for more in ([], ["--check"]):
            tries.strata_try(f"run {' '.join(more)}: a {component} that keeps its state in strata.db",
                             ["run", composition, "--set", "domain=197", *more], 2,
                             "strata.db: is another file than [a-z.]*store[a-z.]* may name: this is "
                             "the .*; name another file in ")
            tries.hold(f"{component}: strata.db is as it was", sorted(os.listdir(maps)) ==
                       sorted(os.listdir(material.at("maps"))) and
                       material.bytes_of("kept_maps/strata.db") == before,
                       " ".join(os.listdir(maps)))
