"""A compressor impeller with splitter blades as one solid in a STEP file, from published blade sections.

Needs Python 3 and OpenCASCADE 8 (pip install "cadquery-ocp>=8" numpy). In this folder:

    python3 make.py ../centrifugal-blade/blade.csv splitter.csv impeller.step [--blades 6] [--scale 1000] [--fillet 1]

The first two files hold points of the main blade and of the splitter; NOTICE.md says where they come from. The axis is z, the
blades begin at z = 0 and go down to the disc. The file that is named has sharp inner edges; the one beside it whose name ends
in -fillets.step has fillets between blades and hub where the kernel makes them.
"""
import argparse
import math
import re
import sys
from pathlib import Path

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepAlgoAPI import BRepAlgoAPI_Common, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import (BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeSolid,
                                BRepBuilderAPI_MakeWire, BRepBuilderAPI_Sewing, BRepBuilderAPI_Transform)
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepFilletAPI import BRepFilletAPI_MakeFillet
from OCP.BRepGProp import BRepGProp
from OCP.BRepOffsetAPI import BRepOffsetAPI_MakeFilling
from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
from OCP.collections import (Array1_double, Array1_gp_Pnt, Array1_int, Array2_gp_Pnt,
                             IndexedDataMap_TopoDS_Shape_List_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeLists,
                             IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher as ShapeMap, List_TopoDS_Shape)
from OCP.Geom import Geom_BSplineCurve, Geom_BSplineSurface
from OCP.GeomAbs import GeomAbs_C0, GeomAbs_SurfaceOfRevolution
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Reader, STEPControl_Writer
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp
from OCP.TopoDS import TopoDS
from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf

BORE_MM, FRONT_MM, DISC_MM = 8.0, 3.0, 5.0  # bore, hub before the blades, disc behind them; at --scale 1000
SEAM = 0.4  # angle of the seams of turned faces, in pitches: away from the leading edges
SIDE_POLES, SPAN_POLES = 14, 7  # poles of a side along the flow and from hub to tip
SLOWLY = 12.0  # speed at which a side's parameter begins, in thicknesses
CUBIC, LINE = np.array([0.0, 0, 0, 0, 1, 1, 1, 1]), np.array([0.0, 0, 1, 1])  # knots without inner ones


# --- B-splines: cubic, clamped, on 0 .. 1 ---

def knots_of(count):
    """Even knots for `count` poles."""
    return np.concatenate([[0, 0, 0], np.linspace(0, 1, count - 2), [1, 1, 1]])


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


def fit(knots, at, points):
    """Poles of the curve nearest to the points (least squares) with the first and the last point held."""
    points = np.asarray(points)
    shape = points.shape
    points = points.reshape(len(at), -1)
    m = basis(knots, at)
    rest = points - np.outer(m[:, 0], points[0]) - np.outer(m[:, -1], points[-1])
    inner = np.linalg.lstsq(m[:, 1:-1], rest, rcond=None)[0]
    return np.vstack([points[:1], inner, points[-1:]]).reshape(-1, *shape[1:])


def arrays(knots):
    values = np.unique(knots)
    a, m = Array1_double(1, len(values)), Array1_int(1, len(values))
    for i, x in enumerate(values, 1):
        a.SetValue(i, float(x))
        m.SetValue(i, int(np.sum(knots == x)))
    return a, m


def pnt(p):
    return gp_Pnt(float(p[0]), float(p[1]), float(p[2]))


def surface(poles, u_knots, v_knots):
    a = Array2_gp_Pnt(1, poles.shape[0], 1, poles.shape[1])
    for i, row in enumerate(poles, 1):
        for j, p in enumerate(row, 1):
            a.SetValue(i, j, pnt(p))
    (uk, um), (vk, vm) = arrays(u_knots), arrays(v_knots)
    degree = [int(m.Value(1)) - 1 for m in (um, vm)]
    return Geom_BSplineSurface(a, uk, vk, um, vm, *degree)


def curve(poles, knots):
    a = Array1_gp_Pnt(1, len(poles))
    for i, p in enumerate(poles, 1):
        a.SetValue(i, pnt(p))
    return Geom_BSplineCurve(a, *arrays(knots), 3)


def face(geometry):
    return BRepBuilderAPI_MakeFace(geometry, 1e-6).Face()


# --- the data ---

