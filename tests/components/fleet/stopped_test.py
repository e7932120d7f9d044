#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A server that is stopped while somebody logs in is one that is down (1), not a wrong password (2).

usage: stopped_test.py STRATA WORK
"""
import os
import subprocess
import sys
import threading
import time

from fleet_server import SITE, FleetServer, programs

ROUNDS = 12
AT_ONCE = 6


def main():
    strata, work = sys.argv[1:]
    if programs() is None:
        sys.exit("there is no PostgreSQL, and CI is set" if "CI" in os.environ else 77)
    server = FleetServer(strata, work)
    codes, wrong = [], []

    def ask_until_it_is_down():
        while True:
            done = subprocess.run([strata, "fleet", "status", server.url("admin", "secret"), "--site", SITE],
                                  capture_output=True, text=True)
            codes.append(done.returncode)
            if done.returncode == 0:
                continue
            if done.returncode != 1:
                wrong.append(f"{done.returncode}: {done.stderr}")
            return

    for _ in range(ROUNDS):
        before = len(codes)
        threads = [threading.Thread(target=ask_until_it_is_down) for _ in range(AT_ONCE)]
        for thread in threads:
            thread.start()
        while len(codes) - before < AT_ONCE:  # all of them are at it
            time.sleep(0.01)
        server.stop()
        for thread in threads:
            thread.join()
        server.start()
    server.stop()
    if wrong or 0 not in codes:
        sys.exit(f"{len(wrong)} of {len(codes)} answers: {wrong[:3]}")


if __name__ == "__main__":
    main()
