#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The metrics of a robot that learns and localizes.

usage: metrics_test.py dashboard|prometheus|abuse STRATA HALL.yaml PACKAGING WORK

dashboard   every expression of the Grafana dashboard names metrics that the robot exports
prometheus  promtool finds nothing to complain of, and a real Prometheus reads the same metrics and
            has an answer to every expression; exits with 77 where it is not installed (Debian:
            prometheus)
abuse       the robot works on while clients send nonsense, too much or nothing at all
"""
import json
import re
import shutil
import socket
import subprocess
import sys
import urllib.error
import urllib.parse
import urllib.request

from robot_process import comes_true, free_port, simulated, started

OPENMETRICS = "application/openmetrics-text; version=1.0.0"
COMPOSITION = """version: 1
transport: loopback
processes:
  - name: robot
    executor: multi_threaded
    components:
      - {{type: strata::Player, name: player, parameters: {{log: {log}, rate: 10.0, loop: true}}}}
      - type: strata::ScanMatcher
        name: scan_matcher
        parameters: {{publish_tf: false, maps: {{publish_every_s: 0.5}}, store: {{file: {work}/slam.state, period_s: 1.0}}}}
      - {{type: strata::BeamFilter, name: beam_filter}}
      - {{type: strata::PatchLearner, name: patch_learner}}
      - {{type: strata::TimescaleMemory, name: timescale_memory}}
      - type: strata::Localizer
        name: localizer
        parameters: {{model: filtered, start: {{pose_topic: scan_pose}}}}
      - {{type: strata::IncidentRecorder, name: incident_recorder, parameters: {{out: {work}/incidents}}}}
      - {{type: strata::LiveView, name: live_view, parameters: {{port: {port}}}}}
