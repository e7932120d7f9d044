#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The live page over TLS: who has the token gets in, from this machine and from another host.

usage: secure_view_test.py this_host|other_host STRATA HALL.yaml WORK
       secure_view_test.py ask ADDRESS PORT CERTIFICATE  (on the other host; answers in JSON)

Exits with 77 where a network with another host cannot be made (needs root and veth devices).
"""
import json
import os
import socket
import ssl
import subprocess
import sys

from robot_process import PATIENCE_S, comes_true, free_port, listens, simulated

TOKEN = "0123456789abcdef-for-tests"
OURS, OTHERS = "10.78.5.1", "10.78.5.2"


def make_certificate(work, name="robot"):
    paths = [f"{work}/{name}.{ending}" for ending in ("crt", "key")]
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1",
         "-nodes", "-days", "2", "-subj", "/CN=robot", "-addext",
         f"subjectAltName=DNS:robot,IP:127.0.0.1,IP:{OURS}", "-out", paths[0], "-keyout", paths[1]],
        check=True, capture_output=True)
    return paths


def exchange(address, port, context, target, more=""):
    """The first line of the answer, or what went wrong. context: None for plain HTTP."""
    request = f"GET {target} HTTP/1.1\r\nHost: robot:{port}\r\n{more}\r\n".encode()
    try:
        with socket.create_connection((address, port), timeout=PATIENCE_S) as plain:
            stream = plain if context is None else context.wrap_socket(plain, server_hostname=address)
            stream.sendall(request)
            return stream.makefile("rb").readline().decode().strip() or "nothing"
    except OSError as error:
        return type(error).__name__


def ask(address, port, certificate):
    """What this host is answered."""
    trusting = ssl.create_default_context(cafile=certificate)
    old = ssl.create_default_context(cafile=certificate)
    old.minimum_version, old.maximum_version = ssl.TLSVersion.TLSv1, ssl.TLSVersion.TLSv1_1
    old.set_ciphers("ALL:@SECLEVEL=0")
    viewer = ("Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
              "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
              "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n")
    with_token = f"/?token={TOKEN}"
    return {
        "page": exchange(address, port, trusting, with_token),
        "bearer": exchange(address, port, trusting, "/", f"Authorization: Bearer {TOKEN}\r\n"),
        "viewer": exchange(address, port, trusting, with_token, viewer),
        "metrics": exchange(address, port, trusting, f"/metrics?token={TOKEN}"),
        "no token": exchange(address, port, trusting, "/"),
        "wrong token": exchange(address, port, trusting, with_token + "x"),
        "viewer without token": exchange(address, port, trusting, "/", viewer),
        "metrics without token": exchange(address, port, trusting, "/metrics"),
        "untrusting": exchange(address, port, ssl.create_default_context(), with_token),
        "plain": exchange(address, port, None, with_token),
        "old TLS": exchange(address, port, old, with_token),
    }


def require_safe(said):
    for who in ("page", "bearer", "metrics"):
        assert said[who] == "HTTP/1.1 200 OK", (who, said)
    assert said["viewer"] == "HTTP/1.1 101 Switching Protocols", said
    for who in ("no token", "wrong token", "viewer without token", "metrics without token"):
        assert said[who] == "HTTP/1.1 401 Unauthorized", (who, said)
    assert said["untrusting"] == "SSLCertVerificationError", said
    assert not said["plain"].startswith("HTTP/1.1 2"), said
    assert not said["old TLS"].startswith("HTTP/1.1"), said


class Robot:
    """Shows maps on every network of this host."""

    def __init__(self, strata, work):
        self.certificate, key = make_certificate(work)
        self.port = free_port()
        self.process = subprocess.Popen(
            [strata, "view", f"{work}/maps", "--port", str(self.port), "--quiet", "--set",
             "address=0.0.0.0", "--set", f"token={TOKEN}", "--set",
             f"certificate={self.certificate}", "--set", f"private_key={key}"])
        comes_true(lambda: listens(self.port), "the live view listens")

    def end(self):
        self.process.terminate()
        self.process.wait()


def test_refusals(strata, work):
    """What is not safe does not start."""
    certificate, key = make_certificate(work)
    other, other_key = make_certificate(work, "other")
    pair = [f"certificate={certificate}", f"private_key={key}"]
    for settings, word in (
            (["address=0.0.0.0", f"token={TOKEN}"], "certificate"),
            (["address=0.0.0.0", *pair], "token"),
            (["address=0.0.0.0", f"token={TOKEN}", pair[0]], "private_key"),
            (["address=0.0.0.0", "token=short", *pair], "token"),
            ([pair[0], f"private_key={other_key}"], "private_key"),
            ([pair[1], f"certificate={work}/robot.key"], "certificate"),
            ([pair[1], f"certificate={work}/missing.crt"], "missing.crt cannot be read")):
        command = [strata, "view", f"{work}/maps", "--port", str(free_port())]
        for one in settings:
            command += ["--set", one]
        run = subprocess.run(command, capture_output=True, text=True, timeout=PATIENCE_S)
        assert run.returncode == 2 and word in run.stderr, (settings, run)


class OtherHost:
    """A network of its own, joined to this one by a cable."""

    def __init__(self):
        if os.geteuid() != 0:
            self.skip("not root")
        self.holder = subprocess.Popen(["unshare", "--net", "sh", "-c", "echo ready && exec cat"],
                                       stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.holder.stdout.readline()
        pid = str(self.holder.pid)
        there = ["nsenter", "--target", pid, "--net"]
        for words in (["ip", "link", "add", "viewhost0", "type", "veth", "peer", "name",
                       "viewhost1", "netns", pid],
                      ["ip", "address", "add", f"{OURS}/24", "dev", "viewhost0"],
                      ["ip", "link", "set", "viewhost0", "up"],
                      [*there, "ip", "address", "add", f"{OTHERS}/24", "dev", "viewhost1"],
                      [*there, "ip", "link", "set", "viewhost1", "up"]):
            made = subprocess.run(words, capture_output=True, text=True)
            if made.returncode != 0:
                self.end()
                self.skip(made.stderr.strip())
        self.there = there

    @staticmethod
    def skip(why):
        print(f"skipped: another host cannot be made: {why}")
        sys.exit(77)

    def run(self, command):
        return subprocess.run([*self.there, *command], check=True, capture_output=True, text=True)

    def end(self):
        self.holder.stdin.close()  # its network ends with it, and the cable
        self.holder.wait()


def main():
    if sys.argv[1] == "ask":
        print(json.dumps(ask(sys.argv[2], int(sys.argv[3]), sys.argv[4])))
        return
    mode, strata, hall, work = sys.argv[1:5]
    other = OtherHost() if mode == "other_host" else None
    log = simulated(strata, hall, work)
    subprocess.run([strata, "learn", log, "--only", "em", "--out", f"{work}/maps", "--quiet"],
                   check=True)
    if other is None:
        test_refusals(strata, work)
    robot = Robot(strata, work)
    try:
        if other is None:
            require_safe(ask("127.0.0.1", robot.port, robot.certificate))
        else:
            said = other.run([sys.executable, os.path.abspath(__file__), "ask", OURS,
                              str(robot.port), robot.certificate]).stdout
            require_safe(json.loads(said))
    finally:
        robot.end()
        if other is not None:
            other.end()


main()
