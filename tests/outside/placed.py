#!/usr/bin/env python3
"""What other programs find in glTF and 3MF files: placed.csv, for tests/tests/outside.rs.

    pip install trimesh==5.2.0 numpy networkx lxml pillow
    tests/outside/placed.py FOLDER > tests/outside/placed.csv

FOLDER holds glTF2 and 3MF (the files of assimp's tests). Triangles and bounds are those of trimesh; the number of
objects of a glTF is the number of mesh nodes below its scene, counted in its JSON. trimesh 5.2 gives every part of a
3MF with several parts the same objects, so 3MF is read here once more, by Python's own zipfile and ElementTree.
A file that trimesh cannot read is left out; the test knows those by hand.
"""

import csv
import json
import pathlib
import struct
import sys
import warnings
import xml.etree.ElementTree as tree
import zipfile

import numpy
import trimesh

warnings.filterwarnings("ignore")


def gltf_json(path):
    data = path.read_bytes()
    if data[:4] == b"glTF":
        (length,) = struct.unpack("<I", data[12:16])
        data = data[20 : 20 + length]
    return json.loads(data)


def mesh_nodes(path):
    root = gltf_json(path)
    nodes = root.get("nodes", [])

    def below(number):
        node = nodes[number]
        return ("mesh" in node) + sum(below(child) for child in node.get("children", []))

    return sum(below(number) for number in root["scenes"][root.get("scene", 0)]["nodes"])


def by_trimesh(path):
    scene = trimesh.load_scene(path, process=False)
    triangles = 0
    for node in scene.graph.nodes_geometry:
        mesh = scene.geometry[scene.graph[node][1]]
        triangles += len(getattr(mesh, "faces", ()))
    return triangles, scene.bounds


def local(tag):
    return tag.rsplit("}", 1)[-1]


def attribute(element, name):
    return next((value for key, value in element.items() if local(key) == name), None)


def matrix(text):
    """Row vectors times this."""
    rows = numpy.array((text or "1 0 0 0 1 0 0 0 1 0 0 0").split(), float).reshape(4, 3)
    return numpy.hstack([rows, [[0], [0], [0], [1]]])


def by_hand(path):
    archive = zipfile.ZipFile(path)
    parts = {}

    def part(name):
        name = name.lstrip("/")
        if name not in parts:
            parts[name] = tree.fromstring(archive.read(name))
        return parts[name]

    objects, triangles, low, high = 0, 0, [], []

    def place(name, number, outside):
        nonlocal objects, triangles
        for element in part(name).iter():
            if local(element.tag) != "object" or attribute(element, "id") != number:
                continue
            points = [
                [float(vertex.get(axis)) for axis in "xyz"] + [1]
                for vertex in element.iter()
                if local(vertex.tag) == "vertex"
            ]
            if points:
                placed = (numpy.array(points) @ outside)[:, :3]
                objects += 1
                triangles += sum(local(inner.tag) == "triangle" for inner in element.iter())
                low.append(placed.min(axis=0))
                high.append(placed.max(axis=0))
            for inner in element.iter():
                if local(inner.tag) == "component":
                    visit(name, inner, outside)

    def visit(name, element, outside):
        inside = matrix(attribute(element, "transform")) @ outside
        place(attribute(element, "path") or name, attribute(element, "objectid"), inside)

    root = "3D/3dmodel.model"
    for element in part(root).iter():
        if local(element.tag) == "item":
            visit(root, element, numpy.eye(4))
    return objects, triangles, numpy.array([numpy.min(low, axis=0), numpy.max(high, axis=0)])


def main():
    folder = pathlib.Path(sys.argv[1])
    rows = csv.writer(sys.stdout, lineterminator="\n")
    rows.writerow("file objects triangles low_x low_y low_z high_x high_y high_z".split())
    kinds = ["glTF2/**/*.gltf", "glTF2/**/*.glb", "3MF/*.3mf"]
    for path in sorted(path for kind in kinds for path in folder.glob(kind)):
        try:
            if path.suffix == ".3mf":
                objects, triangles, bounds = by_hand(path)
            else:
                triangles, bounds = by_trimesh(path)
                objects = mesh_nodes(path)
        except Exception as error:  # Whatever it is, there are no figures.
            print(f"{path}: {type(error).__name__}: {error}", file=sys.stderr)
            continue
        if triangles:
            bounds = [repr(float(x)) for x in numpy.array(bounds).flatten()]
            rows.writerow([path.relative_to(folder), objects, triangles, *bounds])


main()
