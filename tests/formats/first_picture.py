#!/usr/bin/env python3
"""From a file to its first picture, whole process, beside F3D, one after the other in turn.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install f3d==4.0.0 numpy
    cargo build --release
    /tmp/venv/bin/python tests/formats/first_picture.py target/release/raycast [TURNS]

A bumpy torus of one and of four million triangles, as OBJ, binary PLY, binary STL and GLB, at 1600x1000.
Prints medians of seconds, peak memory in MB, and the ratio of the times.
"""
import json
import os
import statistics
import struct
import subprocess
import sys
import tempfile
import time

import numpy

F3D = """
import f3d, sys
f3d.Engine.autoload_plugins()
engine = f3d.Engine.create(True)
engine.window.size = (1600, 1000)
engine.scene.add(sys.argv[1])
engine.window.render_to_image().save(sys.argv[2])
"""


def torus(triangles):
    rows = round((triangles / 2) ** 0.5)
    angle = numpy.linspace(0, 2 * numpy.pi, rows, endpoint=False)
    u, v = numpy.meshgrid(angle, angle, indexing="ij")
    tube = 0.4 + 0.02 * numpy.sin(40 * u) * numpy.sin(30 * v)
    ring = 1 + tube * numpy.cos(v)
    places = [ring * numpy.cos(u), tube * numpy.sin(v), ring * numpy.sin(u)]
    points = numpy.stack(places, -1).astype("<f4").reshape(-1, 3)
    i, j = numpy.meshgrid(numpy.arange(rows), numpy.arange(rows), indexing="ij")
    i1, j1 = (i + 1) % rows, (j + 1) % rows
    a, b, c, d = i * rows + j, i1 * rows + j, i1 * rows + j1, i * rows + j1
    return points, numpy.stack([a, c, b, a, d, c], -1).reshape(-1, 3).astype("<i4")


def write(folder, name, points, faces):
    with open(f"{folder}/{name}.obj", "w") as file:
        numpy.savetxt(file, points, "v %.9g %.9g %.9g")
        numpy.savetxt(file, faces + 1, "f %d %d %d")
    with open(f"{folder}/{name}.ply", "wb") as file:
        axes = "".join(f"property float {axis}\n" for axis in "xyz")
        file.write(
            f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n{axes}"
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n".encode()
        )
        points.tofile(file)
        records = numpy.zeros(len(faces), [("count", "u1"), ("corners", "<i4", 3)])
        records["count"], records["corners"] = 3, faces
        records.tofile(file)
    with open(f"{folder}/{name}.stl", "wb") as file:
        file.write(b"torus".ljust(80, b"\0") + len(faces).to_bytes(4, "little"))
        records = numpy.zeros(len(faces), [("floats", "<f4", (4, 3)), ("more", "<u2")])
        records["floats"][:, 1:] = points[faces]
        records.tofile(file)
    low, high = (points.min(0).tolist(), points.max(0).tolist())
    views = [(0, points.nbytes, 34962), (points.nbytes, faces.nbytes, 34963)]
    scene = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3", "min": low, "max": high},
            {"bufferView": 1, "componentType": 5125, "count": faces.size, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": start, "byteLength": length, "target": target}
            for start, length, target in views
        ],
        "buffers": [{"byteLength": points.nbytes + faces.nbytes}],
    }
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    length = points.nbytes + faces.nbytes
    with open(f"{folder}/{name}.glb", "wb") as file:
        file.write(b"glTF" + struct.pack("<II", 2, 28 + len(text) + length))
        file.write(struct.pack("<I", len(text)) + b"JSON" + text)
        file.write(struct.pack("<I", length) + b"BIN\0")
        points.tofile(file)
        faces.tofile(file)


def run(command):
    started = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{command}: {status}")
    return time.monotonic() - started, usage.ru_maxrss / 1024


def main():
    raycast = os.path.abspath(sys.argv[1])
    turns = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    print("file         raycast s    MB   F3D s    MB  ratio")
    with tempfile.TemporaryDirectory() as folder:
        for name, triangles in (("1m", 1_000_000), ("4m", 4_000_000)):
            write(folder, name, *torus(triangles))
            for kind in ("obj", "ply", "stl", "glb"):
                file, picture = f"{folder}/{name}.{kind}", f"{folder}/picture.png"
                ours = [raycast, "render", file, "-o", picture, "--size", "1600x1000"]
                theirs = [sys.executable, "-c", F3D, file, picture]
                pairs = [(run(ours), run(theirs)) for _ in range(turns)]
                middle = lambda who, what: statistics.median(pair[who][what] for pair in pairs)
                (a, b), (c, d) = [[middle(who, what) for what in (0, 1)] for who in (0, 1)]
                print(f"{name}.{kind:8} {a:9.2f} {b:5.0f} {c:7.2f} {d:5.0f} {a / c:6.2f}", flush=True)


main()
