# SPDX-License-Identifier: Apache-2.0
"""What nights.py measures of released maps: their frame, what they show, and what it all comes to."""
import math
import os
import sqlite3

# Where the cabinet and the shelf stand or stood, in the hall's frame, with a margin.
PLACES = {"cabinet_old": (7.9, 7.2, 9.3, 7.9), "cabinet_new": (10.4, 4.9, 11.4, 6.3), "shelf": (5.1, 4.1, 6.9, 4.7)}


def contents(path):
    """All rows of a store; nothing where SQLite cannot read it."""
    try:
        store = sqlite3.connect(f"file:{path}?mode=ro", uri=True)
        tables = [row[0] for row in store.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
        return {table: store.execute(f'SELECT * FROM "{table}"').fetchall() for table in tables}
    except (sqlite3.Error, UnicodeDecodeError, OverflowError):
        return None


def poses(path):
    with open(path) as file:
        rows = [line.split() for line in file if line.strip() and line[0] != "#"]
    return {round(float(row[0]), 3): (float(row[1]), float(row[2])) for row in rows}


def rigid(pairs):
    """(turn, x, y) that brings the firsts onto the seconds with the least squares."""
    count = len(pairs)
    ax, ay = (sum(a[i] for a, _ in pairs) / count for i in (0, 1))
    bx, by = (sum(b[i] for _, b in pairs) / count for i in (0, 1))
    sine = sum((a[0] - ax) * (b[1] - by) - (a[1] - ay) * (b[0] - bx) for a, b in pairs)
    cosine = sum((a[0] - ax) * (b[0] - bx) + (a[1] - ay) * (b[1] - by) for a, b in pairs)
    turn = math.atan2(sine, cosine)
    x, y = moved((turn, 0.0, 0.0), (ax, ay))
    return turn, bx - x, by - y


def moved(frame, point):
    sine, cosine = math.sin(frame[0]), math.cos(frame[0])
    return (frame[1] + cosine * point[0] - sine * point[1], frame[2] + sine * point[0] + cosine * point[1])


def moved_back(frame, point):
    return moved((-frame[0], 0.0, 0.0), (point[0] - frame[1], point[1] - frame[2]))


def read_map(path):
    with open(path) as file:
        words = dict(line.split(":", 1) for line in file if ":" in line)
    origin = [float(word) for word in words["origin"].strip(" []\n").split(",")]
    with open(os.path.join(os.path.dirname(path), words["image"].strip()), "rb") as file:
        magic, width, height, _, cells = file.read().split(maxsplit=4)
    assert magic == b"P5"
    return (int(width), int(height)), float(words["resolution"]), origin, cells


def summary(results, nights):
    taken = [one for one in results if one["taken"]]
    worse = [one["night"] for one in taken if "before_m" in one and
             (one["error_m"] > one["before_m"] + 0.02 or (one["lost"] and not one["before_lost"]))]

    def delay(day, place, shows):
        """Nights after which what is active shows something there, or nothing any more, for good."""
        nights_so = [one["night"] for one in results if one["night"] >= day and "shows" in one and
                     (one["shows"][place] >= 5) != shows]
        return (max(nights_so) + 1 - day) if nights_so else 0

    tenth = max(1, len(results) // 10)
    frames = [one for one in results if "frame_moved_m" in one]

    return {"nights": len(results), "releases": len(taken),
            "bad_nights_released": [one["night"] for one in taken if one["bad"]],
            "releases_in_which_the_next_day_is_worse": worse,
            "good_nights_refused": [one["night"] for one in results if not one["bad"] and not one["taken"]],
            "nights_until_the_cabinet_is_in_its_new_place": delay(nights.moved, "cabinet_new", True),
            "nights_until_it_is_gone_from_the_old": delay(nights.moved, "cabinet_old", False),
            "nights_until_the_new_shelf": delay(nights.came, "shelf", True),
            "frame_moved_at_most_m": max(one["frame_moved_m"] for one in frames),
            "frame_turned_at_most_deg": max(abs(one["frame_turned_deg"]) for one in frames),
            "learn_s_first_and_last_tenth": [round(sum(one["learn_s"] for one in part) / tenth, 2)
                                             for part in (results[:tenth], results[-tenth:])],
            "store_mb_last": results[-1]["store_mb"],
            "mean_error_m": round(sum(one["error_m"] for one in results) / len(results), 4),
            "days_lost": sum(one["lost"] for one in results),
            "longest_take_s": max(one["take_s"] for one in results)}