def sections(path, scale):
    """Points [section, point, xyz] of the suction and the pressure side, hub first, leading edge first, in mm."""
    rows = np.loadtxt(path, delimiter=",", skiprows=1)
    count = int(rows[:, 0].max()) + 1
    sides = rows[:, 1:].reshape(count, -1, 2, 3)[..., ::-1] * [scale, scale, -scale]  # the data's axis is x, inlet at x = 0
    return sides[:, :, 0], sides[:, :, 1]


def radius(p):
    return np.hypot(p[..., 0], p[..., 1])


def side(points, start, along, outer):
    """Points of one side of one section from `start` along the chord's direction to beyond the outer radius.

    The first points go round the leading edge, some of them squeezed flat against its plane, and the last ones go round the
    trailing edge. Both are left out: the leading edge gets its own face, and the side runs straight on from 96 % of the radius.
    """
    way = points @ along
    keep = np.flatnonzero((way > start) & (radius(points) < 0.96 * outer))
    keep = np.arange(keep[0], keep[-1] + 1)
    before, first = points[keep[0] - 1], points[keep[0]]
    t = (start - before @ along) / ((first - before) @ along)
    body = np.vstack([before + t * (first - before), points[keep]])
    out = body[-1] - body[-4]
    out /= np.linalg.norm(out)
    steps = np.arange(1, 8)[:, None] * (0.012 * outer)
    return np.vstack([body, body[-1] + steps * out])


class Blade:
    """Both sides as B-spline surfaces, a round nose between them, and closed to a solid that is too long on three sides."""

    def __init__(self, suction, pressure, outer):
        count = len(suction)
        self.u_knots, self.v_knots = knots_of(SIDE_POLES), knots_of(SPAN_POLES)
        rows = [[], []]
        for pair in zip(suction, pressure):
            along = sum(points[14] - points[3] for points in pair)
            along /= np.linalg.norm(along)
            across = pair[0][14] - pair[1][14]
            width = np.linalg.norm(across - (across @ along) * along)
            start = min((points @ along).min() for points in pair) + 0.5 * width
            lines = [side(points, start, along, outer) for points in pair]
            # Parameters that begin slowly, at a speed that goes with the thickness: poles lie close where the blade begins,
            # and one factor for the whole span makes handles of the right length for the nose.
            slow = SLOWLY * np.linalg.norm(lines[0][0] - lines[1][0])
            for side_rows, line in zip(rows, lines):
                arc = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
                u = (np.sqrt(slow * slow + 4 * (arc[-1] - slow) * arc) - slow) / (2 * (arc[-1] - slow))
                side_rows.append(fit(self.u_knots, u, line))
        # One more row below the hub and one above the tip, straight on, so that the blade runs through both.
        span = np.arange(-1, count + 1)
        v = (span + 1) / (count + 1)
        self.hub_v = v[1]
        self.poles = []
        for side_rows in rows:
            r = np.array(side_rows)
            r = np.concatenate([[2 * r[0] - r[1]], r, [2 * r[-1] - r[-2]]])
            self.poles.append(np.swapaxes(fit(self.v_knots, v, r), 0, 1))
        # The nose is a cubic across that leaves both sides along their tangents; its handles make about half a circle.
        (s0, s1), (p0, p1) = self.poles[0][:2], self.poles[1][:2]
        handle = 2 * (SIDE_POLES - 3) / SLOWLY
        self.nose = np.array([s0, s0 + handle * (s0 - s1), p0 + handle * (p0 - p1), p0])

    def nose_on(self, line):
        """The parameter of the hub's line at which its circle goes through this blade's nose at the hub."""
        nose = np.einsum("j,ijk->ik", basis(self.v_knots, [self.hub_v])[0], self.nose)
        tip = (nose[0] + 3 * nose[1] + 3 * nose[2] + nose[3]) / 8
        u = np.linspace(0, 0.1, 2001)
        return u[np.argmin(np.abs((basis(line[1], u) @ line[0])[:, 2] - (tip[2] + nose[0, 2]) / 2))]

    def surfaces(self):
        s, p = self.poles
        tail = surface(np.array([s[-1], p[-1]]), LINE, self.v_knots)
        return [surface(s, self.u_knots, self.v_knots), surface(self.nose, CUBIC, self.v_knots),
                surface(p, self.u_knots, self.v_knots), tail]

    def solid(self):
        faces = [face(f) for f in self.surfaces()]
        # Caps at both ends of the span; they vanish inside the hub and above the tip.
        for end in (0, -1):
            s, p = self.poles[0][:, end], self.poles[1][:, end]
            faces.append(face(surface(np.stack([s, p], axis=1), self.u_knots, LINE)))
            fill = BRepOffsetAPI_MakeFilling()
            fill.Add(BRepBuilderAPI_MakeEdge(curve(self.nose[:, end], CUBIC)).Edge(), GeomAbs_C0)
            fill.Add(BRepBuilderAPI_MakeEdge(pnt(s[0]), pnt(p[0])).Edge(), GeomAbs_C0)
            fill.Build()
            faces.append(TopoDS.Face(fill.Shape()))
        sew = BRepBuilderAPI_Sewing(1e-3)
        for f in faces:
            sew.Add(f)
        sew.Perform()
        shells = parts(sew.SewedShape(), TopAbs_SHELL)
        if len(shells) != 1:
            sys.exit(f"make.py: the faces of a blade sew to {len(shells)} shells instead of one")
        solid = BRepBuilderAPI_MakeSolid(TopoDS.Shell(shells[0])).Solid()
        if volume(solid) < 0:
            solid = solid.Reversed()
        return solid


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
    return p.Mass()


