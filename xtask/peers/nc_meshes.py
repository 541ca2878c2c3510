"""Meshes that two programs of other systems must fit, made of the programs' text by other code, with jobs beside them.

    python3 xtask/peers/nc_meshes.py DATA OUT

DATA is the reference collection, OUT a folder. Two programs of its `files/nc` are read here, each in a few lines:

- `camotics_flower_mold.nc`, 16,562 blocks in inches over a bowl with steep walls. A ball is put at places DEG_MM apart along every
  block, and the lowest of its underside is kept at the nodes of a grid (GRID_MM): a mesh of what a ball leaves, with its ridges.
- `linuxcnc_arcspiral.ngc`, 998 arcs of growing curvature. A flat end mill leaves a floor and one turn of a wall, whose distance from
  the centre is that of the arc plus the tool's radius (the spiral leans by 0.01 rad: 2e-4 mm of error).

Beside each mesh lie copies that are moved by UP_MM and have to be found too deep or too high by just that.
"""

import math
import pathlib
import re
import struct
import sys

INCH = 25.4
BALL_MM = 1.5875  # 1/16 inch: the ridges between passes 0.16 mm apart are 2e-3 mm high.
FLAT_MM = 6.35
GRID_MM = 0.05
STEP_MM = 0.02
UP_MM = 0.1
WINDOW = (34.0, 44.0, 18.0, 24.0)  # of the mould, mm: from its floor up a wall.
STEPS = 8  # of an arc of the spiral: chords are 1e-3 mm off.

# Between samples a floor under the flat end of a tool has no bound of what stands: samples would be added up to the most that a job may
# have, and every one lies under hundreds of moves.
SPIRAL = {"rpm": 3400, "feed": 610, "spacing": 1.0, "samples": "max_samples = 60000\n"}

JOB = """format = 1
[part]
file = "{mesh}"
[tool]
{tool}
length_mm = 30
teeth = {teeth}
[tolerance]
scallop_mm = {scallop}
gouge_mm = {gouge}
[cutting]
spindle_rpm = {rpm}
feed_mm_min = {feed}
[machine]
name = "3-axis"
dialect = "linuxcnc"
feed = "none"
[setup]
part_zero_mm = [0, 0, 0]
[verification]
spacing_mm = {spacing}
accept = "samples"
{samples}"""


def stl(path, triangles):
    with open(path, "wb") as out:
        out.write(b" " * 80 + struct.pack("<I", len(triangles)))
        for t in triangles:
            out.write(struct.pack("<12fH", 0, 0, 0, *(x for p in t for x in p), 0))


def words(text):
    """Places of a program of straight blocks in inches, mm."""
    at = [0.0, 0.0, 0.0]
    for line in text.splitlines():
        moved = False
        for letter, number in re.findall(r"([XYZxyz])(-?\d*\.?\d+)", line):
            at["XYZ".index(letter.upper())] = INCH * float(number)
            moved = True
        if moved:
            yield tuple(at)


