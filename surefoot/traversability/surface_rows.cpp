// SPDX-License-Identifier: Apache-2.0
#include "surefoot/traversability/surface_rows.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "surefoot/traversability/surface_rows.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "surefoot/traversability/normals.hpp"

// Lanes are neighbouring columns. For a disc with n known cells, x and y in cells from its centre
// and z in metres, all results follow from ten sums:
//
//   n, x, y, xx, xy, yy   small integers, exact in float
//   z, xz, yz, zz         double
//
// For each row of the map, the code computes its runs once: for every half width h, the sums over
// the columns -h ... h. The disc around a cell adds one run of each of its rows; a pair of rows dy
// and -dy adds their sum to z, xz, zz and dy times their difference to yz.
//
// Heights are absolute, not relative to the centre cell, because otherwise discs could not share
// the sums of a row. First moments lose no precision by that. In n zz - z z, however, the square of
// a height far from 0 would cancel. So z^2 is split into a multiple of 2^-20 m^2 (sums of these are
// exact) and a rest. The square of the centre height is subtracted from each part.
//
// Scatter = n * (sum of products) - (product of sums), with z in cells too, is n^2 times the
// covariance. On flat ground xz, yz and zz are exactly 0.

HWY_BEFORE_NAMESPACE();
namespace surefoot::traversability::rows::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
constexpr hn::CappedTag<double, 8> kDoubles;
// a vector of floats with as many lanes as a vector of doubles
constexpr hn::Rebind<float, decltype(kDoubles)> kHalf;
constexpr hn::CappedTag<float, 16> kFloats;
using Doubles = hn::VFromD<decltype(kDoubles)>;
using Mask = decltype(hn::Eq(Doubles(), Doubles()));
using Halves = hn::VFromD<decltype(kHalf)>;
using Floats = hn::VFromD<decltype(kFloats)>;

HWY_INLINE Doubles set(double value) {
    return hn::Set(kDoubles, value);
}
HWY_INLINE Floats setf(float value) {
    return hn::Set(kFloats, value);
}
/// Converts as many floats as fit into a vector of doubles.
HWY_INLINE Doubles doubles(const float* from) {
    return hn::PromoteTo(kDoubles, hn::LoadU(kHalf, from));
}
HWY_INLINE void store(Doubles value, float* to) {
    hn::StoreU(hn::DemoteTo(kHalf, value), kHalf, to);
}
int double_lanes() {
    return static_cast<int>(hn::Lanes(kDoubles));
}
int float_lanes() {
    return static_cast<int>(hn::Lanes(kFloats));
}

struct Split {
    Doubles high, low;
};
/// Splits value >= 0 into two parts; the first is a multiple of 2^-20 (or of its last digit, if
/// that is larger).
HWY_INLINE Split split(Doubles value) {
    const Doubles shift = set(0x1.8p32);  // the last digit of this number is 2^-20
    const Doubles high = hn::Sub(hn::Add(value, shift), shift);
    return {high, hn::Sub(value, high)};
}

/// The cells of one row around a strip, 0 where unknown. The first cell is `reach` columns left of
/// the strip.
struct RowCells {
    static constexpr int kCells = kStrip + 2 * DiscRuns::kMaxReach + 16;
    HWY_ALIGN double z[kCells];
    HWY_ALIGN double zz_high[kCells];
    HWY_ALIGN double zz_low[kCells];
    HWY_ALIGN float n[kCells];
};

/// Prefetches the next strip's columns. Down a strip every row is on another memory page, which no
/// processor predicts; on maps wider than the cache every row would wait.
HWY_INLINE void ask_for_next_strip(const float* row) {
    constexpr int kLine = 16;
    for (int i = 0; i < kStrip; i += kLine) hwy::Prefetch(row + kStrip + i);
}