def meridian(points, end):
    """The line (r, z) of one row of points, from the leading edge out to the radius `end`, as a curve in the plane y = 0."""
    line = np.stack([radius(points), 0 * points[..., 2], points[..., 2]], axis=-1).reshape(-1, 3)
    first, low = [line[:, 0].min(), 0, 0], [end, 0, line[:, 2].min()]
    line = line[(line[:, 2] < -0.01 * end) & (line[:, 0] < 0.98 * end)]
    line = np.vstack([first, line[np.argsort(line[:, 0] - line[:, 2])], low])
    arc = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    knots = knots_of(10)
    poles = fit(knots, arc / arc[-1], line)
    return poles, knots


def turned(line, corners, split=None):
    """The solid of revolution about z whose half section is the curve, then the corners (r, z), then back to its beginning.

    `split` is a parameter of the curve at which its surface is cut into two faces.
    """
    poles, knots = line
    path = [poles[-1]] + [[r, 0, z] for r, z in corners] + [poles[0]]
    whole = curve(poles, knots)
    cuts = [0.0, 1.0] if split is None else [0.0, split, 1.0]
    wire = BRepBuilderAPI_MakeWire()
    for u0, u1 in zip(cuts, cuts[1:]):
        wire.Add(BRepBuilderAPI_MakeEdge(whole, float(u0), float(u1)).Edge())
    for a, b in zip(path, path[1:]):
        wire.Add(BRepBuilderAPI_MakeEdge(pnt(a), pnt(b)).Edge())
    section = BRepBuilderAPI_MakeFace(wire.Wire()).Face()
    solid = BRepPrimAPI_MakeRevol(section, gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1))).Shape()
    return solid if volume(solid) > 0 else solid.Reversed()


def copy_turned(shape, angle):
    t = gp_Trsf()
    t.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), angle)
    return BRepBuilderAPI_Transform(shape, t, True).Shape()


def listed(shapes):
    out = List_TopoDS_Shape()
    for s in shapes:
        out.Append(s)
    return out


def boolean(kind, first, others, names):
    """The result of a Boolean operation, and what became of the faces in `names` (name: faces)."""
    op = kind()
    op.SetArguments(listed([first]))
    op.SetTools(listed(others))
    op.SetNonDestructive(True)
    op.Build()
    if not op.IsDone():
        sys.exit(f"make.py: {kind.__name__} failed")
    after = {}
    for name, faces in names.items():
        after[name] = [g for f in faces for g in (list(op.Modified(f)) or ([] if op.IsDeleted(f) else [f]))]
    return op.Shape(), after


