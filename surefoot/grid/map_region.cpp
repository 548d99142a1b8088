// SPDX-License-Identifier: Apache-2.0
#include "surefoot/grid/map_region.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::grid {
namespace {

/// 0.1 mm to 100 m: beyond these a resolution is a damaged number.
constexpr double kFinest_m = 1e-4;
constexpr double kCoarsest_m = 100.0;
/// Beyond a float tells no more than decimetres; keeps sums and squares of heights in its range.
constexpr float kHighest_m = 1e6F;
/// How far a quaternion may be from length one, squared: what rounding to a file leaves.
constexpr double kNormTolerance = 1e-6;

/// NaN, where it says that something is not known, or a number that is not negative.
bool absent_or_not_negative(float value) {
    return std::isnan(value) || (std::isfinite(value) && value >= 0.0F);
}

std::optional<std::string> problem_of_known(const MapRegion& r, std::size_t i) {
    const auto fault = [](const char* layer, float value, const char* limit) {
        return fmt::format("{} {} where {}", layer, value, limit);
    };
    const float height_m = r.height_m.data()[i];
    const float var_m2 = r.height_var_m2.data()[i];
    const float drift_m = r.horizontal_drift_m.data()[i];
    const float highest_m = r.highest_m.data()[i];
    const float lowest_m = r.lowest_m.data()[i];
    const float clearance_m = r.clearance_m.data()[i];
    const float confidence = r.confidence.data()[i];
    const float density = r.density_ratio.data()[i];
    const auto is_height = [](float z_m) { return z_m >= -kHighest_m && z_m <= kHighest_m; };
    if (!is_height(height_m)) return fault("elevation", height_m, "-1e6 to 1e6 m are possible");
    if (!(std::isfinite(var_m2) && var_m2 > 0.0F))
        return fault("variance", var_m2, "a positive one is needed");
    if (!(std::isfinite(drift_m) && drift_m >= 0.0F))
        return fault("drift", drift_m, "none is negative or NaN");
    if (!is_height(highest_m)) return fault("highest", highest_m, "-1e6 to 1e6 m are possible");
    // Each is robust in its own way: of few points the lowest may be above the highest.
    if (!is_height(lowest_m)) return fault("lowest", lowest_m, "-1e6 to 1e6 m are possible");
    if (!(std::isnan(clearance_m) || is_height(clearance_m)))
        return fault("clearance", clearance_m, "-1e6 to 1e6 m are possible");
    if (!(confidence >= 0.0F && confidence <= 1.0F))
        return fault("confidence", confidence, "0 to 1 are possible");
    if (!absent_or_not_negative(density))
        return fault("density_ratio", density, "none is negative or infinite");
    if (r.count.data()[i] == 0) return "count 0 where the height is known";
    return std::nullopt;
}

std::optional<std::string> problem_of_unknown(const MapRegion& r, std::size_t i) {
    std::optional<std::string> problem;
    for_each_layer([&](const RegionLayer& layer, auto member, auto unknown) {
        const auto value = (r.*member).data()[i];
        // NaN is not equal to itself.
        const bool is_unknown = unknown == unknown ? value == unknown : value != value;
        if (!is_unknown && !problem)
            problem = fmt::format("{} {} where the height is unknown", layer.name, value);
    });
    return problem;
}

std::optional<std::string> problem_of_head(const MapRegion& r) {
    if (!(r.resolution_m >= kFinest_m && r.resolution_m <= kCoarsest_m)) {
        return fmt::format(
            "cells of {:g} m; {:g} to {:g} m are possible", r.resolution_m, kFinest_m, kCoarsest_m);
    }
    const auto printable = [](char c) { return c > ' ' && c <= '~'; };
    if (r.frame.empty() || r.frame.size() > kMaxFrameName ||
        !std::all_of(r.frame.begin(), r.frame.end(), printable)) {
        return fmt::format("its frame needs a name of 1 to {} printable characters without blanks",
                           kMaxFrameName);
    }
    if (!r.T_frame_body.all_finite() ||
        std::abs(r.T_frame_body.rotation.squaredNorm() - 1.0) > kNormTolerance) {
        return "the pose of base_link is not one: its numbers are not finite or its quaternion is "
               "not of length 1";
    }
    return std::nullopt;
}

}  // namespace