HWY_INLINE void load_row(const float* from, int cells, RowCells& row) {
    for (int i = 0; i < cells; i += double_lanes()) {
        const Halves height_m = hn::LoadU(kHalf, from + i);
        const auto known = hn::Eq(height_m, height_m);
        const Doubles z = hn::PromoteTo(kDoubles, hn::IfThenElseZero(known, height_m));
        const Split zz = split(hn::Mul(z, z));
        hn::StoreU(z, kDoubles, row.z + i);
        hn::StoreU(zz.high, kDoubles, row.zz_high + i);
        hn::StoreU(zz.low, kDoubles, row.zz_low + i);
        hn::StoreU(hn::IfThenElseZero(known, hn::Set(kHalf, 1.0F)), kHalf, row.n + i);
    }
}

/// Adds the cells on both sides, at the same distance, to the sum.
template <class V>
HWY_INLINE void add(V& sum, V left, V right) {
    sum = hn::Add(sum, hn::Add(left, right));
}

HWY_INLINE void reduce_heights(const RowCells& row,
                               int reach,
                               int columns,
                               const std::vector<int>& half_widths,
                               RunSums* runs) {
    for (int i = 0; i < columns; i += double_lanes()) {
        const auto cell = [&](const double* from, int dx) {
            return hn::LoadU(kDoubles, from + reach + i + dx);
        };
        Doubles z = cell(row.z, 0);
        Doubles xz = hn::Zero(kDoubles);
        Doubles high = cell(row.zz_high, 0);
        Doubles low = cell(row.zz_low, 0);
        int dx = 0;
        RunSums* run = runs;
        for (const int half_width : half_widths) {
            while (dx < half_width) {
                ++dx;
                const Doubles left = cell(row.z, -dx);
                const Doubles right = cell(row.z, dx);
                add(z, left, right);
                xz = hn::Add(xz, hn::Mul(set(dx), hn::Sub(right, left)));
                add(high, cell(row.zz_high, -dx), cell(row.zz_high, dx));
                add(low, cell(row.zz_low, -dx), cell(row.zz_low, dx));
            }
            hn::Store(z, kDoubles, run->z + i);
            hn::Store(xz, kDoubles, run->xz + i);
            hn::Store(high, kDoubles, run->zz_high + i);
            hn::Store(low, kDoubles, run->zz_low + i);
            ++run;
        }
    }
}

HWY_INLINE void reduce_counts(const RowCells& row,
                              int reach,
                              int columns,
                              const std::vector<int>& half_widths,
                              RunSums* runs) {
    for (int i = 0; i < columns; i += float_lanes()) {
        const auto cell = [&](int dx) { return hn::LoadU(kFloats, row.n + reach + i + dx); };
        Floats n = cell(0);
        Floats x = hn::Zero(kFloats);
        Floats xx = hn::Zero(kFloats);
        int dx = 0;
        RunSums* run = runs;
        for (const int half_width : half_widths) {
            while (dx < half_width) {
                ++dx;
                const Floats left = cell(-dx);
                const Floats right = cell(dx);
                const Floats both = hn::Add(left, right);
                const auto offset = static_cast<float>(dx);
                n = hn::Add(n, both);
                x = hn::Add(x, hn::Mul(setf(offset), hn::Sub(right, left)));
                xx = hn::Add(xx, hn::Mul(setf(offset * offset), both));
            }
            hn::Store(n, kFloats, run->n + i);
            hn::Store(x, kFloats, run->x + i);
            hn::Store(xx, kFloats, run->xx + i);
            ++run;
        }
    }
}

/// The ten sums of the discs around the columns of a strip; zz has two parts.
struct DiscSums {
    HWY_ALIGN double z[kStrip];
    HWY_ALIGN double xz[kStrip];
    HWY_ALIGN double yz[kStrip];
    HWY_ALIGN double zz_high[kStrip];
    HWY_ALIGN double zz_low[kStrip];
    HWY_ALIGN float n[kStrip];
    HWY_ALIGN float x[kStrip];
    HWY_ALIGN float y[kStrip];
    HWY_ALIGN float xx[kStrip];
    HWY_ALIGN float xy[kStrip];
    HWY_ALIGN float yy[kStrip];
};

