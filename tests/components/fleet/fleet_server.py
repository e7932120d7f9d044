# SPDX-License-Identifier: Apache-2.0
"""A PostgreSQL server with TLS and a fleet's tables."""
import glob
import json
import os
import pwd
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../tools/strata"))
from robot_process import free_port  # noqa: E402

SITE = "hall"


def ran(command, **more):
    """Its output; ends the program where it fails."""
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **more)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}: {done.stdout}")
    return done.stdout


def make_certificate(name):
    """NAME.crt and NAME.key, for the host localhost, by nobody but itself."""
    ran(["openssl", "req", "-new", "-x509", "-days", "2", "-nodes", "-subj", "/CN=localhost",
         "-addext", "subjectAltName=DNS:localhost", "-out", f"{name}.crt", "-keyout", f"{name}.key"])


def programs():
    """Debian's newest; nothing without its package."""
    return max(glob.glob("/usr/lib/postgresql/*/bin"), default=None)


class FleetServer:
    """Made anew in `folder`, of Debian's package; as its user where we are root, as it wants."""

    def __init__(self, strata, folder):
        self.strata, self.folder, self.port = strata, folder, free_port()
        self.programs = programs()
        self.data = f"{folder}/data"
        shutil.rmtree(folder, ignore_errors=True)
        os.makedirs(folder)
        self.certificate = f"{folder}/server.crt"
        make_certificate(f"{folder}/server")
        with open(f"{folder}/secret", "w") as secret:
            secret.write("secret\n")
        os.chmod(f"{folder}/server.key", 0o600)
        self.as_user = []
        if os.geteuid() == 0:
            user = pwd.getpwnam("postgres")
            for path in ("", "/server.crt", "/server.key", "/secret"):
                os.chown(folder + path, user.pw_uid, user.pw_gid)
            self.as_user = ["setpriv", "--reuid=postgres", "--regid=postgres", "--clear-groups"]
        ran(self.as_user + [f"{self.programs}/initdb", "-D", self.data, "-U", "admin", "-A", "scram-sha-256",
                            "-E", "UTF8", "--locale=C", f"--pwfile={folder}/secret"], cwd="/")
        options = {"port": self.port, "unix_socket_directories": folder, "listen_addresses": "localhost",
                   "ssl": "on", "ssl_cert_file": self.certificate, "ssl_key_file": f"{folder}/server.key",
                   "logging_collector": "on"}
        self.command = self.as_user + [f"{self.programs}/postgres", "-D", self.data]
        self.command += [word for name, value in options.items() for word in ("-c", f"{name}={value}")]
        self.start()
        self.fleet("init", self.url("admin", "secret"), "--site", SITE)

    def start(self):
        """Until it answers."""
        self.process = subprocess.Popen(self.command, cwd="/", stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while subprocess.run([f"{self.programs}/pg_isready", "-q", "-h", "localhost", "-p", str(self.port)]).returncode:
            time.sleep(0.1)

    def url(self, role, password, host="localhost", tls="sslmode=verify-full", certificate=None):
        return (f"postgresql://{role}:{password}@{host}:{self.port}/postgres"
                f"?{tls}&sslrootcert={certificate or self.certificate}")

    def fleet(self, *words):
        return ran([self.strata, "fleet", *words, "--quiet"])

    def add(self, kind, name):
        """The URL of a new robot or operator."""
        told = json.loads(self.fleet(f"add-{kind}", self.url("admin", "secret"), "--site", SITE, name, "--json"))
        return self.url(told["role"], told["password"])

    def sql(self, statement):
        return ran([f"{self.programs}/psql", "-X", "-A", "-t", self.url("admin", "secret"), "-c", statement]).strip()

    def database_bytes(self):
        return int(self.sql("SELECT pg_database_size('postgres')"))

    def cpu_s(self):
        """Of the server and all its processes that ended or run."""
        def ticks(pid, with_children):
            with open(f"/proc/{pid}/stat") as stat:
                fields = stat.read().rsplit(")", 1)[1].split()
            return sum(int(fields[i]) for i in ((11, 12, 13, 14) if with_children else (11, 12)))
        total = ticks(self.process.pid, True)
        with open(f"/proc/{self.process.pid}/task/{self.process.pid}/children") as children:
            for pid in children.read().split():
                try:
                    total += ticks(pid, False)
                except OSError:  # it has just ended
                    pass
        return total / os.sysconf("SC_CLK_TCK")

    def stop(self):
        """Without waiting for those who are connected."""
        self.process.send_signal(signal.SIGINT)
        self.process.wait()
