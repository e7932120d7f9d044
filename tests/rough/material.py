# SPDX-License-Identifier: Apache-2.0
"""A small simulated building, what is learned from it, and damaged forms of both."""
import gzip
import os
import random
import subprocess


class Material:
    """Files in a folder that everybody may read."""

    def __init__(self, strata, source, work):
        self.strata = strata
        self.work = work
        scenarios = os.path.join(source, "tools/simulate/scenarios")
        self.scenario = os.path.join(scenarios, "empty_room.yaml")
        self.compositions = os.path.join(source, "components/config")
        self.make("simulate", self.scenario, "--out", self.at("world"), "--quiet")
        self.log = self.at("world/log.clf")
        self.bag = self.at("world/bag")
        self.truth = self.at("world/truth.tum")
        self.lines = open(self.log).read().splitlines()
        self.make("convert", self.log, self.at("good.mcap"), "--quiet")
        self.make("convert", self.log, self.at("good.db3"), "--quiet")
        with open(os.path.join(source, "tests/fuzz/corpus/bag/ros1_lz4.bag"), "rb") as bag:
            self.write("good.bag", bag.read())
        self.make("learn", self.log, "--out", self.at("maps"), "--quiet")

    def at(self, name):
        return os.path.join(self.work, name)

    def make(self, *arguments):
        subprocess.run([self.strata, *arguments], check=True, stdout=subprocess.DEVNULL)

    def write(self, name, content):
        mode = "wb" if isinstance(content, bytes) else "w"
        with open(self.at(name), mode) as file:
            file.write(content)
        return self.at(name)

    def write_log(self, name, lines):
        return self.write(name, "".join(line + "\n" for line in lines))

    def bytes_of(self, name):
        with open(self.at(name), "rb") as file:
            return file.read()

    def shifted(self, seconds=0.0, metres=0.0, only=None):
        """The log with other stamps or odometry. only: the place of the one scan to change."""
        scans = [i for i, line in enumerate(self.lines) if line.startswith("ROBOTLASER1")]
        lines = list(self.lines)
        for place in scans if only is None else [scans[only]]:
            lines[place] = shifted_scan(lines[place], seconds, metres)
        return lines

    def damaged(self):
        """Files that are no log, or hold nothing to work with, by what is wrong with them."""
        rubbish = random.Random(1).randbytes(5000)
        packed = gzip.compress("\n".join(self.lines).encode())
        mcap = self.bytes_of("good.mcap")
        db3 = self.bytes_of("good.db3")
        ros1 = self.bytes_of("good.bag")
        header = [line for line in self.lines if not line.startswith("ROBOTLASER1")]
        os.makedirs(self.at("empty_folder"), exist_ok=True)
        os.makedirs(self.at("folder_of_rubbish"), exist_ok=True)
        self.write("folder_of_rubbish/bag.db3", rubbish)
        for name, target in (("dangling", "nowhere"), ("loop", "loop")):
            if not os.path.lexists(self.at(name)):
                os.symlink(target, self.at(name))
        return {
            "missing": self.at("missing.clf"),
            "missing folder": self.at("no/such/folder/log.clf"),
            "empty name": "",
            "empty": self.write("empty.clf", ""),
            "empty bag": self.write("empty.mcap", b""),
            "blank lines": self.write("blank.clf", "\n" * 500),
            "rubbish": self.write("rubbish.clf", rubbish),
            "rubbish as gzip": self.write("rubbish.gz", b"\x1f\x8b" + rubbish),
            "zeros": self.write("zeros.clf", bytes(5000)),
            "words": self.write("words.txt", "hello world\n" * 300),
            "one long line": self.write("long_line.clf", "x" * 3_000_000),
            "json": self.write("some.json", '{"a": [1, 2, 3]}\n'),
            "picture": self.write("some.png", b"\x89PNG\r\n\x1a\n" + rubbish),
            "no scan": self.write_log("header.clf", header),
            "scans of nan": self.write_log("nan.clf", [nan_scan(line) for line in self.lines]),
            "half a line": self.write("half.clf", "ROBOTLASER1 0 -1.57 3.14"),
            "gzip cut at once": self.write("cut_begin.clf.gz", packed[:30]),
            "mcap cut at once": self.write("cut_begin.mcap", mcap[:20]),
            "mcap of rubbish": self.write("rubbish.mcap", mcap[:8] + rubbish),
            "sqlite cut at once": self.write("cut_begin.db3", db3[:300]),
            "sqlite of rubbish": self.write("rubbish.db3", db3[:100] + rubbish),
            "bag of ROS 1 cut at once": self.write("cut_begin.bag", ros1[:4200]),
            "bag of ROS 1 cut in its first line": self.write("cut_line.bag", ros1[:10]),
            "bag of ROS 1 of rubbish": self.write("rubbish.bag", ros1[:13] + rubbish),
            "bag of ROS 1 of 2009": self.write("old.bag", b"#ROSRECORD V1.2\n" + rubbish),
            "empty folder": self.at("empty_folder"),
            "folder of rubbish": self.at("folder_of_rubbish"),
            "long name": self.at("n" * 300 + ".clf"),
            "below a file": self.log + "/log.clf",
            "dangling link": self.at("dangling"),
            "link to itself": self.at("loop"),
            "zero device": "/dev/zero",
            "null device": "/dev/null",
        }


def numbers_of(line):
    """The words of a scan, and where its two poses and its stamp are."""
    words = line.split()
    readings = int(words[8])
    after = 9 + readings
    poses = after + 1 + int(words[after])
    return words, readings, poses, poses + 11


def shifted_scan(line, seconds, metres):
    words, _, poses, stamp = numbers_of(line)
    for place in (poses, poses + 3):
        words[place] = repr(float(words[place]) + metres)
    words[stamp] = f"{float(words[stamp]) + seconds:.6f}"
    return " ".join(words)


def nan_scan(line):
    if not line.startswith("ROBOTLASER1"):
        return line
    words, readings, _, _ = numbers_of(line)
    words[9:9 + readings] = ["nan"] * readings
    return " ".join(words)
