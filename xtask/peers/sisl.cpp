// SISL on the reference surfaces: `sisl SURFACE FAR` times evaluation, curvature and projection.
//
// SISL's first parameter runs fastest in its pole array, so that its two parameters are exchanged here.
#include "common.hpp"
#include <cstdlib>
#include <sisl.h>

int main(int argc, char** argv) {
    Surface s;
    if (argc != 3 || !read_surface(argv[1], s)) {
        std::fprintf(stderr, "usage: sisl SURFACE FAR\n");
        return 2;
    }
    std::vector<double> coefficients;
    for (int k = 0; k < s.nu * s.nv; k++) {
        const double* p = &s.poles[4 * k];
        double w = s.rational ? p[3] : 1.0;
        for (int c = 0; c < 3; c++) coefficients.push_back(p[c] * w);
        if (s.rational) coefficients.push_back(w);
    }
    SISLSurf* surface = newSurf(s.nv, s.nu, s.pv + 1, s.pu + 1, s.kv.data(), s.ku.data(), coefficients.data(),
                                s.rational ? 2 : 1, 3, 1);
    if (!surface) return 1;
    for (bool ordered : {false, true}) {
        auto at = ordered ? ordered_places() : random_places();
        std::string where = ordered ? " ordered" : " random";
        for (int order : {0, 2}) {
            time_it((order ? "jet" : "point") + where, PLACES, [&] {
                int left_u = 0, left_v = 0, status = 0;
                double out[18], normal[3];
                for (auto& q : at) {
                    double p[2] = {q.v, q.u};
                    s1421(surface, order, p, &left_u, &left_v, out, normal, &status);
                    sink = out[0];
                }
            });
        }
    }
    auto at = random_places();
    time_it("principal", PLACES, [&] {
        int left_u = 0, left_v = 0, status = 0;
        double k1, k2, d1[2], d2[2];
        for (auto& q : at) {
            double p[2] = {q.v, q.u};
            s2542(surface, 0, 0, 0, p, &left_u, &left_v, &k1, &k2, d1, d2, &status);
            sink = k1 + k2 + d1[0];
        }
    });
    std::vector<double> above;
    for (auto& q : at) {
        int left_u = 0, left_v = 0, status = 0;
        double p[2] = {q.v, q.u}, out[9], n[3];
        s1421(surface, 1, p, &left_u, &left_v, out, n, &status);
        double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int c = 0; c < 3; c++) above.push_back(out[c] - 3.0 * n[c] / length);
    }
    double start[2] = {s.kv.front(), s.ku.front()}, end[2] = {s.kv.back(), s.ku.back()};
    time_it("closest hint", PLACES, [&] {
        for (int k = 0; k < PLACES; k++) {
            double guess[2] = {at[k].v - 0.002, at[k].u + 0.003}, found[2];
            for (int c = 0; c < 2; c++) guess[c] = std::min(std::max(guess[c], start[c]), end[c]);
            int status = 0;
            s1775(surface, &above[3 * k], 3, 1e-10, start, end, guess, found, &status);
            sink = found[0];
        }
    }, 3);
    auto global = [&](double* point) {
        int count = 0, curves = 0, status = 0;
        double* places = nullptr;
        SISLIntcurve** lines = nullptr;
        s1954(surface, point, 3, 1e-15, 1e-10, &count, &places, &curves, &lines, &status);
        double distance = 1e300;
        if (count > 0) {
            int left_u = 0, left_v = 0;
            double out[3], n[3];
            s1421(surface, 0, places, &left_u, &left_v, out, n, &status);
            distance = std::sqrt(std::pow(out[0] - point[0], 2) + std::pow(out[1] - point[1], 2) +
                                 std::pow(out[2] - point[2], 2));
        }
        std::free(places);
        if (lines) freeIntcrvlist(lines, curves);
        return distance;
    };
    const int few = 200;
    time_it("closest above", few, [&] {
        for (int k = 0; k < few; k++) sink = global(&above[3 * k]);
    }, 3);
    auto far = read_far(argv[2]);
    int wrong = 0;
    time_it("closest far", int(far.size()), [&] {
        wrong = 0;
        for (auto& f : far) {
            double q[3] = {f.x, f.y, f.z};
            wrong += global(q) > f.distance * (1.0 + 1e-6);
        }
    }, 1);
    std::printf("wrong far\t%d\n", wrong);
    freeSurf(surface);
    return 0;
}
