# SPDX-License-Identifier: Apache-2.0
"""What once went wrong without a word, each try by itself."""
import gzip
import os
import re
import signal
import sqlite3
import subprocess
import threading

SCANS = 112  # of the simulated log


def pipes(tries, material):
    """What cannot be read twice is read once, and whole."""
    log, at = material.log, material.at
    count = f"scans +{SCANS}"
    for name, source in (("a log", log), ("a packed log", at("packed.clf.gz")),
                         ("an MCAP file", at("good.mcap")), ("an SQLite bag", at("good.db3"))):
        if name == "a packed log":
            material.write("packed.clf.gz", gzip.compress(material.bytes_of("world/log.clf")))
        tries.strata_try(f"info <(cat {name})", ["info"], 0, count, f"STRATA <(cat '{source}')")
        tries.strata_try(f"cat {name} | info /dev/stdin", ["info"], 0, count,
                         f"cat '{source}' | STRATA /dev/stdin")
        tries.strata_try(f"cat {name} | learn /dev/stdin", ["learn", "--out", at("piped")], 0,
                         f"from {SCANS} scans", f"cat '{source}' | STRATA /dev/stdin")
        tries.strata_try(f"info /dev/stdin < {name}", ["info", "/dev/stdin"], 0, count,
                         f"STRATA < '{source}'")
        tries.strata_try(f"convert <({name})", ["convert"], 0, f"{SCANS} (scans|messages)|[0-9]+ me",
                         f"STRATA <(cat '{source}') '{at('piped.mcap')}'")
        tries.strata_try(f"info of what was converted from <({name})", ["info", at("piped.mcap")],
                         0, count)
    tries.strata_try("learn from two pipes", ["learn", "--out", at("piped")], 0,
                     f"from {2 * SCANS} scans",
                     f"STRATA <(cat '{log}') <(cat '{log}') --force")
    tries.strata_try("localize with pipes for log and truth",
                     ["localize", "--maps", at("maps"), "--out", at("piped_place")], 0, "",
                     f"STRATA <(cat '{log}') --truth <(cat '{material.truth}')")
    tries.strata_try("learn at poses from a pipe", ["learn", log, "--out", at("piped"), "--force"],
                     0, f"from {SCANS} scans", f"STRATA --poses <(cat '{material.truth}')")
    tries.strata_try("learn at poses of a log from a pipe",
                     ["learn", log, "--out", at("piped"), "--force"], 0, f"from {SCANS} scans",
                     f"STRATA --poses <(cat '{log}')")
    tries.strata_try("evaluate pipes", ["evaluate"], 0, "aligned",
                     f"STRATA <(cat '{material.truth}') --truth <(cat '{material.truth}')")
    tries.strata_try("settings from a pipe", ["learn", log, "--out", at("piped"), "--force"], 0,
                     "", "STRATA --config <(echo 'version: 1')")
    tries.strata_try("an empty pipe", ["info"], 2, "", "STRATA <(true)")
    tries.strata_try("a pipe of rubbish", ["info"], 2, "", "STRATA <(head -c 9999 /dev/zero)")
    tries.strata_try("a temporary folder that is missing", ["info"], 2, "TMPDIR|temporary|tmp",
                     f"export TMPDIR=/no/folder; STRATA <(cat '{log}')")
    left = [name for name in os.listdir("/tmp") if name.startswith("strata-spooled")]
    tries.hold("no copy of a pipe is left", not left, " ".join(left))


