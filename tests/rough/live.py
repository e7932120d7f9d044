# SPDX-License-Identifier: Apache-2.0
"""What once went wrong beside a robot: a log is played to components that run."""
import json
import os
import re
import signal
import socket
import sqlite3
import subprocess
import time

SCANS = 112  # of the simulated log
PATIENCE_S = 120


class Domain:
    """A DDS domain that no other test has, as tests/components/bus/domain.hpp claims them."""

    def __init__(self):
        for i in range(90):
            self.number = 10 + (os.getpid() + i) % 90
            self.claim = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
            try:
                self.claim.bind(f"\0strata-test-domain-{self.number}")
                return
            except OSError:
                self.claim.close()
        raise RuntimeError("every domain is taken by a test")


class Running:
    """A verb that runs until it is told to stop; its output goes into a file."""

    def __init__(self, strata, material, name, words, ready):
        self.path = material.at(name + ".told")
        with open(self.path, "w") as told:
            self.process = subprocess.Popen([strata, *words], stdin=subprocess.DEVNULL,
                                            stdout=told, stderr=subprocess.STDOUT)
        self.wait_for(lambda: re.search(ready, self.told()))

    def told(self):
        with open(self.path) as told:
            return told.read()

    def wait_for(self, holds):
        """Whether it comes true before the process ends and patience does."""
        end = time.monotonic() + PATIENCE_S
        while not holds():
            if self.process.poll() is not None or time.monotonic() > end:
                return False
            time.sleep(0.05)
        return True

    def stop(self):
        self.process.send_signal(signal.SIGINT)
        return self.process.wait(PATIENCE_S)


def run_composition(tries, material, name, file, domain, *more):
    words = ["run", file, "--set", f"domain={domain.number}", "--set", "transport=loopback", *more]
    return Running(tries.strata, material, name, words, "runs; Ctrl-C ends it")


def play(log, domain, *more):
    return ["play", log, "--transport", "loopback", "--domain", str(domain.number), *more]


def with_messages(material, name, topic, change):
    """The good bag, with the messages of a topic changed: change(bytes, place)."""
    path = material.write(name, material.bytes_of("good.db3"))
    with sqlite3.connect(path) as bag:
        number = bag.execute("SELECT id FROM topics WHERE name = ?", (topic,)).fetchone()[0]
        rows = bag.execute("SELECT id, data FROM messages WHERE topic_id = ? ORDER BY id",
                           (number,)).fetchall()
        bag.executemany("UPDATE messages SET data = ? WHERE id = ?",
                        [(change(data, i), row) for i, (row, data) in enumerate(rows)])
    return path


def nan_mounting(message, _):
    """A tf2_msgs/TFMessage of one transform as CDR, whose translation is NaN."""
    at = 4 + 4 + 8  # behind the encapsulation, the length of the list and the stamp
    for _ in ("frame_id", "child_frame_id"):
        at = (at + 3) // 4 * 4
        at += 4 + int.from_bytes(message[at:at + 4], "little")
    at = 4 + (at - 4 + 7) // 8 * 8
    return message[:at] + b"\0\0\0\0\0\0\xf8\x7f" * 3 + message[at + 24:]


def mounting_of_nan(tries, material):
    """Row 5: it is named and ignored, and the robot is mapped."""
    domain = Domain()
    folder = material.at("nan_maps")
    mapping = run_composition(tries, material, "nan_mapping", material.compositions +
                              "/mapping.yaml", domain, "--set", f"scan_matcher.maps.folder={folder}")
    bag = with_messages(material, "nan.db3", "/tf_static", nan_mounting)
    tries.strata_try("play: a mounting of NaN", play(bag, domain, "--rate", "8"), 0)
    code = mapping.stop()
    told = mapping.told()
    tries.hold("run ends well", code == 0, str(code))
    tries.hold("a mounting of NaN is named, with its frames",
               "/tf_static: the transform of laser in base_link is not finite" in told, told[-300:])
    summary = os.path.join(folder, "summary.json")
    scans = json.load(open(summary))["scans"] if os.path.exists(summary) else 0
    tries.hold("the robot is mapped all the same", scans > SCANS / 2, f"{scans} scans")
    if scans:
        out = tries.strata_try("its way is compared", ["evaluate", folder + "/trajectory.tum",
                               "--truth", material.truth, "--json"], 0)
        error_m = json.loads(out)["aligned"]["error_m"]["mean"]
        # The scanner sits 10 cm before the origin that it is taken to sit at.
        tries.hold("the way is right to 10 cm", error_m < 0.1, f"{error_m:.3f} m")


