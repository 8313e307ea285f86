#!/usr/bin/env python3
"""Figures of crates/core/src/camera/brown_conrady_tests.rs, by OpenCV.

    pip install opencv-python-headless && python3 tests/tools/opencv_lenses.py

Prints, for each lens, its coefficients and points (x, y) in front of a camera with the place where
cv2.projectPoints shows (x, y, 1) through a camera matrix of ones.
"""
import cv2
import numpy as np

LENSES = [
    [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05, 0.0],  # EuRoC MAV, cam0
    [-0.3, 0.1, 0.001, -0.0005, -0.01],
    [0.2, -0.05, 0.0, 0.002, 0.01],
    [0.12, 0.0, -0.003, 0.0, 0.0],
]
POINTS = [(0.0, 0.0), (0.1, 0.0), (-0.3, 0.2), (0.5, 0.5), (-0.7, -0.1), (0.05, -0.6), (0.65, -0.45)]

for lens in LENSES:
    points = np.array([[x, y, 1.0] for x, y in POINTS])
    seen, _ = cv2.projectPoints(points, np.zeros(3), np.zeros(3), np.eye(3), np.array(lens))
    print(f"    ({lens}, [")
    for (x, y), (u, v) in zip(POINTS, seen[:, 0]):
        print(f"        [{x!r}, {y!r}, {float(u)!r}, {float(v)!r}],")
    print("    ]),")