def stamps(tries, material):
    at = material.at
    late = material.write_log("late.clf", material.shifted(seconds=2.0**31))
    last = material.write_log("last.clf", material.shifted(seconds=2.0**31 - 10.0))
    early = material.write_log("early.clf", material.shifted(seconds=-2.0**31 - 1e6))
    mapping = material.compositions + "/mapping.yaml"
    line = "log: scan|clf: scan [0-9]+: its stamp -?[0-9.]+ s does not fit"
    for name, log in (("from 2^31 s on", late), ("over 2^31 s", last), ("before -2^31 s", early)):
        for to in ("mcap", "sqlite3"):
            tries.strata_try(f"convert to {to}: stamps {name}",
                             ["convert", log, at("late_bag"), "--to", to], 2, line)
        tries.strata_try(f"replay: stamps {name}",
                         ["replay", log, "--composition", mapping, "--out", at("late_out")], 2,
                         line)
        tries.strata_try(f"convert to carmen: stamps {name}",
                         ["convert", log, at("late_again.clf")], 0)
        tries.strata_try(f"info: stamps {name}", ["info", log], 0, f"scans +{SCANS}")
        tries.strata_try(f"learn: stamps {name}", ["learn", log, "--out", at("late_maps")], 0)
    old = material.write_log("old.clf", material.shifted(seconds=-1e6))
    tries.strata_try("convert to mcap: stamps before 1970", ["convert", old, at("old.mcap")], 1,
                     "/old.mcap/bag: MCAP has no stamps before 1970")
    tries.strata_try("convert to sqlite3: stamps before 1970", ["convert", old, at("old.db3")], 0)
    same = [material.lines[0]] + [line for line in material.lines[1:] for _ in range(2)]
    tries.strata_try("info: equal stamps", ["info", material.write_log("same.clf", same)], 0,
                     f"{SCANS} of {2 * SCANS} scans have the stamp of the one before")
    tries.strata_try("learn: equal stamps",
                     ["learn", at("same.clf"), "--out", at("same_maps")], 0,
                     "scans have the stamp of the one before")
    tries.strata_try("convert: equal stamps", ["convert", at("same.clf"), at("same.mcap")], 0,
                     "scans have the stamp of the one before")
    tries.strata_try("info of a bag: equal stamps", ["info", at("same.mcap")], 0,
                     "scans have the stamp of the one before")


def without_rotation(odometry):
    """A nav_msgs/Odometry as CDR whose quaternion is all zeros."""
    at = 12  # behind the encapsulation and the stamp
    for _ in ("frame_id", "child_frame_id"):
        at = (at + 3) // 4 * 4
        at += 4 + int.from_bytes(odometry[at:at + 4], "little")
    at = 4 + (at - 4 + 7) // 8 * 8 + 24  # behind the position
    return odometry[:at] + bytes(32) + odometry[at + 32:]


def rotations(tries, material):
    path = material.write("unset.db3", material.bytes_of("good.db3"))
    with sqlite3.connect(path) as bag:
        topic = bag.execute("SELECT id FROM topics WHERE name = '/odom'").fetchone()[0]
        rows = bag.execute("SELECT id, data FROM messages WHERE topic_id = ?", (topic,)).fetchall()
        bag.executemany("UPDATE messages SET data = ? WHERE id = ?",
                        [(without_rotation(data), row) for row, data in rows])
    line = f"{len(rows)} poses of the odometry have a quaternion of zeros"
    tries.strata_try("info: quaternions of zeros", ["info", path], 0, line)
    tries.strata_try("learn: quaternions of zeros",
                     ["learn", path, "--out", material.at("unset_maps")], 0, line)
    tum = [" ".join(row.split()[:4] + ["0"] * 4) for row in open(material.truth)]
    tries.strata_try("learn at poses with quaternions of zeros",
                     ["learn", material.log, "--poses", material.write_log("unset.tum", tum),
                      "--out", material.at("unset_maps")], 2, "unset.tum:1: is not a pose")


def positions(tries, material):
    at = material.at
    for metres in (1e3, 1e6, 1e8, 1e9, 1e12, 1e15):
        log = material.write_log("far.clf", material.shifted(metres=metres))
        line = "positions are taken from the first" if metres > 1e7 else "learned from"
        for verb in (["learn", log], ["localize", log, "--maps", at("maps")],
                     ["topology", log, "--landmarks", at("landmarks.txt")]):
            material.write("landmarks.txt", "1\n5\n9\n")
            tries.strata_try(f"{verb[0]}: odometry {metres:g} m from the origin",
                             [*verb, "--out", at(f"far_{verb[0]}")], 0,
                             line if verb[0] == "learn" else "")
        tries.strata_try(f"info: odometry {metres:g} m from the origin", ["info", log], 0)
    for metres in (1e6, 1e9, 1e18, 1e300):
        log = material.write_log("jump.clf", material.shifted(metres=metres, only=40))
        for verb in ("learn", "topology"):
            tries.strata_try(f"{verb}: a jump of {metres:g} m", [verb, log, "--out", at("jump")], 2,
                             "jump.clf: scan 41: its odometry is more than 100 km")
        tries.strata_try(f"learn --no-odometry: a jump of {metres:g} m",
                         ["learn", log, "--no-odometry", "--out", at("jump_matched")], 0)
    for metres in (1e9, 1e300):
        rows = [f"{line.split()[0]} {metres} 0 0" for line in open(material.truth)]
        poses = material.write_log("far.tum", rows)
        tries.strata_try(f"learn at poses {metres:g} m away",
                         ["learn", material.log, "--poses", poses, "--out", at("jump")], 2,
                         "far.tum: has poses more than")


