# SPDX-License-Identifier: Apache-2.0
"""A robot's process in a hall that is simulated, for tests that ask it over the network."""
import os
import shutil
import socket
import subprocess
import sys
import time

PATIENCE_S = 120

# The head of a composition of one process; its components follow.
ONE_PROCESS = """version: 1
transport: loopback
processes:
  - name: robot
    executor: multi_threaded
    components:
"""


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def listens(port):
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


def comes_true(condition, what):
    """Asks again until it holds; the answer that did."""
    until = time.monotonic() + PATIENCE_S
    while time.monotonic() < until:
        answer = condition()
        if answer:
            return answer
        time.sleep(0.1)
    sys.exit(f"does not come true: {what}")


def simulated(strata, hall, work):
    """A log of the hall, in a folder that is made anew."""
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    subprocess.run([strata, "simulate", hall, "--seed", "1", "--out", f"{work}/world", "--quiet"],
                   check=True)
    return f"{work}/world/log.clf"


def started(strata, composition, work, **names):
    """The process of a composition: a text with {names}."""
    with open(f"{work}/robot.yaml", "w") as out:
        out.write(composition.format(work=work, **names))
    return subprocess.Popen([strata, "run", f"{work}/robot.yaml", "--quiet"])


def site(strata, action, folder, *words):
    subprocess.run([strata, "site", action, folder, *words, "--quiet"], check=True)


def approve_version(strata, folder, maps, number=1):
    """Adds maps to a site as its version of that number, approved."""
    site(strata, "add", folder, maps)
    site(strata, "approve", folder, str(number), "--unchecked")