def build(blades, lines, outer, count, k):
    """The wheel as one solid, and its faces by name."""
    hub, shroud = lines
    bottom, top = hub[0][-1][2] - DISC_MM * k, FRONT_MM * k
    # The hub and the blades are too large on every side but the hub line, and one turned solid cuts them all: this leaves no
    # two faces in one place that the kernel would have to tell apart.
    split = blades[0].nose_on(hub)
    body = turned(hub, [(hub[0][-1][0], bottom - 1), (0, bottom - 1), (0, top + 1), (hub[0][0][0], top + 1)], split)
    body = copy_turned(body, SEAM * 2 * math.pi / count)
    r = BORE_MM * k / 2
    cut = turned(shroud, [(outer, bottom), (r, bottom), (r, top), (shroud[0][0][0], top)])
    cut = copy_turned(cut, SEAM * 2 * math.pi / count)
    revolved = lambda s: [f for f in parts(s, TopAbs_FACE)
                          if BRepAdaptor_Surface(TopoDS.Face(f)).GetType() == GeomAbs_SurfaceOfRevolution]
    names, solids = {"hub": revolved(body), "tip": revolved(cut)}, []
    for kind, blade, turn in (("main", blades[0], 0.0), ("splitter", blades[1], 0.5)):
        solid = blade.solid()
        for i in range(count):
            solids.append(copy_turned(solid, 2 * math.pi * (i + turn) / count))
            for side_name, f in zip(("suction", "nose", "pressure"), parts(solids[-1], TopAbs_FACE)):
                names[f"{kind} {i + 1} {side_name}"] = [f]
    wheel, names = boolean(BRepAlgoAPI_Fuse, body, solids, names)
    wheel, names = boolean(BRepAlgoAPI_Common, wheel, [cut], names)
    solids = parts(wheel, TopAbs_SOLID)
    if len(solids) != 1:
        sys.exit(f"make.py: hub and blades fuse to {len(solids)} solids instead of one")
    return solids[0], names


def neighbours(wheel):
    """Edges of the wheel, each with its faces."""
    found = ShapeLists()
    TopExp.MapShapesAndAncestors_s(wheel, TopAbs_EDGE, TopAbs_FACE, found)
    return [(TopoDS.Edge(found.FindKey(i)), list(found.FindFromIndex(i))) for i in range(1, found.Extent() + 1)]


def named(names, one):
    return next((n for n, faces in names.items() for f in faces if f.IsSame(one)), "")


def rounded(wheel, names, size):
    """The wheel with fillets between hub and blades, and the blades that have one."""
    edges = {}
    for edge, faces in neighbours(wheel):
        at = [named(names, f) for f in faces]
        if "hub" in at and any(n.split()[0] in ("main", "splitter") for n in at if n):
            blade = next(n for n in at if n.startswith(("main", "splitter"))).rsplit(" ", 1)[0]
            edges.setdefault(blade, []).append(edge)

    def attempt(chosen):
        fillet = BRepFilletAPI_MakeFillet(wheel)
        for blade in chosen:
            for edge in edges[blade]:
                if fillet.Contour(edge) == 0:  # an edge draws in those that go on smoothly from it
                    fillet.Add(size, edge)
        try:
            fillet.Build()
            shape = fillet.Shape() if fillet.IsDone() else None
        except RuntimeError:
            return None
        return shape if shape and BRepCheck_Analyzer(shape).IsValid() else None

    done, best = list(edges), attempt(edges)
    if best is None:
        done = []
        for blade in edges:
            if (shape := attempt(done + [blade])) is not None:
                done, best = done + [blade], shape
    return best and parts(best, TopAbs_SOLID)[0], done


def write(shape, path, name):
    """STEP AP214 in mm: no curves in parameter space, lengths to 1e-8 mm, nothing about when and where it was written."""
    writer = STEPControl_Writer()
    for key, value in (("write.step.schema", "AP214IS"), ("write.step.unit", "MM"), ("write.step.product.name", name)):
        Interface_Static.SetCVal_s(key, value)
    Interface_Static.SetIVal_s("write.surfacecurve.mode", 0)
    writer.Transfer(shape, STEPControl_AsIs)
    if writer.Write(str(path)) != IFSelect_RetDone:
        sys.exit(f"make.py: {path} cannot be written")
    text = Path(path).read_text()
    text = re.sub(r"FILE_NAME\(.*?\);", f"FILE_NAME('{name}','2000-01-01T00:00:00',(''),(''),'','','');", text, 1, re.S)
    text = re.sub(r",\s*", ",", text).replace(f"'{name} 1'", f"'{name}'")
    short = lambda m: m[1] + ",".join(f"{float(x):.8f}".rstrip("0") for x in m[2].split(",")) + ")"
    text = re.sub(r"(CARTESIAN_POINT\('',\()([^)]*)\)", short, text)
    Path(path).write_text(re.sub(r"(?<![\d.])-0\.(?=[,)])", "0.", text))


