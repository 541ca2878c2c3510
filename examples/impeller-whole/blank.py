"""The turned blank of the impeller as a closed mesh: python3 blank.py blank.stl

Front, shroud line and outer cylinder are those of `../impeller/impeller.step`, 0.3 mm outside, the back is that of the part; the bore is not in it.
"""
import math
import struct
import sys

# Poles (r, z) of the cubic that the tips of the blades lie on, from the leading edge out, and its knots.
POLES = [(28.6235, 0.0), (28.6236, -3.3897), (29.1384, -10.1693), (31.4754, -20.0994), (35.4323, -29.5097),
         (41.0881, -38.0235), (48.4924, -45.1021), (57.5412, -49.9817), (64.3099, -51.1896), (67.7, -51.2)]
KNOTS = [0.0] * 4 + [k / 7 for k in range(1, 7)] + [1.0] * 4
MORE = 0.3  # mm outside
HUB, FRONT, OUTER, BACK = 8.2, 3.0, 67.7, -67.0
SIDES, STEPS = 90, 24


def at(t):
    k = max(j for j in range(3, len(POLES)) if KNOTS[j] <= t)
    d = [POLES[k - 3 + j] for j in range(4)]
    for r in range(1, 4):
        for j in range(3, r - 1, -1):
            lo, hi = KNOTS[k - 3 + j], KNOTS[k + 1 + j - r]
            a = (t - lo) / (hi - lo)
            d[j] = tuple((1 - a) * p + a * q for p, q in zip(d[j - 1], d[j]))
    return d[3]


line = [at(k / STEPS) for k in range(STEPS + 1)]
outside = [(line[0][0] + MORE, MORE)]
for k, (r, z) in enumerate(line):
    (r0, z0), (r1, z1) = line[max(k - 1, 0)], line[min(k + 1, STEPS)]
    n = math.hypot(r1 - r0, z1 - z0)
    outside.append((r + MORE * (z0 - z1) / n, z + MORE * (r1 - r0) / n))
profile = [(0, FRONT + MORE), (HUB + MORE, FRONT + MORE), (HUB + MORE, MORE), *outside, (OUTER + MORE, outside[-1][1]),
           (OUTER + MORE, BACK), (0, BACK)]
more = 1 / math.cos(math.pi / SIDES)  # sides lie outside of the circle
turn = [(more * math.cos(2 * math.pi * k / SIDES), more * math.sin(2 * math.pi * k / SIDES)) for k in range(SIDES)]
triangles = []
for (r0, z0), (r1, z1) in zip(profile, profile[1:]):
    for k in range(SIDES):
        c, d = turn[k], turn[(k + 1) % SIDES]
        a0, b0, a1, b1 = [(r * e[0], r * e[1], z) for r, z in ((r0, z0), (r1, z1)) for e in (c, d)]
        triangles += [t for t in ((a0, a1, b1), (a0, b1, b0)) if len(set(t)) == 3]
with open(sys.argv[1], "wb") as out:
    out.write(b"impeller blank, mm".ljust(80) + struct.pack("<I", len(triangles)))
    for t in triangles:
        out.write(struct.pack("<12fH", 0, 0, 0, *(x for p in t for x in p), 0))