def numbers(tries, material):
    """Fields of a log that are no number are named."""
    scans = [i for i, line in enumerate(material.lines) if line.startswith("ROBOTLASER1")]
    for field, value in ((9, "1,5"), (9, "1e999"), (9, "--"), (9, "0x1p3"), (2, "abc"), (8, "61.0"),
                         (8, "-1"), (8, "99999999999"), (8, "1e2"), (70, "inf"), (75, "nan"),
                         (-3, "soon"), (-3, "99999999999"), (-3, "1e400")):
        lines = list(material.lines)
        words = lines[scans[5]].split()
        words[field] = value
        lines[scans[5]] = " ".join(words)
        log = material.write_log("odd.clf", lines)
        place = re.escape(f"odd.clf:{scans[5] + 1}: ")
        tries.strata_try(f"info: field {field} is '{value}'", ["info", log], 0,
                         place + f"(field [0-9]+, '{re.escape(value)}', is no|the line is too|its)")
    packed = gzip.compress(material.bytes_of("world/log.clf"))
    for share in (30, 60, 90, 99):
        log = material.write("short.clf.gz", packed[:len(packed) * share // 100])
        for verb in (["info", log], ["learn", log, "--out", material.at("short_maps")]):
            tries.strata_try(f"{verb[0]}: {share}% of a packed log", verb, 0,
                             r"short.clf.gz:[0-9]+: the compressed file is cut or damaged")
    tum = gzip.compress(material.bytes_of("world/truth.tum"))
    poses = material.write("short.tum.gz", tum[:len(tum) // 2])
    tries.strata_try("learn at half of packed poses", ["learn", material.log, "--poses", poses,
                     "--out", material.at("short_maps")], 2, "the compressed file is cut")
    words = [f"WORD{i} 1 2 3" for i in range(100_000)]
    tries.strata_try("info: 100,000 different words",
                     ["info", material.write_log("words.clf", material.lines + words)], 0,
                     r"\(others\) [0-9]+")
    for low, high in ((0.65, 0.25), (-1, 0.65), (0.25, 7), ("nan", 0.65)):
        text = open(material.at("maps/occupancy.yaml")).read()
        text = re.sub(r"(?m)^occupied_thresh:.*$", f"occupied_thresh: {high}", text)
        text = re.sub(r"(?m)^free_thresh:.*$", f"free_thresh: {low}", text)
        given = material.write("maps/odd.yaml", text)
        tries.strata_try(f"compare: free_thresh {low}, occupied_thresh {high}",
                         ["compare", material.log, "--map", given, "--poses", material.truth,
                          "--seeds", "1", "--out", material.at("odd_map")], 2,
                         "thresh|odd.yaml:[0-9]+: bad conversion")
    os.remove(material.at("maps/odd.yaml"))


def names(tries, material):
    log = material.log
    before = material.bytes_of("world/log.clf")
    os.symlink(log, material.at("linked.clf"))
    os.link(log, material.at("hard.clf"))
    for out in (log, material.at("linked.clf"), material.at("hard.clf"),
                material.at("world/../world/log.clf")):
        tries.strata_try("convert a log over itself: " + os.path.basename(out),
                         ["convert", log, out], 1, "is the log to convert")
    tries.hold("the log is as it was", material.bytes_of("world/log.clf") == before)
    with open(material.compositions + "/mapping.yaml") as file:
        domain = re.sub(r"(?m)^domain:.*$", "", file.read()).split("processes:")[0]
    player = material.write("player.yaml", domain + """processes:
  - name: play
    components:
      - {type: strata::Player, name: player}
""")
    tries.strata_try("run: a Player without a log", ["run", player], (1, 2),
                     "player.yaml.*log is missing")
    # What an option says is done, or refused.
    for words in (["play", log, "--topics", "/scan"],
                  ["play", material.bag, "--mode", "robot", "--topics", "/scan"]):
        tries.strata_try("strata " + " ".join(words[2:]),
                         [*words, "--transport", "loopback", "--rate", "100"], 2,
                         "topics is for mode: messages")
    live_store(tries, material)


def live_store(tries, material):
    """A store that a program has open, with all of it in the write-ahead log."""
    path = material.at("live.db")
    with sqlite3.connect(material.at("maps/strata.db")) as kept:
        tables = "\n".join(kept.iterdump())
        marks = [kept.execute("PRAGMA " + name).fetchone()[0]
                 for name in ("application_id", "user_version")]
    writer = sqlite3.connect(path)
    writer.execute("PRAGMA journal_mode = WAL")
    writer.execute("PRAGMA wal_autocheckpoint = 0")
    writer.executescript(tables)
    writer.execute(f"PRAGMA application_id = {marks[0]}")
    writer.execute(f"PRAGMA user_version = {marks[1]}")
    writer.commit()
    tries.strata_try("info of a store that is being written", ["info", path], 0, "Strata store")
    tries.hold("its log is left alone", os.path.getsize(path + "-wal") > 0)
    writer.close()
    other = sqlite3.connect(material.at("other.db"))
    other.execute("CREATE TABLE a (b)")
    other.commit()
    tries.strata_try("info of somebody's SQLite file", ["info", material.at("other.db")], 2)
    other.close()


def two_at_once(tries, material):
    """Two that go on from one folder: the second waits, and no run is lost."""
    folder, log = material.at("both"), material.log
    material.make("learn", log, "--out", folder, "--quiet")
    names = [f"learn on at once, {i}" for i in range(4)]
    threads = [threading.Thread(target=tries.strata_try, args=(
        name, ["learn", log, "--update", folder, "--out", folder, "--again"], 0)) for name in names]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    info = subprocess.run([tries.strata, "info", folder + "/strata.db"], capture_output=True,
                          text=True).stdout
    runs = len(re.findall(r"(?m)^  run ", info))
    tries.hold("no run of four at once is lost", runs == 5, f"{runs} runs")


def left_over(tries, material):
    """What a process that was killed while it saved left is taken away by the next."""
    ended = subprocess.Popen(["true"])
    ended.wait()
    gone, here = ended.pid, os.getpid()
    jobs = {
        "saved": ["learn", material.log, "--out", material.at("saved")],
        "saved.clf": ["convert", material.log, material.at("saved.clf")],
        "saved.mcap": ["convert", material.log, material.at("saved.mcap")],
        "saved_bag": ["convert", material.log, material.at("saved_bag"), "--to", "mcap"],
        "saved_place": ["localize", material.log, "--maps", material.at("maps"), "--out",
                        material.at("saved_place")],
        "saved_world": ["simulate", material.scenario, "--out", material.at("saved_world")],
        "saved_messages": ["messages", material.at("saved_messages")],
        "saved_changes": ["changes", material.at("maps"), "--out", material.at("saved_changes")],
        "saved_keys": ["keystore", "create", material.at("saved_keys")],
    }
    for name, words in jobs.items():
        for process in (gone, here):
            os.makedirs(material.at(f".{name}.partial-{process}/inner"))
        os.makedirs(material.at(f".{name}.partial-mine"))
        tries.strata_try(f"{words[0]} to {name} beside what others left", words, 0)
        tries.hold(f"{name}: what a process left that is gone is away",
                   not os.path.exists(material.at(f".{name}.partial-{gone}")))
        tries.hold(f"{name}: what a process left that runs is there",
                   os.path.exists(material.at(f".{name}.partial-{here}")))
        tries.hold(f"{name}: what nobody of ours made is there",
                   os.path.exists(material.at(f".{name}.partial-mine")))


def interrupted(tries, material):
    """Ctrl-C: exit status 1, a true line, and nothing left."""
    long_log = material.write_log("long.clf", [
        line for day in range(120) for line in material.shifted(seconds=1000.0 * day)])
    before = sorted(os.listdir(material.work))
    running = subprocess.Popen([tries.strata, "learn", long_log, "--out", material.at("never")],
                               stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    for line in running.stderr:
        if "match scans" in line:
            break
    running.send_signal(signal.SIGINT)
    err = running.stderr.read()
    running.wait()
    faults = tries.faults(running.returncode, "", err, (1,),
                          "stopped on request, and nothing was changed; the same command begins")
    tries.judge("Ctrl-C in learn", faults, tries.told(running.returncode, "", err))
    tries.hold("Ctrl-C leaves nothing", sorted(os.listdir(material.work)) == before)
