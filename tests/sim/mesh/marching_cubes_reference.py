"""Compares the marching cubes of the block with a hole with the implementation of scikit-image, which shares no code
with hapbench.

marching_cubes_reference.py BLOCK_MESH: the program that prints hapbench's mesh. The exit status is 0 if they agree.
"""
import subprocess
import sys

import numpy as np
from scipy.spatial import cKDTree
from skimage import measure


def distance(block, p):
    """Returns the signed distance [m] of points to a box minus a cylinder. It is exact inside the material, and at all
    outer nodes next to the surface."""
    sx, sy, sz, diameter, depth = block
    q = np.abs(p + [0, 0, sz / 2]) - np.array([sx, sy, sz]) / 2
    box = np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(axis=-1), 0)
    c = np.stack([np.hypot(p[..., 0], p[..., 1]) - diameter / 2, -depth - p[..., 2]], axis=-1)
    hole = np.linalg.norm(np.maximum(c, 0), axis=-1) + np.minimum(c.max(axis=-1), 0)
    return np.maximum(box, -hole)


def our_mesh(program, block, spacing, density):
    arguments = [program, *(repr(float(n)) for n in (*block, spacing)), density]
    numbers = subprocess.run(arguments, check=True, capture_output=True, text=True).stdout.split()
    count, faces = int(numbers[0]), int(numbers[1])
    end = 2 + 3 * count
    return (
        np.array(numbers[2:end], float).reshape(-1, 3) / spacing,
        np.array(numbers[end : end + 3 * faces], int).reshape(-1, 3),
    )


def their_mesh(block, spacing, density):
    """Returns the mesh of scikit-image in the form in which hapbench prints its mesh: coordinates in units of the
    spacing. Grid nodes lie at half-integer multiples of the spacing."""
    low = np.floor(np.array([-block[0] / 2, -block[1] / 2, -block[2]]) / spacing) - 1.5
    high = np.ceil(np.array([block[0] / 2, block[1] / 2, 0]) / spacing) + 1.5
    axes = [np.arange(a, b + 1) for a, b in zip(low, high)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    field = -distance(block, nodes * spacing) / spacing
    if density == "binary":
        field = np.where(field > 0, 0.5, -0.5)
    # Use the classic method: the newer method adds vertices inside ambiguous cells.
    vertices, faces, _, _ = measure.marching_cubes(field, 0.0, method="lorensen")
    return vertices + low, faces, max(field.shape)


def compare(program, block, spacing, density):
    ours, our_faces = our_mesh(program, block, spacing, density)
    theirs, their_faces, nodes = their_mesh(block, spacing, density)
    # scikit-image computes in single precision. Its error is half a unit in the last place of an index up to `nodes`,
    # plus a few units in the last place of the signed distance. Next to the surface, this distance is about one grid
    # spacing, the unit of the coordinates.
    tolerance = (nodes + 8) * 2.0**-24
    gap, partner = cKDTree(theirs).query(ours)
    print(
        f"{density}, spacing {spacing}: {len(ours)} and {len(theirs)} vertices, at most "
        f"{gap.max():.2e} of a cell apart "
        f"(allowed {tolerance:.2e}), {len(our_faces)} and {len(their_faces)} faces"
    )
    return (
        len(ours) == len(theirs) == len(set(partner))
        and gap.max() <= tolerance
        and len(our_faces) == len(their_faces)
    )


if __name__ == "__main__":
    small = (0.004, 0.005, 0.004, 0.002, 0.002)
    sys.exit(
        not all(
            [
                compare(sys.argv[1], small, spacing, density)
                for density in ("signed_distance", "binary")
                for spacing in (0.0001, 0.00025)
            ]
        )
    )