/// The runs that make up a disc: [0] in the centre row, [dy] above and below.
struct DiscOfRuns {
    int reach;
    const RunSums* above[DiscRuns::kMaxReach + 1];
    const RunSums* below[DiscRuns::kMaxReach + 1];
};

HWY_INLINE void sum_heights(const DiscOfRuns& disc, int columns, DiscSums& sums) {
    const auto load = [](const double* from) { return hn::Load(kDoubles, from); };
    for (int i = 0; i < columns; i += double_lanes()) {
        const RunSums* const center = disc.above[0];
        Doubles z = load(center->z + i);
        Doubles xz = load(center->xz + i);
        Doubles yz = hn::Zero(kDoubles);
        Doubles high = load(center->zz_high + i);
        Doubles low = load(center->zz_low + i);
        for (int dy = 1; dy <= disc.reach; ++dy) {
            const RunSums* const down = disc.below[dy];
            const RunSums* const up = disc.above[dy];
            const Doubles z_down = load(down->z + i);
            const Doubles z_up = load(up->z + i);
            add(z, z_down, z_up);
            yz = hn::Add(yz, hn::Mul(set(dy), hn::Sub(z_up, z_down)));
            add(xz, load(down->xz + i), load(up->xz + i));
            add(high, load(down->zz_high + i), load(up->zz_high + i));
            add(low, load(down->zz_low + i), load(up->zz_low + i));
        }
        hn::Store(z, kDoubles, sums.z + i);
        hn::Store(xz, kDoubles, sums.xz + i);
        hn::Store(yz, kDoubles, sums.yz + i);
        hn::Store(high, kDoubles, sums.zz_high + i);
        hn::Store(low, kDoubles, sums.zz_low + i);
    }
}

HWY_INLINE void sum_counts(const DiscOfRuns& disc, int columns, DiscSums& sums) {
    const auto load = [](const float* from) { return hn::Load(kFloats, from); };
    for (int i = 0; i < columns; i += float_lanes()) {
        const RunSums* const center = disc.above[0];
        Floats n = load(center->n + i);
        Floats x = load(center->x + i);
        Floats xx = load(center->xx + i);
        Floats y = hn::Zero(kFloats);
        Floats xy = hn::Zero(kFloats);
        Floats yy = hn::Zero(kFloats);
        for (int dy = 1; dy <= disc.reach; ++dy) {
            const RunSums* const down = disc.below[dy];
            const RunSums* const up = disc.above[dy];
            const Floats n_down = load(down->n + i);
            const Floats n_up = load(up->n + i);
            const Floats x_down = load(down->x + i);
            const Floats x_up = load(up->x + i);
            const Floats offset = setf(static_cast<float>(dy));
            const Floats both = hn::Add(n_down, n_up);
            n = hn::Add(n, both);
            yy = hn::Add(yy, hn::Mul(hn::Mul(offset, offset), both));
            y = hn::Add(y, hn::Mul(offset, hn::Sub(n_up, n_down)));
            add(x, x_down, x_up);
            xy = hn::Add(xy, hn::Mul(offset, hn::Sub(x_up, x_down)));
            add(xx, load(down->xx + i), load(up->xx + i));
        }
        hn::Store(n, kFloats, sums.n + i);
        hn::Store(x, kFloats, sums.x + i);
        hn::Store(y, kFloats, sums.y + i);
        hn::Store(xx, kFloats, sums.xx + i);
        hn::Store(xy, kFloats, sums.xy + i);
        hn::Store(yy, kFloats, sums.yy + i);
    }
}

struct Scatter {
    Doubles n;
    Doubles xx, xy, yy, xz, yz, zz;  // [cells^2], times n^2
};