def bowl(text):
    x0, x1, y0, y1 = WINDOW
    n, m = round((x1 - x0) / GRID_MM) + 1, round((y1 - y0) / GRID_MM) + 1
    height = [[math.inf] * m for _ in range(n)]
    radius = BALL_MM / 2
    reach = math.ceil(radius / GRID_MM)

    def ball(x, y, tip):
        i0, j0 = round((x - x0) / GRID_MM), round((y - y0) / GRID_MM)
        for i in range(max(0, i0 - reach), min(n, i0 + reach + 1)):
            dx2 = (x0 + i * GRID_MM - x) ** 2
            row = height[i]
            for j in range(max(0, j0 - reach), min(m, j0 + reach + 1)):
                d2 = dx2 + (y0 + j * GRID_MM - y) ** 2
                if d2 < radius * radius:
                    z = tip + radius - math.sqrt(radius * radius - d2)
                    if z < row[j]:
                        row[j] = z

    before = None
    for at in words(text):
        if before is not None:
            a, b = before, at
            near = all(
                max(a[k], b[k]) > lo - radius and min(a[k], b[k]) < hi + radius
                for k, (lo, hi) in enumerate(((x0, x1), (y0, y1)))
            )
            if near:
                pieces = max(1, math.ceil(math.dist(a, b) / STEP_MM))
                for k in range(pieces + 1):
                    p = [a[q] + (b[q] - a[q]) * k / pieces for q in range(3)]
                    if x0 - radius < p[0] < x1 + radius:
                        ball(*p)
        before = at
    point = lambda i, j, up: (x0 + i * GRID_MM, y0 + j * GRID_MM, height[i][j] + up)

    def mesh(up):
        out = []
        for i in range(n - 1):
            for j in range(m - 1):
                a, b, c, d = (point(i + p, j + q, up) for p, q in ((0, 0), (1, 0), (1, 1), (0, 1)))
                out += [(a, b, c), (a, c, d)]
        return out

    return mesh


def pocket(text):
    """One turn of the wall and the floor of a spiral that goes inwards."""
    found = [
        tuple(INCH * float(x) for x in m.groups())
        for m in re.finditer(r"r([\d.]+) x(-?[\d.]+) y(-?[\d.]+)", text)
    ]
    turn, rim = 0.0, []
    for before, at in zip(found, found[1:]):
        a, b = (math.atan2(p[2], p[1]) for p in (before, at))
        step = (a - b) % (2 * math.pi)  # clockwise
        # Before the end of the turn the tool has cut farther out when it began.
        if turn + step > 2 * math.pi - 0.2:
            break
        r = [math.hypot(p[1], p[2]) for p in (before, at)]
        for k in range(STEPS):
            rim.append((a - step * k / STEPS, r[0] + (r[1] - r[0]) * k / STEPS))
        turn += step
    deep = -0.1 * INCH
    wall = [(math.cos(t) * (r + FLAT_MM / 2), math.sin(t) * (r + FLAT_MM / 2)) for t, r in rim]
    inner = min(r for _, r in rim) + FLAT_MM / 2 - 1.0

    def mesh(up):
        out = []
        for (ax, ay), (bx, by) in zip(wall, wall[1:]):
            a, b = (ax, ay, deep + up), (bx, by, deep + up)
            c, d = (bx, by, 0.0), (ax, ay, 0.0)
            out += [(a, b, c), (a, c, d)]
        around = [(inner * math.cos(t), inner * math.sin(t), deep + up) for t, _ in rim]
        out += [((0.0, 0.0, deep + up), b, a) for a, b in zip(around, around[1:])]
        return out

    return mesh


def main():
    data, out = (pathlib.Path(p) for p in sys.argv[1:])
    out.mkdir(parents=True, exist_ok=True)
    nc = data / "files" / "nc"
    ball = f'kind = "ball"\ndiameter_mm = {BALL_MM}'
    flat = f'kind = "flat"\ndiameter_mm = {FLAT_MM}'
    for name, file, made, tool, about in (
        ("mould", "camotics_flower_mold.nc", bowl, ball, {"rpm": 2000, "feed": 508, "spacing": 0.05, "samples": ""}),
        ("spiral", "linuxcnc_arcspiral.ngc", pocket, flat, SPIRAL),
    ):
        mesh = made((nc / file).read_text())
        (out / f"{name}.ngc").write_text((nc / file).read_text())
        for word, up in (("fits", 0.0), ("low", -UP_MM), ("high", UP_MM)):
            stl(out / f"{name}-{word}.stl", mesh(up))
            for teeth in (1, 4):
                job = JOB.format(
                    mesh=f"{name}-{word}.stl", tool=tool, teeth=teeth, scallop=0.03, gouge=0.03, **about
                )
                (out / f"{name}-{word}-{teeth}.toml").write_text(job)


main()
