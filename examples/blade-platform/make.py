"""A compressor blade on its platform, with fillets between them, as one solid in a STEP file, from published sections.

Needs Python 3 and OpenCASCADE 8 (pip install "cadquery-ocp>=8" numpy). In this folder:

    python3 make.py rotor37.dat blade.step

NOTICE.md says where the sections come from and what is changed. The platform's top is at z = 0 and looks up, the blade stands
on it along z, leading edge at -x, and its convex side looks to +y.
"""
import argparse
import re
import sys
from pathlib import Path

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeSolid, BRepBuilderAPI_MakeWire,
                                BRepBuilderAPI_Sewing, BRepBuilderAPI_MakeEdge)
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
from OCP.collections import (Array1_double, Array1_int, Array2_gp_Pnt,
                             IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap)
from OCP.Geom import Geom_BSplineSurface
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Reader, STEPControl_Writer
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS
from OCP.gp import gp_Pnt

SCALE = 7.0  # mm for a centimetre of the data
SPAN_MM = 46.0  # from the first section to the last; 46.19 mm by the scale
THICKEN_MM = 0.6  # every section's line is moved outward by so much
PLATFORM = (54.0, 36.0, 12.0)  # mm
CORNERS = (27, 123, 177, 273)  # points of a section at which leading and trailing edge begin and end
FOOT_MM = 4.0  # the blade runs into the platform so far
SIDE_SPANS, EDGE_SPANS = 8, 4  # pieces of the curve on a side and round an edge


def pnt(p):
    return gp_Pnt(*(float(c) for c in p))


# --- the data ---

def sections(path):
    """Points [section, point, (x, y)] of the unrolled and thickened sections and their heights, in mm."""
    found = []
    for line in path.read_text().splitlines():
        if line.startswith("#"):
            found.append([])
        elif line.strip():
            found[-1].append([float(c) for c in line.split()])
    found = np.array(found)[:, :-1] * SCALE  # the last point is the first one again
    r = np.hypot(found[..., 1], found[..., 2])
    mean = r.mean(axis=1, keepdims=True)
    flat = np.stack([found[..., 0], mean * np.arctan2(found[..., 1], found[..., 2])], axis=-1)
    # Outward along the normals: the sections run clockwise from the leading edge over the convex side.
    after, before = np.roll(flat, -1, axis=1) - flat, flat - np.roll(flat, 1, axis=1)
    la, lb = np.linalg.norm(after, axis=2, keepdims=True), np.linalg.norm(before, axis=2, keepdims=True)
    tangent = after / la * lb + before / lb * la
    tangent /= np.linalg.norm(tangent, axis=2, keepdims=True)
    flat = flat + THICKEN_MM * np.stack([-tangent[..., 1], tangent[..., 0]], axis=-1)
    chords = flat[:, 150] - flat[:, 0]
    turn = -np.arctan2(chords[:, 1], chords[:, 0]).mean()
    flat = flat @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    low, high = flat.min(axis=(0, 1)), flat.max(axis=(0, 1))
    return flat - (low + high) / 2, (mean[:, 0] - mean[0, 0]) * (SPAN_MM / (mean[-1, 0] - mean[0, 0]))


# --- B-splines ---

def basis(knots, at):
    """The matrix of all cubic basis functions at the parameters."""
    at, last = np.asarray(at), len(knots) - 5
    span = np.clip(np.searchsorted(knots, at, side="right") - 1, 3, last)
    rows = np.zeros((len(at), last + 1))
    for row, (x, k) in enumerate(zip(at, span)):
        n = [1.0]
        for p in range(1, 4):
            new = [0.0] * (p + 1)
            for j in range(p):
                left, right = knots[k - p + 1 + j], knots[k + 1 + j]
                part = n[j] / (right - left)
                new[j] += part * (right - x)
                new[j + 1] += part * (x - left)
            n = new
        rows[row, k - 3:k + 1] = n
    return rows


def closed_fit(points, at, values):
    """Poles of closed cubics over the knots `values` from 0 to 1, nearest to the points of every section, and how far off each is."""
    n = len(values) - 1
    m = basis(np.concatenate([values[-4:-1] - 1, values, values[1:4] + 1]), at)
    m = np.hstack([m[:, :3] + m[:, n:], m[:, 3:n]])
    poles = np.array([np.linalg.lstsq(m, p, rcond=None)[0] for p in points])
    return poles, np.linalg.norm(m @ poles - points, axis=2)