HWY_INLINE Scatter scatter(const DiscSums& sums, int i, Doubles center_m, double per_cell) {
    const auto load = [](const double* from) { return hn::Load(kDoubles, from); };
    Scatter s;
    s.n = doubles(sums.n + i);
    const Doubles x = doubles(sums.x + i);
    const Doubles y = doubles(sums.y + i);
    const Doubles z = load(sums.z + i);
    const auto product = [&](Doubles of_products, Doubles a, Doubles b) {
        return hn::Sub(hn::Mul(s.n, of_products), hn::Mul(a, b));
    };
    s.xx = product(doubles(sums.xx + i), x, x);
    s.xy = product(doubles(sums.xy + i), x, y);
    s.yy = product(doubles(sums.yy + i), y, y);
    s.xz = hn::Mul(product(load(sums.xz + i), x, z), set(per_cell));
    s.yz = hn::Mul(product(load(sums.yz + i), y, z), set(per_cell));
    // Relative to the centre cell: sum (z - c)^2 = sum z^2 - n c^2 - 2 c (sum z - n c).
    const Split center2 = split(hn::Mul(center_m, center_m));
    const Doubles above = hn::Sub(z, hn::Mul(s.n, center_m));
    const Doubles high = hn::Sub(load(sums.zz_high + i), hn::Mul(s.n, center2.high));
    const Doubles low = hn::Sub(load(sums.zz_low + i), hn::Mul(s.n, center2.low));
    const Doubles zz = hn::Sub(hn::Add(high, low), hn::Mul(hn::Add(center_m, center_m), above));
    s.zz = hn::Mul(product(zz, above, above), set(per_cell * per_cell));
    return s;
}

struct Axis {
    Doubles x, y, z;  ///< unit
    Mask good;
};

/// Axis of the smallest eigenvalue l, if it is well determined; geometry::smallest_axis is the
/// plain version.
HWY_INLINE Axis smallest_axis(const Scatter& s, double min_middle) {
    constexpr int kMaxSteps = 6;
    // When a step is this small, the next root leaves a turn error of the axis of kSmallStep^3.
    constexpr double kSmallStep = 1e-3;
    constexpr double kMinLength = 1e-4;  // rounding 1e-16 / kMinLength turns the axis by 1e-12 rad
    constexpr double kMaxTurn = 1e-10;
    const auto mul = [](Doubles a, Doubles b) { return hn::Mul(a, b); };
    const auto minor = [&](Doubles a, Doubles b, Doubles c, Doubles d) {
        return hn::Sub(mul(a, b), mul(c, d));
    };
    const Doubles trace = hn::Add(hn::Add(s.xx, s.yy), s.zz);
    const Doubles minor_z = minor(s.yy, s.zz, s.yz, s.yz);
    const Doubles c1 =
        hn::Add(hn::Add(minor(s.xx, s.yy, s.xy, s.xy), minor(s.xx, s.zz, s.xz, s.xz)), minor_z);
    const Doubles c0 =
        hn::Add(hn::Sub(mul(s.xx, minor_z), mul(s.xy, minor(s.xy, s.zz, s.yz, s.xz))),
                mul(s.xz, minor(s.xy, s.yz, s.yy, s.xz)));

    // Halley's steps on l^3 - trace l^2 + c1 l - c0 from l = 0: cubic convergence, and never past
    // the root, because all three roots are real. A lane that has converged does not change any
    // more, whatever its neighbours do.
    Doubles l = hn::Zero(kDoubles);
    auto under_way = hn::Ge(s.n, set(3.0));
    const auto enough = under_way;
    for (int step = 0; step < kMaxSteps && !hn::AllFalse(kDoubles, under_way); ++step) {
        const Doubles f = hn::Sub(mul(hn::Add(mul(hn::Sub(l, trace), l), c1), l), c0);
        const Doubles half_f2 = hn::Sub(mul(set(3.0), l), trace);
        const Doubles f1 = hn::Add(mul(hn::Sub(half_f2, trace), l), c1);
        const Doubles move = hn::Div(mul(f, f1), hn::Sub(mul(f, half_f2), mul(f1, f1)));
        l = hn::IfThenElse(under_way, hn::Add(l, move), l);
        const auto arrived = hn::Le(mul(hn::Abs(move), trace), mul(f1, set(kSmallStep)));
        under_way = hn::AndNot(arrived, under_way);
    }

    // The axis is perpendicular to the first two rows of (scatter - l). The length of their cross
    // product is (middle - l)(largest - l) n_z.
    const Doubles a = hn::Sub(s.xx, l);
    const Doubles b = hn::Sub(s.yy, l);
    const Doubles x = minor(s.xy, s.yz, s.xz, b);
    const Doubles y = minor(s.xz, s.xy, a, s.yz);
    const Doubles z = minor(a, b, s.xy, s.xy);
    const Doubles length2 = hn::Add(hn::Add(mul(x, x), mul(y, y)), mul(z, z));
    const Doubles length = hn::Sqrt(length2);
    // An inexact root leaves a residual. It turns the axis by at most residual / (middle - l), and
    // middle - l >= length / trace.
    const Doubles residual = hn::Add(hn::Add(mul(s.xz, x), mul(s.yz, y)), mul(hn::Sub(s.zz, l), z));
    const Doubles trace2 = mul(trace, trace);
    auto good = hn::AndNot(under_way, enough);
    good = hn::And(good, hn::Gt(length, mul(trace2, set(kMinLength))));
    good = hn::And(good, hn::Gt(length, mul(mul(mul(s.n, s.n), trace), set(min_middle))));
    good = hn::And(good, hn::Le(mul(hn::Abs(residual), trace), mul(length2, set(kMaxTurn))));
    const Doubles inverse = hn::Div(set(1.0), length);
    return {mul(x, inverse), mul(y, inverse), mul(z, inverse), good};
}

