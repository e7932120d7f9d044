#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Opens what `strata topology` wrote as somebody else would, and checks it against itself.

    read_topology.py FOLDER LANDMARK_TIMES

Python's standard library reads topologies.json (no NaN, which JSON does not have) and
topology.graphml by GraphML's rules: declared keys, their types, unique ids, edges between nodes.
networkx reads the GraphML too where it is installed.
"""
import json
import math
import pathlib
import sys
import xml.etree.ElementTree as ElementTree

SPACE = "{http://graphml.graphdrawing.org/xmlns}"
TYPES = {"int": int, "long": int, "float": float, "double": float, "string": str}


def no_constant(text):
    raise ValueError(f"{text} is no JSON")


def data_of(element, keys, domain):
    values = {}
    for data in element.findall(SPACE + "data"):
        key = keys[data.get("key")]
        assert key["for"] == domain, (data.get("key"), domain)
        values[key["attr.name"]] = TYPES[key["attr.type"]](data.text)
    return values


def read_graphml(path):
    root = ElementTree.parse(path).getroot()
    assert root.tag == SPACE + "graphml", root.tag
    keys = {}
    for key in root.findall(SPACE + "key"):
        assert key.get("id") not in keys
        keys[key.get("id")] = key.attrib
    (graph,) = root.findall(SPACE + "graph")
    assert graph.get("edgedefault") == "undirected"
    nodes, edges = {}, {}
    for node in graph.findall(SPACE + "node"):
        assert node.get("id") not in nodes
        nodes[node.get("id")] = data_of(node, keys, "node")
    for edge in graph.findall(SPACE + "edge"):
        ends = edge.get("source"), edge.get("target")
        assert ends[0] in nodes and ends[1] in nodes, ends
        assert frozenset(ends) not in edges
        edges[frozenset(ends)] = data_of(edge, keys, "edge")
    return data_of(graph, keys, "graph"), nodes, edges


def check_covariance(rows):
    for i in range(3):
        for j in range(3):
            assert abs(rows[i][j] - rows[j][i]) < 1e-9, rows
    assert rows[0][0] >= 0 and rows[1][1] >= 0
    assert rows[0][0] * rows[1][1] - rows[0][1] ** 2 >= -1e-12, "no ellipse"


def check_json(result, times_s):
    assert abs(sum(t["probability"] for t in result["topologies"]) - 1.0) < 1e-9
    visits = result["visits"]
    assert len(visits) == len(times_s), (len(visits), times_s)
    for visit, time_s in zip(visits, sorted(times_s)):
        assert abs(visit["time_s"] - time_s) <= 0.2, (visit, time_s)
    for topology in result["topologies"]:
        labels = topology["labels"]
        assert len(labels) == len(visits)
        assert {landmark["id"] for landmark in topology["landmarks"]} == set(labels)
        for landmark in topology["landmarks"]:
            assert landmark["visits"] == [i for i, l in enumerate(labels) if l == landmark["id"]]
    for landmark in result["topologies"][0]["landmarks"]:
        check_covariance(landmark["covariance"])


def check_networkx(path, nodes, edges):
    try:
        import networkx
    except ImportError:
        print("networkx is not installed: read by the standard library only")
        return
    graph = networkx.read_graphml(path)
    assert set(graph.nodes) == set(nodes)
    assert {frozenset(edge) for edge in graph.edges} == set(edges)
    for name, data in nodes.items():
        assert math.isclose(graph.nodes[name]["x"], data["x"])
    print("networkx agrees")


def main():
    folder = pathlib.Path(sys.argv[1])
    times_s = [float(line) for line in open(sys.argv[2], encoding="utf-8")]
    with open(folder / "topologies.json", encoding="utf-8") as file:
        result = json.load(file, parse_constant=no_constant)
    check_json(result, times_s)
    first = result["topologies"][0]
    graph, nodes, edges = read_graphml(folder / "topology.graphml")
    assert math.isclose(graph["probability"], first["probability"], rel_tol=1e-6)
    assert len(nodes) == len(first["landmarks"])
    for landmark in first["landmarks"]:
        node = nodes[f"n{landmark['id']}"]
        assert math.isclose(node["x"], landmark["x"], rel_tol=1e-6, abs_tol=1e-6)
        assert math.isclose(node["var_y"], landmark["covariance"][1][1], rel_tol=1e-6, abs_tol=1e-9)
        assert node["visits"] == len(landmark["visits"])
        assert node["name"] == landmark["name"]
    expected = {frozenset((f"n{e['from']}", f"n{e['to']}")): e["traversals"]
                for e in first["edges"]}
    assert expected == {ends: data["traversals"] for ends, data in edges.items()}
    check_networkx(folder / "topology.graphml", nodes, edges)


if __name__ == "__main__":
    main()
