// OpenCASCADE on the reference surfaces: `occt SURFACE FAR` times evaluation, curvature and projection.
//
// `direct` is Geom_BSplineSurface, `adaptor` GeomAdaptor_Surface, which keeps the polynomial of the last piece.
#include "common.hpp"
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <GeomAdaptor_Surface.hxx>
#include <GeomLProp_SLProps.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Standard_Version.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_Array2OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>

static void knots_of(const std::vector<double>& k, TColStd_Array1OfReal*& knots, TColStd_Array1OfInteger*& mults) {
    std::vector<double> t;
    std::vector<int> m;
    for (double x : k) {
        if (t.empty() || t.back() != x) {
            t.push_back(x);
            m.push_back(1);
        } else {
            m.back()++;
        }
    }
    knots = new TColStd_Array1OfReal(1, int(t.size()));
    mults = new TColStd_Array1OfInteger(1, int(t.size()));
    for (size_t i = 0; i < t.size(); i++) {
        knots->SetValue(int(i) + 1, t[i]);
        mults->SetValue(int(i) + 1, m[i]);
    }
}

int main(int argc, char** argv) {
    Surface s;
    if (argc != 3 || !read_surface(argv[1], s)) {
        std::fprintf(stderr, "usage: occt SURFACE FAR\n");
        return 2;
    }
    std::printf("version\t%s\n", OCC_VERSION_COMPLETE);
    TColgp_Array2OfPnt poles(1, s.nu, 1, s.nv);
    TColStd_Array2OfReal weights(1, s.nu, 1, s.nv);
    for (int i = 0; i < s.nu; i++)
        for (int j = 0; j < s.nv; j++) {
            const double* p = &s.poles[4 * (i * s.nv + j)];
            poles.SetValue(i + 1, j + 1, gp_Pnt(p[0], p[1], p[2]));
            weights.SetValue(i + 1, j + 1, p[3]);
        }
    TColStd_Array1OfReal *ku, *kv;
    TColStd_Array1OfInteger *mu, *mv;
    knots_of(s.ku, ku, mu);
    knots_of(s.kv, kv, mv);
    Handle(Geom_BSplineSurface) surface =
        s.rational ? new Geom_BSplineSurface(poles, weights, *ku, *kv, *mu, *mv, s.pu, s.pv)
                   : new Geom_BSplineSurface(poles, *ku, *kv, *mu, *mv, s.pu, s.pv);
    GeomAdaptor_Surface adaptor(surface);
    for (bool ordered : {false, true}) {
        auto at = ordered ? ordered_places() : random_places();
        std::string where = ordered ? " ordered" : " random";
        gp_Pnt p;
        gp_Vec a, b, c, d, e;
        time_it("point direct" + where, PLACES, [&] {
            for (auto& q : at) { surface->D0(q.u, q.v, p); sink = p.X(); }
        });
        time_it("point adaptor" + where, PLACES, [&] {
            for (auto& q : at) { adaptor.D0(q.u, q.v, p); sink = p.X(); }
        });
        time_it("jet direct" + where, PLACES, [&] {
            for (auto& q : at) { surface->D2(q.u, q.v, p, a, b, c, d, e); sink = p.X() + e.Z(); }
        });
        time_it("jet adaptor" + where, PLACES, [&] {
            for (auto& q : at) { adaptor.D2(q.u, q.v, p, a, b, c, d, e); sink = p.X() + e.Z(); }
        });
    }
    auto at = random_places();
    GeomLProp_SLProps props(surface, 2, 1e-12);
    time_it("principal", PLACES, [&] {
        gp_Dir a, b;
        for (auto& q : at) {
            props.SetParameters(q.u, q.v);
            if (props.IsCurvatureDefined()) {
                props.CurvatureDirections(a, b);
                sink = props.MaxCurvature() + props.MinCurvature() + a.X();
            }
        }
    });
    // 3 mm above the surface, from all of it.
    std::vector<gp_Pnt> above;
    for (auto& q : at) {
        gp_Pnt p;
        gp_Vec a, b;
        surface->D1(q.u, q.v, p, a, b);
        above.push_back(p.Translated(gp_Vec(gp_Dir(a.Crossed(b))) * 3.0));
    }
    GeomAPI_ProjectPointOnSurf project;
    project.Init(surface, s.ku.front(), s.ku.back(), s.kv.front(), s.kv.back(), 1e-10, Extrema_ExtAlgo_Tree);
    const int few = 200;
    time_it("closest above", few, [&] {
        for (int k = 0; k < few; k++) {
            project.Perform(above[k]);
            if (project.NbPoints() > 0) sink = project.LowerDistance();
        }
    }, 3);
    auto far = read_far(argv[2]);
    int wrong = 0;
    time_it("closest far", int(far.size()), [&] {
        wrong = 0;
        for (auto& f : far) {
            project.Perform(gp_Pnt(f.x, f.y, f.z));
            bool right = project.NbPoints() > 0 && project.LowerDistance() <= f.distance * (1.0 + 1e-6);
            wrong += !right;
        }
    }, 2);
    std::printf("wrong far\t%d\n", wrong);
    return 0;
}