/// One row of the results of a strip.
struct StripOut {
    float* normal_x;
    float* normal_y;
    float* normal_z;
    float* slope;
    float* roughness;
};

/// Centre heights (0 if unknown), and flags of known cells.
struct Center {
    Doubles z;
    Mask known;
};
HWY_INLINE Center center_at(const float* height_m) {
    const Doubles z = doubles(height_m);
    const auto known = hn::Eq(z, z);
    return {hn::IfThenElseZero(known, z), known};
}

void normals_of(const Surface& surface,
                const DiscSums& sums,
                const float* height_m,
                int count,
                const StripOut& out) {
    const double per_cell = 1.0 / surface.resolution_m;
    const double min_middle = kMinMiddleVariance_m2 * per_cell * per_cell;
    for (int i = 0; i < count; i += double_lanes()) {
        const Center center = center_at(height_m + i);
        const Axis axis = smallest_axis(scatter(sums, i, center.z, per_cell), min_middle);
        const Doubles unknown = set(std::numeric_limits<double>::quiet_NaN());
        store(hn::IfThenElse(center.known, axis.x, unknown), out.normal_x + i);
        store(hn::IfThenElse(center.known, axis.y, unknown), out.normal_y + i);
        store(hn::IfThenElse(center.known, axis.z, unknown), out.normal_z + i);
        const auto poor = hn::AndNot(axis.good, center.known);
        if (hn::AllFalse(kDoubles, poor)) continue;
        std::uint8_t lanes[8] = {};
        hn::StoreMaskBits(kDoubles, poor, lanes);
        for (int k = i; k < std::min(i + double_lanes(), count); ++k) {
            if ((lanes[0] >> (k - i) & 1) == 0) continue;
            const Normal normal = plain_normal(height_m + k, surface.plain_normals);
            out.normal_x[k] = normal.x;
            out.normal_y[k] = normal.y;
            out.normal_z[k] = normal.z;
        }
    }
}

/// acos(x) for 0 <= x <= 1 as sqrt(1 - x) p(1 - x). The fit of p minimises the largest error
/// (Remez): 2.2e-8 of p, 3e-7 rad with all roundings.
HWY_INLINE Floats arc_cosine(Floats x) {
    const Floats u = hn::Sub(setf(1.0F), x);
    Floats p = setf(1.26283061e-3F);
    for (const float c : {-2.16852213e-3F,
                          3.58149918e-3F,
                          1.3143168e-3F,
                          8.27382713e-3F,
                          2.6465065e-2F,
                          1.17853748e-1F,
                          1.41421354F}) {
        p = hn::Add(hn::Mul(p, u), setf(c));
    }
    return hn::Mul(hn::Sqrt(u), p);
}

