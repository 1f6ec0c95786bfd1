// SPDX-FileCopyrightText: The palpate developers
// SPDX-License-Identifier: Apache-2.0
#include "host/geometry/surfaces/intersections.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace palpate {
namespace {

__extension__ using Wide = __int128;
using Point = std::array<std::int64_t, 3>;  // mm * 2^16, |x| < 2^29

constexpr double steps_per_mm = 65536;

int sign_of(Wide x) { return (x > 0) - (x < 0); }

// The side of d with respect to the plane of a, b, c: floating point first, whole numbers if
// unsure.
int orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
    double x[3][3];
    const Point* from[3] = {&a, &b, &c};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) x[i][j] = double((*from[i])[j] - d[j]);
    const double p[3] = {x[1][1] * x[2][2], x[1][2] * x[2][0], x[1][0] * x[2][1]};
    const double q[3] = {x[1][2] * x[2][1], x[1][0] * x[2][2], x[1][1] * x[2][0]};
    double determinant = 0, bound = 0;
    for (int i = 0; i < 3; ++i) {
        determinant += x[0][i] * (p[i] - q[i]);
        bound += std::abs(x[0][i]) * (std::abs(p[i]) + std::abs(q[i]));
    }
    if (std::abs(determinant) > 1e-14 * bound) return determinant > 0 ? 1 : -1;
    const auto w = [&](int i, int j) { return Wide((*from[i])[j] - d[j]); };
    return sign_of(w(0, 0) * (w(1, 1) * w(2, 2) - w(1, 2) * w(2, 1)) +
                   w(0, 1) * (w(1, 2) * w(2, 0) - w(1, 0) * w(2, 2)) +
                   w(0, 2) * (w(1, 0) * w(2, 1) - w(1, 1) * w(2, 0)));
}

// Orientation of a, b, c after leaving out one axis.
int orientation2(const Point& a, const Point& b, const Point& c, int dropped) {
    const int x = (dropped + 1) % 3, y = (dropped + 2) % 3;
    return sign_of(Wide(b[x] - a[x]) * (c[y] - a[y]) - Wide(b[y] - a[y]) * (c[x] - a[x]));
}

using Corners = std::array<const Point*, 3>;

int main_axis(const Corners& t) {
    double normal[3];
    for (int axis = 0; axis < 3; ++axis) {
        const int x = (axis + 1) % 3, y = (axis + 2) % 3;
        normal[axis] = std::abs(double((*t[1])[x] - (*t[0])[x]) * double((*t[2])[y] - (*t[0])[y]) -
                                double((*t[1])[y] - (*t[0])[y]) * double((*t[2])[x] - (*t[0])[x]));
    }
    return int(std::max_element(normal, normal + 3) - normal);
}

bool is_between(const Point& a, const Point& b, const Point& p, int dropped) {
    for (int axis = 0; axis < 3; ++axis)
        if (axis != dropped &&
            (p[axis] < std::min(a[axis], b[axis]) || p[axis] > std::max(a[axis], b[axis])))
            return false;
    return true;
}

// Closed segments in one plane.
bool segments_meet(const Point& a, const Point& b, const Point& c, const Point& d, int dropped) {
    const int abc = orientation2(a, b, c, dropped), abd = orientation2(a, b, d, dropped);
    const int cda = orientation2(c, d, a, dropped), cdb = orientation2(c, d, b, dropped);
    if (abc * abd < 0 && cda * cdb < 0) return true;
    return (abc == 0 && is_between(a, b, c, dropped)) ||
           (abd == 0 && is_between(a, b, d, dropped)) ||
           (cda == 0 && is_between(c, d, a, dropped)) || (cdb == 0 && is_between(c, d, b, dropped));
}