"""


class Robot:
    def __init__(self, strata, hall, work):
        log = simulated(strata, hall, work)
        self.port = free_port()
        self.process = started(strata, COMPOSITION, work, log=log, port=self.port)

    def metrics(self, accept=""):
        """The text; empty while nobody answers."""
        request = urllib.request.Request(f"http://localhost:{self.port}/metrics",
                                         headers={"Accept": accept})
        try:
            with urllib.request.urlopen(request, timeout=20) as answer:
                return answer.read().decode()
        except OSError:
            return ""

    def samples(self):
        """By name with labels."""
        return {line.rsplit(" ", 1)[0]: float(line.rsplit(" ", 1)[1])
                for line in self.metrics(OPENMETRICS).splitlines() if not line.startswith("#")}

    def processed(self, component):
        return self.samples().get(
            f'strata_component_messages_processed_total{{component="/{component}"}}', 0)

    def has_learned(self):
        samples = self.samples()
        return samples.get('strata_localization_update_seconds_count{component="/localizer"}', 0) \
            and samples.get('strata_timescale_nodes{component="/timescale_memory"}', 0) \
            and samples.get('strata_store_bytes{component="/scan_matcher"}', 0) \
            and 'strata_learned_areas{component="/patch_learner"}' in samples


def expressions(packaging):
    """Of the dashboard, with its variables as a user has them at first."""
    with open(f"{packaging}/grafana_dashboard.json") as dashboard:
        panels = json.load(dashboard)["panels"]
    found = [target["expr"] for panel in panels for target in panel.get("targets", [])]
    assert len(found) > 20, found
    return [one.replace("$robot", ".*").replace("$__rate_interval", "20s") for one in found]


def names_in(expression):
    without_labels = re.sub(r"\{[^}]*\}|\[[^]]*\]|by \([^)]*\)", "", expression)
    return set(re.findall(r"\b(?:strata|process)_[a-z_]+", without_labels))


def test_dashboard(robot, packaging, _):
    exported = {head.split("{")[0] for head in robot.samples()}
    for expression in expressions(packaging):
        names = names_in(expression)
        assert names, f"names no metric: {expression}"
        assert names <= exported, f"not exported: {names - exported} of {expression}"


def ask(port, path, **parameters):
    try:
        query = urllib.parse.urlencode(parameters)
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/api/v1/{path}?{query}",
                                    timeout=20) as answer:
            return json.load(answer)["data"]
    except urllib.error.HTTPError as error:
        if error.code == 503:  # it listens before it is ready
            return {}
        sys.exit(f"Prometheus refuses {parameters}: {error.read().decode()}")
    except OSError:
        return {}


def test_prometheus(robot, packaging, work):
    checked = subprocess.run(["promtool", "check", "metrics"], input=robot.metrics(), text=True,
                             capture_output=True)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    subprocess.run(["promtool", "check", "config", f"{packaging}/prometheus.yml"], check=True)
    with open(f"{packaging}/prometheus.yml") as sample:
        config = sample.read().replace("8765", str(robot.port)).replace("5s", "1s")
    with open(f"{work}/prometheus.yml", "w") as out:
        out.write(config)
    port = free_port()
    with open(f"{work}/prometheus.log", "w") as log:
        prometheus = subprocess.Popen(
            ["prometheus", f"--config.file={work}/prometheus.yml",
             f"--storage.tsdb.path={work}/tsdb", f"--web.listen-address=127.0.0.1:{port}"],
            stdout=log, stderr=log)
    try:
        def target():
            found = ask(port, "targets").get("activeTargets", [])
            assert not found or not found[0]["lastError"], found[0]["lastError"]
            return found and found[0]["health"] == "up"
        comes_true(target, "Prometheus reads the robot's metrics")
        ours = {line.split()[2]: line.split()[3]
                for line in robot.metrics(OPENMETRICS).splitlines() if line.startswith("# TYPE ")}
        assert len(ours) > 30, ours
        comes_true(lambda: ours.items() <= {one["metric"]: one["type"] for one in
                                            ask(port, "targets/metadata")}.items(),
                   "Prometheus knows the types of all metrics")
        for expression in expressions(packaging):
            comes_true(lambda: ask(port, "query", query=expression).get("result"),
                       f"Prometheus has an answer to {expression}")
    finally:
        prometheus.kill()
        prometheus.wait()


def connect(port):
    try:
        return socket.create_connection(("127.0.0.1", port), timeout=5)
    except OSError:
        return None


def send(client, data):
    try:
        if client is not None:
            client.sendall(data)
    except OSError:
        pass


def test_abuse(robot, _, work):
    before = robot.processed("scan_matcher")
    # Some say nothing, some never end their request, some greet as viewers and then fall silent.
    held = []
    for i in range(300):
        client = connect(robot.port)
        held.append(client)
        send(client, [b"", b"GET /metrics HTTP/1.1\r\nHost: localhost\r\nX: ",
                      b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\n"
                      b"Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
                      b"dGhlIHNhbXBsZSBub25jZQ==\r\n"
                      b"Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n\r\n"][i % 3])
    for i in range(2000):
        client = connect(robot.port)
        send(client, b"GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n" if i % 2 else b"\0" * 99)
        if client is not None:
            client.close()
    for data in (b"GET /" + b"x" * (8 << 20), b"\xff" * (8 << 20),
                 b"GET / HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n" + b"y" * (8 << 20)):
        send(connect(robot.port), data)
    comes_true(lambda: robot.processed("scan_matcher") > before + 20, "the robot has gone on")
    assert robot.process.poll() is None
    for client in held:
        if client is not None:
            client.close()
    samples = robot.samples()
    left_out = 'strata_component_messages_left_out_total{component="/live_view",reason="too_busy"}'
    assert samples[left_out] == 0, "the live view itself kept up"


def main():
    mode, strata, hall, packaging, work = sys.argv[1:6]
    if mode == "prometheus" and not (shutil.which("prometheus") and shutil.which("promtool")):
        print("skipped: prometheus is not installed; tools/install-packages --tests installs it")
        sys.exit(77)
    robot = Robot(strata, hall, work)
    try:
        comes_true(robot.has_learned, "the robot learns and localizes")
        {"dashboard": test_dashboard, "prometheus": test_prometheus, "abuse": test_abuse}[mode](
            robot, packaging, work)
    finally:
        robot.process.terminate()
        robot.process.wait()
    assert robot.process.returncode == 0, robot.process.returncode


main()
