"""OpenCAMLib's drop-cutter and our removal on the same part, tool and resolution, in one run.

usage: drop_cutter.py BENCH FACETS POINTS SIDE_MM [SAMPLES MOTIONS]
    BENCH is target/release/examples/removal_bench; the part, z = 4 sin(x/10) sin(y/10), is SIDE_MM wide.
    OpenCAMLib gets FACETS x FACETS squares of two facets and drops a ball of 10 mm at POINTS places of a raster
    (BatchDropCutter, one thread). Ours gets the same raster's MOTIONS with the ball in between, against SAMPLES.
Needs the PyPI package opencamlib.

What is compared: cost per pose that is checked for gouges on one core. OpenCAMLib tells how low the tool may stand at single
places, against facets; ours how deep the moving tool comes at every sample, scallops and uncut places included. The last
column of OpenCAMLib's line is by how much its tips stand above those of the raster, which touch the true surface: the facets'
chords.
"""

import math
import os
import subprocess
import sys
import time

import opencamlib as ocl

HEIGHT, PER_MM, RADIUS = 4.0, 0.1, 5.0


def z(x, y):
    return HEIGHT * math.sin(PER_MM * x) * math.sin(PER_MM * y)


def slopes(x, y):
    a, b = PER_MM * x, PER_MM * y
    return HEIGHT * PER_MM * math.cos(a) * math.sin(b), HEIGHT * PER_MM * math.sin(a) * math.cos(b)


def facets(n, side):
    step = side / n
    beyond = int(RADIUS / step) + 1
    line = [step * k for k in range(-beyond, n + beyond + 1)]
    points = [[ocl.Point(x, y, z(x, y)) for y in line] for x in line]
    surface = ocl.STLSurf()
    for i in range(len(line) - 1):
        for j in range(len(line) - 1):
            a, b, c, d = points[i][j], points[i + 1][j], points[i + 1][j + 1], points[i][j + 1]
            surface.addTriangle(ocl.Triangle(a, b, c))
            surface.addTriangle(ocl.Triangle(a, c, d))
    return surface


def main():
    bench, n, count, side = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4])
    samples, motions = (sys.argv[5:7] + ["40000", "4000"][len(sys.argv[5:7]):])
    surface = facets(n, side)
    drop = ocl.BatchDropCutter()
    drop.setThreads(1)
    drop.setSTL(surface)
    drop.setCutter(ocl.BallCutter(2 * RADIUS, 60.0))
    lines = max(2, round(math.sqrt(2 * count)))
    steps = max(1, count // lines)
    tips = []
    for i in range(lines):
        for j in range(steps + 1):
            u, v = side * j / steps, side * i / (lines - 1)
            zu, zv = slopes(u, v)
            length = math.sqrt(1 + zu * zu + zv * zv)
            tips.append(z(u, v) + RADIUS / length - RADIUS)
            drop.appendPoint(ocl.CLPoint(u - RADIUS * zu / length, v - RADIUS * zv / length, -50.0))
    begin, cpu = time.time(), time.process_time()
    drop.run()
    begin, cpu = time.time() - begin, time.process_time() - cpu
    above = [p.z - tip for p, tip in zip(drop.getCLPoints(), tips)]
    print(
        f"OpenCAMLib {ocl.version()}: {len(tips)} poses on {surface.size()} facets of {side / n:.3f} mm: {begin:.2f} s, "
        f"{cpu:.2f} CPU s, {1e6 * cpu / len(tips):.0f} us a pose; tips {min(above):.5f} to {max(above):.5f} mm above ours"
    )
    environment = dict(os.environ, RAYON_NUM_THREADS="1")
    ours = [bench, samples, motions, "8", str(int(side)), "3-axis"]
    print(subprocess.run(ours, env=environment, capture_output=True, text=True, check=True).stdout, end="")


main()
