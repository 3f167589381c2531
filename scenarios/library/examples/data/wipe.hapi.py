"""Prints a recording to import: a ball of 2 mm wiped over a flat for 4 s by a hand, as a text log of HAPI would hold it.

    python3 scenarios/library/examples/data/wipe.hapi.py >scenarios/library/examples/data/wipe.hapi.txt

All of it is made up, so that it is known what is right: the flat (z = 0) pushes with 2000 N/m along z, friction with 0.2
of that against the motion, and the sensor adds noise of 5 mN to each component. The log has what real ones have: the y
axis up, orientations as axis and angle, an uneven clock near 100 Hz that does not begin at 0, five decimals (10 um). The
same bytes at every call.
"""
import math
import random

RADIUS_M, STIFFNESS_N_PER_M, FRICTION, NOISE_N = 0.001, 2000.0, 0.2, 0.005
SECONDS, RATE_HZ, START_S = 4.0, 100.0, 12.5


def smooth_step(x):
    x = min(1.0, max(0.0, x))
    return x * x * (3 - 2 * x)


def depth(t):
    """Depth of the ball in the flat [m]; it comes from 1 mm above it and leaves again."""
    pressed = smooth_step(t / 0.6) * smooth_step((SECONDS - t) / 0.6)
    return -0.001 + pressed * (0.0014 + 0.0001 * math.sin(2 * math.pi * 1.5 * t))


def place(t):
    """Place of the ball's centre [m]: rounds of 8 mm by 5 mm."""
    turn = 2 * math.pi * 0.5 * t
    return 0.004 * math.cos(turn), 0.0025 * math.sin(turn), RADIUS_M - depth(t)


def orientation(t):
    """Quaternion w, x, y, z: leans by up to 30 degrees, to and fro, and rolls once about its axis."""
    lean = math.radians(30) * math.sin(2 * math.pi * 0.25 * t)
    roll = 2 * math.pi * t / SECONDS
    return product((math.cos(lean / 2), math.sin(lean / 2), 0.0, 0.0), (math.cos(roll / 2), 0.0, 0.0, math.sin(roll / 2)))


def product(a, b):
    return (a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0])


def force(t, noise):
    pressure = max(0.0, STIFFNESS_N_PER_M * depth(t))
    before, after = place(t - 1e-4), place(t + 1e-4)
    way = after[0] - before[0], after[1] - before[1]
    length = math.hypot(*way)
    pure = (-FRICTION * pressure * way[0] / length, -FRICTION * pressure * way[1] / length, pressure)
    return tuple(part + noise.gauss(0.0, NOISE_N) for part in pure)


def with_y_up(v):
    return v[0], v[2], -v[1]


def axis_and_angle(q):
    """Axis and angle of the orientation where y is up: the same turn, then the world's by -90 degrees about x."""
    half = math.sqrt(0.5)
    w, *axis = product((half, -half, 0.0, 0.0), q)
    length = math.sqrt(sum(part * part for part in axis))
    return (*(part / length for part in axis), 2 * math.atan2(length, w))


def main():
    noise = random.Random(16)
    print("TIME POSITION ORIENTATION FORCE")
    t = 0.0
    while t <= SECONDS:
        numbers = (START_S + t, *with_y_up(place(t)), *axis_and_angle(orientation(t)), *with_y_up(force(t, noise)))
        print(" ".join(f"{number:.5f}" for number in numbers))
        t += noise.uniform(0.8, 1.2) / RATE_HZ


if __name__ == "__main__":
    main()