def doubles(values):
    a = Array1_double(1, len(values))
    for i, x in enumerate(values, 1):
        a.SetValue(i, float(x))
    return a


def ints(values):
    a = Array1_int(1, len(values))
    for i, x in enumerate(values, 1):
        a.SetValue(i, int(x))
    return a


def blade_surface(points, heights):
    """The blade as one closed smooth surface, and the parameters at which its edges begin and end."""
    steps = np.linalg.norm(np.diff(points, axis=1, append=points[:, :1]), axis=2)
    u = (np.cumsum(steps, axis=1) / steps.sum(axis=1, keepdims=True)).mean(axis=0)
    first = CORNERS[-1]  # u is that of the next point: turn all so that the leading edge begins at 0
    points = np.roll(points, -first, axis=1)
    u = np.roll(np.concatenate([[0], u[:-1]]), -first)
    u = np.mod(u - u[0], 1)
    a, b, c = (u[(k - first) % len(u)] for k in CORNERS[:3])
    edge = lambda p, q: np.linspace(p, q, EDGE_SPANS + 1)[:-1]
    dense = (1 - np.cos(np.linspace(0, np.pi, SIDE_SPANS + 1))) / 2  # closer together towards the edges
    side = lambda p, q: (p + (q - p) * dense)[:-1]
    values = np.concatenate([edge(0, a), side(a, b), edge(b, c), side(c, 1), [1]])
    poles, off = closed_fit(points, u, values)
    print(f"  within {off.max():.4f} mm of the thickened sections, {np.sqrt((off ** 2).mean()):.4f} in the mean of squares")
    # One more row inside the platform, straight on; then a cubic up through all rows.
    low = poles[0] + (poles[0] - poles[1]) * (FOOT_MM / heights[1])
    z = np.concatenate([[-FOOT_MM], heights])
    rows = np.concatenate([low[None], poles])
    rows = np.concatenate([rows, np.broadcast_to(z[:, None, None], (*rows.shape[:2], 1))], axis=2)
    v = (z - z[0]) / (z[-1] - z[0])
    inner = [v[k:k + 3].mean() for k in range(1, len(v) - 3)]
    rows = np.linalg.solve(basis(np.array([0] * 4 + inner + [1] * 4), v), rows.reshape(len(z), -1)).reshape(rows.shape)
    grid = Array2_gp_Pnt(1, rows.shape[1], 1, rows.shape[0])
    for j, row in enumerate(rows, 1):
        for i, p in enumerate(row, 1):
            grid.SetValue(i, j, pnt(p))
    surface = Geom_BSplineSurface(grid, doubles(values), doubles([0, *inner, 1]), ints([1] * len(values)),
                                  ints([4] + [1] * len(inner) + [4]), 3, 3, True, False)
    return surface, [0.0, a, b, c, 1.0]


def blade_solid(surface, cuts):
    """The surface cut into leading edge, convex side, trailing edge, hollow side, closed by planes below and at the tip."""
    faces = []
    for p, q in zip(cuts, cuts[1:]):
        part = surface.Copy()
        part.Segment(float(p), float(q), 0.0, 1.0, 1e-9, 1e-9)
        faces.append(part)
    sew = BRepBuilderAPI_Sewing(1e-5)
    for part in faces:
        sew.Add(BRepBuilderAPI_MakeFace(part, 1e-7).Face())
    for end in (0.0, 1.0):
        wire = BRepBuilderAPI_MakeWire()
        for part in faces:
            wire.Add(BRepBuilderAPI_MakeEdge(part.VIso(end)).Edge())
        sew.Add(BRepBuilderAPI_MakeFace(wire.Wire(), True).Face())
    sew.Perform()
    shells = parts(sew.SewedShape(), TopAbs_SHELL)
    if len(shells) != 1:
        sys.exit(f"make.py: the faces of the blade sew to {len(shells)} shells instead of one")
    solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell(shells[0])).Solid()
    return solid if volume(solid) > 0 else TopoDS.Solid(solid.Reversed())


# --- shapes ---

def parts(shape, kind):
    found = ShapeMap()
    TopExp.MapShapes_s(shape, kind, found)
    return [found.FindKey(i) for i in range(1, found.Extent() + 1)]


def volume(shape):
    p = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, p, 1e-6)
    return p.Mass()


def area(shape):
    p = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, p, 1e-6)
    return p.Mass(), p.CentreOfMass()


