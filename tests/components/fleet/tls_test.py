#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Robots that check the server's certificate speak to no other server.

usage: tls_test.py STRATA WORK
"""
import os
import subprocess
import sys

from fleet_server import SITE, FleetServer, make_certificate, programs


def status(strata, url):
    done = subprocess.run([strata, "fleet", "status", url, "--site", SITE], capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def expect(condition, what):
    if not condition:
        sys.exit(f"failed: {what}")


def main():
    strata, work = sys.argv[1:]
    if programs() is None:
        expect("CI" not in os.environ, "there is no PostgreSQL, and CI is set")
        sys.exit(77)
    server = FleetServer(strata, work)
    try:
        code, text = status(strata, server.url("admin", "secret"))
        expect(code == 0 and "encrypted" in text and "not encrypted" not in text, f"its own certificate: {text}")
        code, text = status(strata, server.url("admin", "secret", tls="sslmode=disable"))
        expect(code == 0 and "not encrypted" in text, f"without TLS that is said: {text}")
        make_certificate(f"{work}/other")
        for url in (server.url("admin", "secret", certificate=f"{work}/other.crt"),
                    server.url("admin", "secret", certificate=f"{work}/nothing.crt"),
                    server.url("admin", "secret", host="127.0.0.1")):
            code, text = status(strata, url)
            expect(code == 2 and "sslrootcert" in text and "secret" not in text, f"{url}: {code} {text}")
    finally:
        server.stop()


if __name__ == "__main__":
    main()