/// Returns 1 - value / critical, at least 0, and 0 for NaN.
HWY_INLINE Floats rating(Floats value, float critical, float inverse) {
    const Floats passable = hn::Sub(setf(1.0F), hn::Mul(value, setf(inverse)));
    const Floats positive = hn::Max(passable, setf(std::numeric_limits<float>::min()));
    return hn::IfThenElseZero(hn::Lt(value, setf(critical)), positive);
}

void slopes_of(const Surface& surface, int columns, const StripOut& out) {
    const auto critical = static_cast<float>(surface.slope_config.critical_rad);
    const auto inverse = static_cast<float>(1.0 / surface.slope_config.critical_rad);
    for (int i = 0; i < columns; i += float_lanes()) {
        const Floats normal_z = hn::LoadU(kFloats, out.normal_z + i);
        const Floats slope = rating(arc_cosine(normal_z), critical, inverse);
        hn::StoreU(hn::IfThenElse(hn::IsNaN(normal_z), normal_z, slope), kFloats, out.slope + i);
    }
}

void roughness_of(const Surface& surface,
                  const DiscSums& sums,
                  const float* height_m,
                  int columns,
                  const StripOut& out) {
    const double per_cell = 1.0 / surface.resolution_m;
    HWY_ALIGN float square_m2[kStrip];  // n times the sum of squared distances
    for (int i = 0; i < columns; i += double_lanes()) {
        const Scatter s = scatter(sums, i, center_at(height_m + i).z, per_cell);
        const Doubles x = doubles(out.normal_x + i);
        const Doubles y = doubles(out.normal_y + i);
        const Doubles z = doubles(out.normal_z + i);
        const auto times = [](Doubles a, Doubles b) { return hn::Mul(a, b); };
        const Doubles sx = hn::Add(hn::Add(times(s.xx, x), times(s.xy, y)), times(s.xz, z));
        const Doubles sy = hn::Add(hn::Add(times(s.xy, x), times(s.yy, y)), times(s.yz, z));
        const Doubles sz = hn::Add(hn::Add(times(s.xz, x), times(s.yz, y)), times(s.zz, z));
        const Doubles square = hn::Add(hn::Add(times(sx, x), times(sy, y)), times(sz, z));
        store(times(hn::Max(square, hn::Zero(kDoubles)),
                    set(surface.resolution_m * surface.resolution_m)),
              square_m2 + i);
    }
    const auto critical = static_cast<float>(surface.roughness_config.critical_m);
    const auto inverse = static_cast<float>(1.0 / surface.roughness_config.critical_m);
    for (int i = 0; i < columns; i += float_lanes()) {
        const Floats n = hn::Load(kFloats, sums.n + i);
        const Floats freedom = hn::Mul(n, hn::Sub(n, setf(1.0F)));
        const Floats value_m = hn::Sqrt(hn::Div(hn::Load(kFloats, square_m2 + i), freedom));
        const Floats normal_x = hn::LoadU(kFloats, out.normal_x + i);
        // 0 / 0 of a cell without neighbours is NaN, which is rated 0.
        hn::StoreU(
            hn::IfThenElse(hn::IsNaN(normal_x), normal_x, rating(value_m, critical, inverse)),
            kFloats,
            out.roughness + i);
    }
}

/// Finds the runs of a disc. `center[dy]` points to the runs of the row that lies dy rows from the
/// centre.
HWY_INLINE DiscOfRuns disc_of(const DiscRuns& runs, const RunSums* const* center) {
    DiscOfRuns disc;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled as far as read
    disc.reach = runs.reach;
    for (int dy = 0; dy <= runs.reach; ++dy) {
        const int width = runs.width[static_cast<std::size_t>(dy)];
        disc.above[dy] = center[dy] + width;
        disc.below[dy] = center[-dy] + width;
    }
    return disc;
}

