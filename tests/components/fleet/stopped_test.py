#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A server that is stopped while somebody logs in is down (1); one that refuses a password is not (2).

usage: stopped_test.py STRATA
"""
import socket
import struct
import subprocess
import sys
import threading

ASKS_FOR_A_PASSWORD = b"R" + struct.pack("!ii", 8, 3)


def refusal(sqlstate, text):
    """An ErrorResponse of PostgreSQL's protocol, version 3."""
    fields = b"".join(key + value.encode() + b"\0" for key, value in
                      ((b"S", "FATAL"), (b"V", "FATAL"), (b"C", sqlstate), (b"M", text)))
    return b"E" + struct.pack("!i", len(fields) + 5) + fields + b"\0"


def read_exactly(client, count):
    data = b""
    while len(data) < count:
        part = client.recv(count - len(data))
        if not part:
            sys.exit("the client went away")
        data += part
    return data


def read_message(client):
    return read_exactly(client, struct.unpack("!i", read_exactly(client, 4))[0] - 4)


def asked(strata, answer):
    """Exit code and words of who asks a server that takes the password, and then answers that."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        def serve():
            client, _ = server.accept()
            with client:
                read_message(client)
                client.sendall(ASKS_FOR_A_PASSWORD)
                read_exactly(client, 1)
                read_message(client)
                client.sendall(answer)
        thread = threading.Thread(target=serve)
        thread.start()
        url = (f"postgresql://ada:secret@127.0.0.1:{server.getsockname()[1]}/fleet"
               "?sslmode=disable&gssencmode=disable")
        done = subprocess.run([strata, "fleet", "status", url, "--site", "hall"], capture_output=True, text=True)
        thread.join()
    return done.returncode, done.stderr


def main():
    strata, = sys.argv[1:]
    for sqlstate, text, expected in (
            ("57P01", "terminating connection due to administrator command", 1),
            ("57P03", "the database system is shutting down", 1),
            ("28P01", "password authentication failed for user \"ada\"", 2)):
        code, said = asked(strata, refusal(sqlstate, text))
        if code != expected or text not in said:
            sys.exit(f"{text}: {code} in place of {expected}: {said}")


if __name__ == "__main__":
    main()
