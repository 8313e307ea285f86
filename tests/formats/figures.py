#!/usr/bin/env python3
"""Prints what trimesh finds in files: name, triangles, and the box around their corners, with tabs.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install trimesh==5.2.0 pillow
    /tmp/venv/bin/python tests/formats/figures.py FOLDER OBJ PLY STL OFF > tests/formats/figures.tsv

FOLDER holds a folder for each format. What trimesh cannot read, or holds no triangle, is left out:
tests/tests/formats.rs says what is to be told of those.
"""
import os
import sys

import numpy
import trimesh

OTHERS = (".mtl", ".jpg", ".png", ".txt")

root = sys.argv[1]
for folder in sys.argv[2:]:
    for place, _, names in sorted(os.walk(os.path.join(root, folder))):
        for name in sorted(names):
            path = os.path.join(place, name)
            if name.endswith(OTHERS):
                continue
            try:
                mesh = trimesh.load(path, file_type=folder.lower(), process=False, force="mesh")
                corners = mesh.vertices[numpy.unique(mesh.faces)]
                ends = [*corners.min(0), *corners.max(0)]
                triangles = len(mesh.faces)
            except Exception as error:
                print(f"{path}: {type(error).__name__}: {error}", file=sys.stderr)
                continue
            print(os.path.relpath(path, root), triangles, *map(float, ends), sep="\t")