void rate_strip(const Surface& surface,
                const CellRect& strip,
                RunSums* ring,
                const SurfaceLayers& out) {
    const int reach = surface.widths.reach();
    const int kept = 2 * reach + 1;
    const std::vector<int>& half_widths = surface.widths.half_widths();
    const int columns = (strip.nx + 15) / 16 * 16;
    const bool same_disc = surface.normals.width == surface.roughness.width;
    RunSums* row[2 * DiscRuns::kMaxReach + 1];  // row dy of the current disc is [dy + reach]
    for (int k = 0; k < kept; ++k) row[k] = ring + static_cast<std::size_t>(k) * half_widths.size();
    RowCells cells[2];
    const auto load = [&](int iy) {
        const float* from = surface.height_m.cell(strip.ix0 - reach, iy);
        ask_for_next_strip(from + 2 * reach);
        load_row(from, columns + 2 * reach, cells[iy & 1]);
    };
    load(strip.iy0 - reach);
    DiscSums sums;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled before read
    // A strip narrower than whole registers is rated in a buffer and copied.
    const bool whole = columns == strip.nx;
    HWY_ALIGN float beside[5][kStrip];
    grid::Layer* const layers[5] = {
        &out.normal_x, &out.normal_y, &out.normal_z, &out.slope, &out.roughness};
    for (int iy = strip.iy0 - reach; iy < strip.iy0 + strip.ny + reach; ++iy) {
        std::rotate(row, row + 1, row + kept);
        // Loads one row ahead: a load right after a store at another offset would stall.
        if (iy + 1 < strip.iy0 + strip.ny + reach) load(iy + 1);
        reduce_heights(cells[iy & 1], reach, columns, half_widths, row[kept - 1]);
        reduce_counts(cells[iy & 1], reach, columns, half_widths, row[kept - 1]);
        const int center = iy - reach;
        if (center < strip.iy0) continue;
        const float* const height_m = surface.height_m.cell(strip.ix0, center);
        float* to[5];
        for (int k = 0; k < 5; ++k) to[k] = whole ? layers[k]->row(center) + strip.ix0 : beside[k];
        // A narrow strip is always the last one, so nothing is prefetched.
        for (int k = 0; whole && k < 5; ++k) ask_for_next_strip(to[k]);
        const StripOut results{to[0], to[1], to[2], to[3], to[4]};
        const DiscOfRuns normals = disc_of(surface.normals, row + reach);
        sum_heights(normals, columns, sums);
        sum_counts(normals, columns, sums);
        normals_of(surface, sums, height_m, strip.nx, results);
        slopes_of(surface, columns, results);
        if (!same_disc) {
            const DiscOfRuns roughness = disc_of(surface.roughness, row + reach);
            sum_heights(roughness, columns, sums);
            sum_counts(roughness, columns, sums);
        }
        roughness_of(surface, sums, height_m, columns, results);
        for (int k = 0; !whole && k < 5; ++k)
            std::copy_n(beside[k], strip.nx, layers[k]->row(center) + strip.ix0);
    }
}

void rate_surface_block(const Surface& surface,
                        const CellRect& rect,
                        RunSums* ring,
                        const SurfaceLayers& out) {
    for (int first = 0; first < rect.nx; first += kStrip) {
        const CellRect strip{
            rect.ix0 + first, rect.iy0, std::min(kStrip, rect.nx - first), rect.ny};
        rate_strip(surface, strip, ring, out);
    }
}

}  // namespace
}  // namespace surefoot::traversability::rows::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace surefoot::traversability::rows {

HWY_EXPORT(rate_surface_block);

void rate_surface(const Surface& surface,
                  const CellRect& rect,
                  RunSums* ring,
                  const SurfaceLayers& out) {
    HWY_DYNAMIC_DISPATCH(rate_surface_block)(surface, rect, ring, out);
}

}  // namespace surefoot::traversability::rows
#endif  // HWY_ONCE