bool point_in_triangle(const Point& p, const Corners& t, int dropped) {
    const int a = orientation2(*t[0], *t[1], p, dropped),
              b = orientation2(*t[1], *t[2], p, dropped),
              c = orientation2(*t[2], *t[0], p, dropped);
    return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

// A closed segment and a closed triangle.
bool segment_meets_triangle(const Point& a, const Point& b, const Corners& t) {
    const int side_a = orientation(*t[0], *t[1], *t[2], a);
    const int side_b = orientation(*t[0], *t[1], *t[2], b);
    if (side_a * side_b > 0) return false;
    if (side_a == 0 && side_b == 0) {
        const int axis = main_axis(t);
        return point_in_triangle(a, t, axis) || point_in_triangle(b, t, axis) ||
               segments_meet(a, b, *t[0], *t[1], axis) || segments_meet(a, b, *t[1], *t[2], axis) ||
               segments_meet(a, b, *t[2], *t[0], axis);
    }
    const int s = orientation(a, b, *t[0], *t[1]), u = orientation(a, b, *t[1], *t[2]),
              v = orientation(a, b, *t[2], *t[0]);
    return (s >= 0 && u >= 0 && v >= 0) || (s <= 0 && u <= 0 && v <= 0);
}

class PairTest {
public:
    PairTest(std::span<const Vec3> vertices, std::span<const Triangle> triangles)
        : triangles_(triangles) {
        points_.reserve(vertices.size());
        for (const Vec3& v : vertices)
            points_.push_back({std::llround(v[0] * steps_per_mm), std::llround(v[1] * steps_per_mm),
                               std::llround(v[2] * steps_per_mm)});
    }

    bool operator()(Index first, Index second) const {
        Triangle a = triangles_[first], b = triangles_[second];
        int shared = 0;  // shared vertices to the front of both
        for (int i = 0; i < 3; ++i)
            for (int j = shared; j < 3; ++j)
                if (i >= shared && a[i] == b[j]) {
                    std::swap(a[i], a[shared]);
                    std::swap(b[j], b[shared]);
                    ++shared;
                    break;
                }
        const Corners s{&points_[a[0]], &points_[a[1]], &points_[a[2]]};
        const Corners t{&points_[b[0]], &points_[b[1]], &points_[b[2]]};
        if (shared == 3) return true;
        if (shared == 2) return folds_over(s, t);
        if (shared == 1)
            return segment_meets_triangle(*s[1], *s[2], t) ||
                   segment_meets_triangle(*t[1], *t[2], s);
        for (int i = 0; i < 3; ++i)
            if (segment_meets_triangle(*s[i], *s[(i + 1) % 3], t) ||
                segment_meets_triangle(*t[i], *t[(i + 1) % 3], s))
                return true;
        return false;
    }

private:
    // Triangles with a common edge meet elsewhere only if they lie in one plane on one side of it.
    static bool folds_over(const Corners& s, const Corners& t) {
        if (orientation(*s[0], *s[1], *s[2], *t[2]) != 0) return false;
        const int axis = main_axis(s);
        return orientation2(*s[0], *s[1], *s[2], axis) * orientation2(*s[0], *s[1], *t[2], axis) >=
               0;
    }

    std::span<const Triangle> triangles_;
    std::vector<Point> points_;
};

struct Boxes {
    std::vector<Eigen::AlignedBox3d> all;
    double cell = 1;  // mm, of the search grid

    Boxes(std::span<const Vec3> vertices, std::span<const Triangle> triangles) {
        double sum = 0;
        for (const Triangle& t : triangles) {
            Eigen::AlignedBox3d box(vertices[t[0]]);
            box.extend(vertices[t[1]]);
            box.extend(vertices[t[2]]);
            sum += box.sizes().maxCoeff();
            all.push_back({box.min().array() - 1e-4, box.max().array() + 1e-4});
        }
        if (!all.empty()) cell = std::max(1e-3, 1.2 * sum / double(all.size()));
    }
    template <typename Visit>
    void for_cells(Index triangle, Visit&& visit) const {
        const auto& box = all[triangle];
        std::array<std::int64_t, 3> low, high;
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::int64_t(std::floor(box.min()[axis] / cell));
            high[axis] = std::int64_t(std::floor(box.max()[axis] / cell));
        }
        constexpr std::int64_t half = 1 << 20;
        for (auto k = low[2]; k <= high[2]; ++k)
            for (auto j = low[1]; j <= high[1]; ++j)
                for (auto i = low[0]; i <= high[0]; ++i)
                    visit((std::uint64_t(i + half) << 42) | (std::uint64_t(j + half) << 21) |
                          std::uint64_t(k + half));
    }
};

}  // namespace

std::vector<std::array<Index, 2>> find_intersections(std::span<const Vec3> vertices,
                                                     std::span<const Triangle> triangles) {
    const Boxes boxes(vertices, triangles);
    std::vector<std::pair<std::uint64_t, Index>>
        entries;  // sorted: the triangles of each grid cell
    for (Index t = 0; t < Index(triangles.size()); ++t)
        boxes.for_cells(t, [&](std::uint64_t cell) { entries.push_back({cell, t}); });
    std::sort(entries.begin(), entries.end());
    const PairTest meet(vertices, triangles);
    std::vector<std::array<Index, 2>> pairs;
    for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
        while (end < entries.size() && entries[end].first == entries[begin].first) ++end;
        for (std::size_t a = begin; a < end; ++a)
            for (std::size_t b = a + 1; b < end; ++b) {
                const Index first = entries[a].second, second = entries[b].second;
                if (boxes.all[first].intersects(boxes.all[second]) && meet(first, second))
                    pairs.push_back({first, second});
            }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

}  // namespace palpate
