#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The small map and the last line of learn, localize and compare: on a terminal (util-linux' script makes
one), and not in a pipe.

usage: terminal_map_test.py STRATA SCENARIO WORK

Exits with 77 where there is no script.
"""
import os
import shlex
import shutil
import subprocess
import sys

TERMINAL = {"TERM": "xterm-256color", "LC_ALL": "C.UTF-8", "NO_COLOR": ""}


def environment(changes):
    return {**os.environ, **TERMINAL, **changes}


def on_terminal(command, columns=60, **changes):
    """What is written to a terminal of so many columns and 40 lines, line by line."""
    inside = f"stty cols {columns} rows 40; exec {shlex.join(command)}"
    result = subprocess.run(["script", "-qec", inside, "/dev/null"], env=environment(changes), text=True,
                            stdin=subprocess.DEVNULL, capture_output=True, check=False, encoding="utf-8")
    assert result.returncode == 0, result.stdout
    return result.stdout.replace("\r\n", "\n").rstrip("\n").split("\n")


def in_pipe(command):
    result = subprocess.run(command, env=environment({}), capture_output=True, check=True, encoding="utf-8")
    return result.stdout.rstrip("\n").split("\n")


def is_drawn(line):
    return any(0x2800 < ord(c) <= 0x28FF for c in line)


def width(line):
    return len(line.replace("\x1b[35m", "").replace("\x1b[0m", ""))


def looks_right(lines, last):
    drawn = [line for line in lines if is_drawn(line)]
    assert 4 <= len(drawn) <= 20, lines
    assert all(width(line) <= 60 for line in drawn), lines
    assert any("\x1b[35m" in line for line in drawn), "the way"
    size = next(i for i, line in enumerate(lines) if line.endswith(" m") and " m x " in line)
    assert is_drawn(lines[size - 1]) and not any(map(is_drawn, lines[size:])), lines
    assert last(lines[size + 1:]), lines[size + 1:]


def main():
    strata, scenario, work = sys.argv[1:4]
    if shutil.which("script") is None:
        return 77
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    os.chdir(work)
    subprocess.run([strata, "simulate", scenario, "--seed", "3", "--out", "world", "--quiet", "--set", "days=1"],
                   check=True)
    log, truth = ["world/log.clf"], ["--truth", "world/truth.tum"]
    learn = [strata, "learn", *log, *truth, "--out", "maps", "--force"]
    localize = [strata, "localize", *log, *truth, "--maps", "maps", "--out", "drive", "--force"]
    compare = [strata, "compare", *log, *truth, "--models", "occupancy,filtered", "--seeds", "1", "--out", "which",
               "--force", "--set", "protocol.memory_steps=0"]
    looks_right(on_terminal(learn), lambda said: len(said) == 1 and said[0].endswith("drawn in maps/map.png"))
    looks_right(on_terminal(localize), lambda said: len(said) == 1 and "drive/trajectory.png" in said[0])
    looks_right(on_terminal(compare), lambda said: len(said) == 2 and " mean error" in said[0] and
                "which/report.html" in said[1] and "which/replay.html" in said[1])
    for path in ("maps/map.png", "drive/trajectory.png", "drive/replay.html", "which/report.html", "which/replay.html"):
        assert os.path.getsize(path) > 500, path
    # Two buildings have a map each; what is merged has none, and says where the drive plays.
    os.symlink("log.clf", "world/other.clf")
    both = [strata, "compare", *log, "world/other.clf", *2 * truth, "--buildings", *compare[compare.index("--models"):]]
    said = on_terminal(both)
    assert sum(line.endswith(" m") and " m x " in line for line in said) == 2, said
    assert " mean error" in said[-2] and "which/report.html" in said[-1], said
    shard = [one.replace("which", "shard") for one in compare]
    subprocess.run([*shard, "--shard", "1/1", "--quiet"], check=True)
    said = on_terminal([strata, "compare", "--merge", "shard", "--out", "which", "--force"])
    assert len(said) == 2 and " mean error" in said[0] and "which/replay.html" in said[1], said
    # Nothing for who does not look.
    for command in (learn, localize, compare):
        said = in_pipe(command)
        assert len(said) == 1 and len(said[0]) > 40, said
        assert not is_drawn(said[0]) and "\x1b" not in said[0], said
    for command in (localize + ["--json"], compare + ["--json"], learn + ["--quiet"], localize + ["--quiet"],
                    compare + ["--quiet"]):
        assert not any(map(is_drawn, on_terminal(command))), command
    assert not any(map(is_drawn, on_terminal(localize, TERM="dumb")))
    assert not any(map(is_drawn, on_terminal(localize, LC_ALL="C")))
    plain = on_terminal(localize, NO_COLOR="1")
    assert any(map(is_drawn, plain)) and "\x1b[35m" not in "".join(plain), plain
    assert any("\u2022" in line for line in plain), plain
    return 0


if __name__ == "__main__":
    sys.exit(main())