std::optional<std::string> LatticeBox::problem() const {
    if (nx < 1 || ny < 1 || nx > kMaxRegionSide || ny > kMaxRegionSide ||
        std::int64_t{nx} * ny > kMaxRegionCells) {
        return fmt::format("{} x {} cells; 1 to {} a side and {} in all are possible",
                           nx,
                           ny,
                           kMaxRegionSide,
                           kMaxRegionCells);
    }
    const auto is_near = [](std::int64_t index) {
        return index >= -kMaxLatticeIndex && index <= kMaxLatticeIndex;
    };
    if (!is_near(first_ix) || !is_near(first_iy)) {
        return fmt::format(
            "first cell ({}, {}) of the lattice; up to {} from the origin are "
            "possible",
            first_ix,
            first_iy,
            kMaxLatticeIndex);
    }
    return std::nullopt;
}

LatticeBox box_of(const GridGeometry& geometry) {
    // An origin is a whole number of cells, so the rounding takes back that of the product alone.
    const Eigen::Vector2d first = geometry.origin_m / geometry.resolution_m;
    return {saturated_integer<std::int64_t>(std::round(first.x())),
            saturated_integer<std::int64_t>(std::round(first.y())),
            geometry.nx,
            geometry.ny};
}

LatticeBox united(const LatticeBox& a, const LatticeBox& b) {
    // Beyond the largest int a box is as impossible as at it.
    const auto side = [](std::int64_t cells) {
        return static_cast<int>(std::min<std::int64_t>(cells, std::numeric_limits<int>::max()));
    };
    const std::int64_t first_ix = std::min(a.first_ix, b.first_ix);
    const std::int64_t first_iy = std::min(a.first_iy, b.first_iy);
    return {first_ix,
            first_iy,
            side(std::max(a.first_ix + a.nx, b.first_ix + b.nx) - first_ix),
            side(std::max(a.first_iy + a.ny, b.first_iy + b.ny) - first_iy)};
}

GridGeometry MapRegion::geometry() const {
    return {resolution_m,
            box.nx,
            box.ny,
            {static_cast<double>(box.first_ix) * resolution_m,
             static_cast<double>(box.first_iy) * resolution_m}};
}

std::int64_t MapRegion::known_cells() const noexcept {
    return std::count_if(height_m.data(), height_m.data() + height_m.size(), [](float h_m) {
        return !std::isnan(h_m);
    });
}

std::optional<std::string> MapRegion::problem() const {
    if (auto problem = box.problem()) return problem;
    if (auto problem = problem_of_head(*this)) return problem;
    std::optional<std::string> wrong_size;
    for_each_layer([&](const RegionLayer& layer, auto member, auto) {
        const auto& values = this->*member;
        if (values.width() != box.nx || values.height() != box.ny)
            wrong_size =
                fmt::format("layer {} is not of {} x {} cells", layer.name, box.nx, box.ny);
    });
    if (wrong_size) return wrong_size;
    for (std::size_t i = 0; i < height_m.size(); ++i) {
        const auto problem = std::isnan(height_m.data()[i]) ? problem_of_unknown(*this, i)
                                                            : problem_of_known(*this, i);
        if (!problem) continue;
        const auto cell = static_cast<int>(i);
        return fmt::format("cell ({}, {}) has {}", cell % box.nx, cell / box.nx, *problem);
    }
    return std::nullopt;
}

MapRegion cut(MapRegion region, const LatticeBox& box) {
    SUREFOOT_ASSERT(!box.problem());
    const LatticeBox& had = region.box;
    const std::int64_t dx = box.first_ix - had.first_ix;  // column in `region` of column 0 here
    const std::int64_t dy = box.first_iy - had.first_iy;
    const std::int64_t begin_ix = std::clamp<std::int64_t>(-dx, 0, box.nx);
    const std::int64_t end_ix = std::clamp<std::int64_t>(had.nx - dx, begin_ix, box.nx);
    const std::int64_t begin_iy = std::clamp<std::int64_t>(-dy, 0, box.ny);
    const std::int64_t end_iy = std::clamp<std::int64_t>(had.ny - dy, begin_iy, box.ny);
    for_each_layer([&](const RegionLayer&, auto member, auto unknown) {
        auto& had_layer = region.*member;
        std::decay_t<decltype(had_layer)> layer(box.nx, box.ny, unknown);
        for (std::int64_t iy = begin_iy; iy < end_iy && begin_ix < end_ix; ++iy) {
            std::copy_n(had_layer.row(static_cast<int>(iy + dy)) + begin_ix + dx,
                        end_ix - begin_ix,
                        layer.row(static_cast<int>(iy)) + begin_ix);
        }
        had_layer = std::move(layer);
    });
    region.box = box;
    return region;
}

void forget(MapRegion& region, std::size_t cell) {
    for_each_layer([&](const RegionLayer&, auto member, auto unknown) {
        (region.*member).data()[cell] = unknown;
    });
}

}  // namespace surefoot::grid