def empty_messages(tries, material):
    """Row 6: they are left out, and all others come."""
    domain = Domain()
    bag = with_messages(material, "nothing.db3", "/odom",
                        lambda data, i: b"" if i % 2 == 0 else data)
    heard = material.at("heard")
    recorder = Running(tries.strata, material, "heard", [
        "record", "--out", heard, "--transport", "loopback", "--domain", str(domain.number),
        "--topics", "/odom:nav_msgs/msg/Odometry", "/scan:sensor_msgs/msg/LaserScan"],
        "recording into")
    tries.strata_try("play: messages of 0 bytes", play(bag, domain, "--rate", "8"), 0)
    tries.hold("record ends well", recorder.stop() == 0, recorder.told()[-200:])
    out = tries.strata_try("info of what was heard", ["info", heard, "--json", "--quiet"], 0)
    counts = {name: entry["count"] for name, entry in json.loads(out)["messages"].items()}
    tries.hold("all scans but the first ones came", counts.get("/scan", 0) > SCANS / 2, str(counts))
    tries.hold("so did the odometry with content",
               SCANS / 4 < counts.get("/odom", 0) <= SCANS / 2, str(counts))


KEEPERS = """version: 1
processes:
  - name: keepers
    executor: multi_threaded
    components:
      - type: strata::ScanMatcher
        name: scan_matcher
        parameters: {maps: {folder: KEPT/maps}, store: {file: KEPT/scan_matcher.state, period_s: 1}}
      - type: strata::BeamFilter
        name: beam_filter
        parameters: {store: {file: KEPT/beam_filter.state, period_s: 1}}
      - type: strata::PatchLearner
        name: patch_learner
        parameters: {online: {store: {folder: KEPT/patch_learner}}}
      - {type: strata::TimescaleMemory, name: memory, parameters: {store: KEPT/memory.db}}
      - type: strata::TopologyMapper
        name: topology
        parameters: {store: {file: KEPT/topology.db}}
"""
# Of each file that one of them keeps: what `info` says of it.
KEPT = {"scan_matcher.state": "saved state of strata::ScanMatcher, version [0-9]+, ",
        "beam_filter.state": "saved state of strata::BeamFilter, version [0-9]+, ",
        "memory.db": "Strata store, version [0-9]+.*\n  timescale ",
        "topology.db": "Strata store, version [0-9]+.*\n  run ",
        "patch_learner/learner.state": "saved state of strata::PatchLearner, version [0-9]+, ",
        "patch_learner": "what components keep(.|\n)*learner.state, saved state"}


def stores_in_use(tries, material):
    """Row 12, and `info` of what components are writing: said as it is, again and again."""
    domain = Domain()
    kept = material.at("kept")
    os.makedirs(kept)
    composition = material.write("keepers.yaml", KEEPERS.replace("KEPT", kept))
    running = run_composition(tries, material, "keepers", composition, domain)
    playing = Running(tries.strata, material, "playing",
                      play(material.bag, domain, "--rate", "4", "--loop"), "playing")
    there = running.wait_for(lambda: all(os.path.exists(os.path.join(kept, name)) for name in KEPT))
    tries.hold("everybody keeps something", there, " ".join(os.listdir(kept)))
    # Tables come with the first commit.
    running.wait_for(lambda: "  timescale" in subprocess.run(
        [tries.strata, "info", kept + "/memory.db"], capture_output=True, text=True).stdout)
    running.wait_for(lambda: "  run" in subprocess.run(
        [tries.strata, "info", kept + "/topology.db"], capture_output=True, text=True).stdout)
    for i in range(5):
        for name, line in KEPT.items():
            tries.strata_try(f"info of {name} while it is written, {i + 1}",
                             ["info", os.path.join(kept, name)], 0, line)
            time.sleep(0.05)
    tries.strata_try("info of the folder of all", ["info", kept], 0,
                     "what components keep(.|\n)*beam_filter.state, saved state(.|\n)*"
                     "memory.db, Strata store(.|\n)*folder +patch_learner/")
    playing.stop()
    tries.hold("they are not disturbed", running.stop() == 0 and "error" not in running.told(),
               running.told()[-300:])
    for name, line in KEPT.items():
        tries.strata_try(f"info of {name} afterwards", ["info", os.path.join(kept, name)], 0, line)
    tries.strata_try("info of the maps that they kept", ["info", kept + "/maps"], 0,
                     "maps, as `strata learn` writes them")