def rounded(shape, radius, height, on):
    """The shape with its edges at a height rounded, those between faces that `on` holds for, and how many they were."""
    made, count = BRepFilletAPI_MakeFillet(shape), 0
    for edge in parts(shape, TopAbs_EDGE):
        c = BRepAdaptor_Curve(TopoDS.Edge(edge))
        at = [c.Value(c.FirstParameter() + t * (c.LastParameter() - c.FirstParameter())) for t in (0, 0.3, 0.6, 1)]
        if all(abs(p.Z() - height) < 1e-4 and on(p.X(), p.Y()) for p in at):
            made.Add(radius, TopoDS.Edge(edge))
            count += 1
    made.Build()
    if not made.IsDone():
        sys.exit(f"make.py: the kernel makes no round of {radius:g} mm along {count} edges at z = {height:g}")
    return parts(made.Shape(), TopAbs_SOLID)[0]


def write(shape, path, name):
    """STEP AP214 in mm: no curves in parameter space, lengths to 1e-8 mm, nothing about when and where it was written."""
    writer = STEPControl_Writer()
    for key, value in (("write.step.schema", "AP214IS"), ("write.step.unit", "MM"), ("write.step.product.name", name)):
        Interface_Static.SetCVal_s(key, value)
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)
    writer.Transfer(shape, STEPControl_AsIs)
    if writer.Write(str(path)) != IFSelect_RetDone:
        sys.exit(f"make.py: {path} cannot be written")
    text = path.read_text()
    text = re.sub(r"FILE_NAME\(.*?\);", f"FILE_NAME('{name}','2000-01-01T00:00:00',(''),(''),'','','');", text, count=1, flags=re.S)
    text = re.sub(r",\s*", ",", text).replace(f"'{name} 1'", f"'{name}'")
    short = lambda m: m[1] + ",".join(f"{float(x):.8f}".rstrip("0") for x in m[2].split(",")) + ")"
    text = re.sub(r"(CARTESIAN_POINT\('',\()([^)]*)\)", short, text)
    path.write_text(re.sub(r"(?<![\d.])-0\.(?=[,)])", "0.", text))


def check(path):
    """What the file that was written holds: it must be one valid solid with one closed shell."""
    reader = STEPControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_RetDone:
        sys.exit(f"make.py: {path} cannot be read back")
    reader.TransferRoots()
    shape = reader.OneShape()
    solids, shells = parts(shape, TopAbs_SOLID), parts(shape, TopAbs_SHELL)
    good = BRepCheck_Analyzer(shape).IsValid() and all(BRep_Tool.IsClosed_s(s) for s in shells)
    print(f"{path.name}: {len(solids)} solid, {len(shells)} shell, {'closed and valid' if good else 'NOT VALID'}, "
          f"volume {volume(shape):.2f} mm3, {path.stat().st_size} bytes")
    for k, face in enumerate(parts(shape, TopAbs_FACE), 1):
        size, c = area(face)
        kind = str(BRepAdaptor_Surface(TopoDS.Face(face)).GetType()).split("_")[-1]
        print(f"  F{k:<3} {kind:16} {size:9.3f} mm2 at ({c.X():.1f}, {c.Y():.1f}, {c.Z():.1f})")
    if not (good and len(solids) == len(shells) == 1):
        sys.exit(f"make.py: {path} is not one closed solid")


def main():
    ask = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    ask.add_argument("data", type=Path, help="points of the sections")
    ask.add_argument("out", type=Path, help="STEP file to write")
    ask.add_argument("--fillet", type=float, default=3, help="radius between blade and platform, mm")
    ask.add_argument("--rim", type=float, default=0.3, help="radius around the tip, mm; 0: a sharp edge")
    args = ask.parse_args()
    Message.DefaultMessenger_s().ChangePrinters().Clear()  # the kernel's own lines about each transfer
    points, heights = sections(args.data)
    blade = blade_solid(*blade_surface(points, heights))
    length, width, height = PLATFORM
    block = BRepPrimAPI_MakeBox(gp_Pnt(-length / 2, -width / 2, -height), length, width, height).Shape()
    whole = BRepAlgoAPI_Fuse(block, blade).Shape()
    whole = rounded(whole, args.fillet, 0, lambda x, y: abs(x) < length / 2 - 1 and abs(y) < width / 2 - 1)
    if args.rim > 0:
        whole = rounded(whole, args.rim, SPAN_MM, lambda x, y: True)
    write(whole, args.out, "blade")
    check(args.out)


if __name__ == "__main__":
    main()