def read(path):
    reader = STEPControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_RetDone:
        sys.exit(f"make.py: {path} cannot be read back")
    reader.TransferRoots()
    return reader.OneShape()


def check(path):
    """What the file that was written holds: it must be one valid solid with one closed shell."""
    shape = read(path)
    solids, shells = parts(shape, TopAbs_SOLID), parts(shape, TopAbs_SHELL)
    good = BRepCheck_Analyzer(shape).IsValid()
    closed = all(BRep_Tool.IsClosed_s(s) for s in shells)
    print(f"{Path(path).name}: {len(solids)} solid, {len(shells)} shell, {'closed' if closed else 'OPEN'}, "
          f"{'valid' if good else 'NOT VALID'}, {len(parts(shape, TopAbs_FACE))} faces, volume {volume(shape):.2f} mm3, "
          f"area {area(shape):.3f} mm2, {Path(path).stat().st_size} bytes")
    if not (good and closed and len(solids) == len(shells) == 1):
        sys.exit(f"make.py: {path} is not one closed solid")


def table(wheel, names):
    """Faces in the order of the file with what they are, which blades they touch, and their areas."""
    faces, touch = parts(wheel, TopAbs_FACE), {}
    number = lambda f: next(i for i, g in enumerate(faces, 1) if g.IsSame(f))
    for _, pair in neighbours(wheel):
        for f, g in (pair, pair[::-1]) if len(pair) == 2 else ():
            touch.setdefault(number(f), set()).add(named(names, g))
    for i, f in enumerate(faces, 1):
        name = named(names, f)
        near = sorted({n.rsplit(" ", 1)[0] for n in touch[i] if n.startswith(("main", "splitter"))})
        if " " not in name:
            name = (name or "back, front, rim or bore") + (f" at {', '.join(near)}" if near else "")
        print(f"  F{i:<4}{area(f):12.3f} mm2  {name}")


def channels(names, count):
    """The narrowest place between neighbouring sides that face each other."""
    gap = lambda a, b: min(BRepExtrema_DistShapeShape(f, g).Value() for f in names[a] for g in names[b])
    pairs = {}
    for i in range(1, count + 1):
        after = i % count + 1
        for a, b in ((f"main {i}", f"splitter {i}"), (f"splitter {i}", f"main {after}"), (f"main {i}", f"main {after}")):
            pairs.setdefault((a.split()[0], b.split()[0]), []).append(gap(f"{a} pressure", f"{b} suction"))
    for (a, b), values in pairs.items():
        print(f"  from a {a} blade's pressure side to the next {b} blade's suction side: {min(values):.3f} mm or more")


def main():
    ask = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    ask.add_argument("main", type=Path, help="points of the main blade")
    ask.add_argument("splitter", type=Path, help="points of the splitter")
    ask.add_argument("out", type=Path, help="STEP file to write")
    ask.add_argument("--blades", type=int, default=6, help="main blades, and as many splitters (the data's authors have 8)")
    ask.add_argument("--scale", type=float, default=1000, help="mm in a unit of the data, which are metres")
    ask.add_argument("--fillet", type=float, default=1, help="radius of the fillets at the hub, mm")
    args = ask.parse_args()
    Message.DefaultMessenger_s().ChangePrinters().Clear()  # the kernel's own lines about each transfer

    sides = [sections(path, args.scale) for path in (args.main, args.splitter)]
    outer = math.floor(10 * min(radius(side[:, -1]).min() for pair in sides for side in pair)) / 10
    lines = [meridian(np.array([side[row] for side in sides[0]]), end) for row, end in ((0, 1.001 * outer), (-1, outer))]
    blades = [Blade(*pair, outer) for pair in sides]
    wheel, names = build(blades, lines, outer, args.blades, args.scale / 1000)
    write(wheel, args.out, "impeller")
    check(args.out)
    print(f"  diameter {2 * outer:.1f} mm, {args.blades} main blades and {args.blades} splitters")
    channels(names, args.blades)
    table(wheel, names)
    shape, done = rounded(wheel, names, args.fillet)
    if shape:
        out = args.out.with_name(args.out.stem + "-fillets.step")
        write(shape, out, "impeller with fillets")
        check(out)
    print(f"  fillets of {args.fillet:g} mm at {len(done)} of {2 * args.blades} blades")


if __name__ == "__main__":
    main()
