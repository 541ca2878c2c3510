// What the two peer programs share: the reference surface, the places, the clock and the table.
//
// A line of the table is `name <tab> nanoseconds for one call`, as the Rust bench prints it.
#pragma once
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

constexpr int PLACES = 2000;
constexpr int ROUNDS = 9;

struct Surface {
    int nu = 0, nv = 0, pu = 0, pv = 0;
    std::vector<double> ku, kv;
    // x y z w a pole, v fastest.
    std::vector<double> poles;
    bool rational = false;
};

inline bool read_surface(const std::string& path, Surface& s) {
    std::ifstream in(path);
    if (!(in >> s.nu >> s.nv >> s.pu >> s.pv)) return false;
    s.ku.resize(s.nu + s.pu + 1);
    s.kv.resize(s.nv + s.pv + 1);
    s.poles.resize(4 * s.nu * s.nv);
    for (double& k : s.ku) in >> k;
    for (double& k : s.kv) in >> k;
    for (double& x : s.poles) in >> x;
    for (int i = 0; i < s.nu * s.nv; i++) s.rational |= s.poles[4 * i + 3] != s.poles[3];
    return bool(in);
}

struct Uv {
    double u, v;
};

// Weyl's sequence, the same places as in the Rust bench.
inline std::vector<Uv> random_places() {
    std::vector<Uv> at(PLACES);
    for (int k = 0; k < PLACES; k++) {
        double a = 0.5 + k * 0.754877666246693, b = 0.5 + k * 0.569840290998053;
        at[k] = {a - std::floor(a), b - std::floor(b)};
    }
    return at;
}

// The same places, piece after piece of seven spans each way.
inline std::vector<Uv> ordered_places() {
    auto at = random_places();
    auto piece = [](const Uv& p) { return int(p.u * 7.0) * 7 + int(p.v * 7.0); };
    std::stable_sort(at.begin(), at.end(), [&](const Uv& a, const Uv& b) { return piece(a) < piece(b); });
    return at;
}

struct Far {
    double x, y, z, distance;
};

inline std::vector<Far> read_far(const std::string& path) {
    std::ifstream in(path);
    int n = 0;
    in >> n;
    std::string rest;
    std::getline(in, rest);
    std::vector<Far> far;
    while (std::getline(in, rest)) {
        std::istringstream line(rest);
        Far f{};
        if (line >> f.x >> f.y >> f.z >> f.distance) far.push_back(f);
    }
    return far;
}

// What keeps the compiler from leaving the work out.
inline volatile double sink;

inline void time_it(const std::string& what, int calls, const std::function<void()>& run, int rounds = ROUNDS) {
    double best = 1e300;
    for (int k = 0; k < rounds; k++) {
        auto start = std::chrono::steady_clock::now();
        run();
        std::chrono::duration<double, std::nano> t = std::chrono::steady_clock::now() - start;
        best = std::min(best, t.count());
    }
    std::printf("%s\t%.2f\n", what.c_str(), best / calls);
    std::fflush(stdout);
}
