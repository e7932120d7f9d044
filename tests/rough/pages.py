# SPDX-License-Identifier: Apache-2.0
"""The commands of the README and of docs/first-steps.md, as they are written, one after the other in
one folder. Logs and a robot are played; `tools/` and building are tried elsewhere."""
import os
import re
import shlex
import signal
import subprocess
import time

PATIENCE_S = 120
# Until Ctrl-C: what is told once it works.
LASTING = {"record": "recording into", "run": "runs; Ctrl-C ends it"}
# Of the robot that is played meanwhile, or of a clone.
SKIPPED = re.compile(r"tools/|cmake |git |sudo |PATH=|ros2 ")


def commands(source, page):
    """Of the blocks of the page, in order, without what they say of themselves."""
    with open(os.path.join(source, page)) as file:
        blocks = re.findall(r"(?ms)^```sh\n(.*?)^```", file.read())
    lines = [shlex.split(line, comments=True) for block in blocks for line in block.splitlines()]
    return [words for words in lines if words and not SKIPPED.match(" ".join(words))]


class Folder:
    """Where a new user works: beside the clone's components, with logs of a week."""

    def __init__(self, tries, material):
        self.tries = tries
        self.path = material.at("first_morning")
        os.makedirs(self.path)
        source = os.path.dirname(os.path.dirname(material.compositions))
        os.symlink(os.path.join(source, "components"), os.path.join(self.path, "components"))
        scenario = os.path.join(source, "tests/tools/strata/hall_with_doors.yaml")
        material.make("simulate", scenario, "--per-day", "--out", material.at("week"), "--quiet")
        for day, name in enumerate(("monday", "tuesday", "wednesday", "thursday", "friday"), 1):
            self.take(material.at(f"week/day_{day}/log.clf"), name + ".clf")
        self.take(material.at("week/log.clf"), "week.clf")  # of fewer days `topology` finds nothing
        self.environment = {**os.environ, "ROS_DOMAIN_ID": "196"}

    def take(self, path, name):
        os.symlink(path, os.path.join(self.path, name))

    def begin(self, words, told):
        return subprocess.Popen([self.tries.strata, *words], stdin=subprocess.DEVNULL, stdout=told,
                                stderr=subprocess.STDOUT, cwd=self.path, env=self.environment)

    def lasting(self, words):
        """Runs it beside a robot, then Ctrl-C; false when it does not begin or end well."""
        path = os.path.join(self.path, "told")
        with open(path, "w") as told:
            running = self.begin(words, told)
        end = time.monotonic() + PATIENCE_S
        while LASTING[words[0]] not in open(path).read():
            if running.poll() is not None or time.monotonic() > end:
                return False, open(path).read()
            time.sleep(0.05)
        is_alone = words[0] == "run" and "transport=default" not in words
        robot = ["play", "monday.clf", "--rate", "8"]
        with open(os.devnull, "w") as nowhere:
            played = self.begin(robot + (["--transport", "loopback"] if is_alone else []), nowhere)
        played.wait(PATIENCE_S)
        running.send_signal(signal.SIGINT)
        return played.returncode == 0 and running.wait(PATIENCE_S) == 0, open(path).read()


def run(tries, material):
    folder = Folder(tries, material)
    source = os.path.dirname(os.path.dirname(material.compositions))
    for page in ("README.md", "docs/first-steps.md"):
        done = 0
        for words in commands(source, page):
            if os.path.basename(words[0]) != "strata":
                continue
            words = ["monday.clf" if word == "PATH" else word for word in words[1:]]
            name = page + ": strata " + " ".join(words)
            if words[0] in LASTING:
                is_well, told = folder.lasting(words)
                tries.hold(name, is_well, told.strip().splitlines()[-1][:160] if told else "")
            else:
                # Without a robot on the domain, doctor tells that as an error.
                codes = (0, 1) if words[0] == "doctor" else 0
                tries.strata_try(name, words, codes, cwd=folder.path,
                                 shell="export ROS_DOMAIN_ID=196; exec STRATA",
                                 patience_s=5 * PATIENCE_S)  # `compare` takes minutes
            done += 1
        tries.hold(page + ": has commands", done > 4, str(done))
    for left in ("building", "office", "robot", "maps"):
        tries.strata_try(f"info {left}: maps", ["info", left], 0, "maps, as `strata learn` writes",
                         cwd=folder.path)
