#!/usr/bin/env python3
"""Computes contacts in Python: a ball of radius 0.5 mm moves over a sphere of radius 2 mm about the
origin. Writes the contacts as a trace, and a scenario in which a force law receives these contacts.
The second command runs the scenario with every algorithm:

    python3 algorithms/module/examples/sphere_trace.py FOLDER
    hapbench compare FOLDER/sphere.json --algorithms all
"""
import json
import sys
from pathlib import Path

import numpy as np

folder, dt, steps = Path(sys.argv[1]), 0.0005, 1000
t = dt * np.arange(steps)
tip = np.column_stack([-0.001 + 0.004 * t, 0 * t, np.full(steps, 0.0024)])
distance = np.linalg.norm(tip, axis=1)
out = tip / distance[:, None]  # outward normal of the sphere at the point nearest to the tip
touches = distance <= 0.0025
trace = np.column_stack([t, 0.002 * out, -out, 0.0025 - distance])[touches]
np.savetxt(
    folder / "sphere.csv",
    trace,
    "%.17g",
    ",",
    header="time_s,x_m,y_m,z_m,ux,uy,uz,depth_m",
    comments="",
)
scene = {
    "time": {"step_s": dt, "steps": steps},
    "environment": {"type": "plane", "size_m": 0.004, "spacing_m": 0.0002},
    "tool": {"type": "bur", "family": "ball", "diameter_m": 0.001},
    "record": {"trajectory": True},
    "motion": {
        "position": {
            "type": "prescribed",
            "x_m": {"type": "ramp", "start": -0.001, "rate_per_s": 0.004},
            "y_m": 0,
            "z_m": 0.0024,
        }
    },
    "rendering": {
        "damping_ratio": 0,
        "friction": {"mu_s_N_s_per_m": 0, "mu_f_s_per_m": 0},
        "contact_source": {"type": "trace", "file": "sphere.csv"},
    },
}
(folder / "sphere.json").write_text(json.dumps(scene, indent=2))
