#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Rough tries: what users and disks do to a program. usage: tries.py STRATA SOURCE_DIR GROUP

A line a try: whether the exit status, the line that it says and what it leaves are as they must
be. Fails when one of them is not. Of tables of options by values and of verbs by damages a third is
tried; with STRATA_EVERY_TRY=1 in the environment, all."""
import os
import shutil
import sys
import tempfile

import damaged_logs
import elsewhere
import elsewhere_live
import json_output
import live
import memory
import odd_options
import other_stores
import outputs
import pages
import pictures
import table
from material import Material
from runner import Tries

GROUPS = {
    "damaged_logs": [damaged_logs.run, damaged_logs.unreadable, damaged_logs.cut_anywhere],
    "odd_options": [odd_options.run],
    "outputs": [outputs.cannot_be_written, outputs.of_another_kind, outputs.of_the_users,
                outputs.with_more_runs, pictures.run, other_stores.run],
    "memory": [memory.run],
    "live": [live.mounting_of_nan, live.empty_messages, live.stores_in_use],
    "pages": [pages.run, json_output.run],
    "elsewhere": [elsewhere.run, elsewhere_live.run],
    "table": [table.pipes, table.stamps, table.rotations, table.positions, table.numbers,
              table.names, table.two_at_once, table.left_over, table.interrupted],
}


def main():
    strata, source, group = sys.argv[1:]
    work = tempfile.mkdtemp(prefix="strata-rough-")
    os.chmod(work, 0o755)  # some of the tries are another user's
    try:
        tries = Tries(strata)
        material = Material(strata, source, work)
        for part in GROUPS[group]:
            part(tries, material)
        return tries.end()
    finally:
        shutil.rmtree(work, ignore_errors=True)


if __name__ == "__main__":
    sys.exit(main())
