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

/// Valid resolutions: 0.1 mm to 100 m. Other values come from damaged data.
constexpr double kFinest_m = 1e-4;
constexpr double kCoarsest_m = 100.0;
/// Highest magnitude of a height. Above it a float resolves only decimetres. The limit also keeps
/// sums and squares of heights finite.
constexpr float kHighest_m = 1e6F;
/// Tolerance for the squared length of a quaternion: covers the rounding of a file.
constexpr double kNormTolerance = 1e-6;

/// Returns true for NaN (unknown) and for finite numbers of 0 or more.
bool absent_or_not_negative(float value) {
    return std::isnan(value) || (std::isfinite(value) && value >= 0.0F);
}

std::optional<std::string> problem_of_known(const MapRegion& r, std::size_t i) {
    const auto fault = [](const char* layer, float value, const char* limit) {
        return fmt::format("{} {}; {}", layer, value, limit);
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
    if (!is_height(height_m)) return fault("elevation", height_m, "it must be -1e6 to 1e6 m");
    if (!(std::isfinite(var_m2) && var_m2 > 0.0F))
        return fault("variance", var_m2, "it must be finite and above 0 m2");
    if (!(std::isfinite(drift_m) && drift_m >= 0.0F))
        return fault("drift", drift_m, "it must be finite and 0 m or more");
    if (!is_height(highest_m)) return fault("highest", highest_m, "it must be -1e6 to 1e6 m");
    // `lowest` is not compared with `highest`: both are robust values, and with few points the
    // lowest may exceed the highest.
    if (!is_height(lowest_m)) return fault("lowest", lowest_m, "it must be -1e6 to 1e6 m");
    if (!(std::isnan(clearance_m) || is_height(clearance_m)))
        return fault("clearance", clearance_m, "it must be -1e6 to 1e6 m");
    if (!(confidence >= 0.0F && confidence <= 1.0F))
        return fault("confidence", confidence, "it must be 0 to 1");
    if (!absent_or_not_negative(density))
        return fault("density_ratio", density, "it must be finite and 0 or more");
    if (r.count.data()[i] == 0)
        return "count 0, although its height is known; it must be 1 or more";
    return std::nullopt;
}

std::optional<std::string> problem_of_unknown(const MapRegion& r, std::size_t i) {
    std::optional<std::string> problem;
    for_each_layer([&](const RegionLayer& layer, auto member, auto unknown) {
        const auto value = (r.*member).data()[i];
        // NaN is not equal to itself, so `unknown == unknown` is false for NaN.
        const bool is_unknown = unknown == unknown ? value == unknown : value != value;
        if (!is_unknown && !problem)
            problem = fmt::format(
                "{} {} where the height is unknown; a cell without a height must have no other "
                "value",
                layer.name,
                value);
    });
    return problem;
}

std::optional<std::string> problem_of_head(const MapRegion& r) {
    if (!(r.resolution_m >= kFinest_m && r.resolution_m <= kCoarsest_m)) {
        return fmt::format("the map has cells of {:g} m; a cell must be {:g} to {:g} m wide",
                           r.resolution_m,
                           kFinest_m,
                           kCoarsest_m);
    }
    const auto printable = [](char c) { return c > ' ' && c <= '~'; };
    if (r.frame.empty() || r.frame.size() > kMaxFrameName ||
        !std::all_of(r.frame.begin(), r.frame.end(), printable)) {
        return fmt::format(
            "the name of the map's frame must be 1 to {} printable characters without blanks",
            kMaxFrameName);
    }
    if (!r.T_frame_body.all_finite() ||
        std::abs(r.T_frame_body.rotation.squaredNorm() - 1.0) > kNormTolerance) {
        return "the pose of base_link is invalid: a number is not finite or the quaternion does "
               "not have length 1";
    }
    return std::nullopt;
}

}  // namespace

std::optional<std::string> LatticeBox::problem() const {
    if (nx < 1 || ny < 1 || nx > kMaxRegionSide || ny > kMaxRegionSide ||
        std::int64_t{nx} * ny > kMaxRegionCells) {
        return fmt::format(
            "the region has {} x {} cells; a side must have 1 to {} cells and a region at most {} "
            "cells",
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
            "the first cell is ({}, {}) of the lattice; it must be within {} cells of the "
            "origin",
            first_ix,
            first_iy,
            kMaxLatticeIndex);
    }
    return std::nullopt;
}

LatticeBox box_of(const GridGeometry& geometry) {
    // `origin_m` was computed as a whole number times the cell size (`MovingWindow`). The quotient
    // can miss this number by a rounding error; `round` removes the error.
    const Eigen::Vector2d first = geometry.origin_m / geometry.resolution_m;
    return {saturated_integer<std::int64_t>(std::round(first.x())),
            saturated_integer<std::int64_t>(std::round(first.y())),
            geometry.nx,
            geometry.ny};
}

LatticeBox united(const LatticeBox& a, const LatticeBox& b) {
    // Limits the side to the largest int; such a box is invalid in any case.
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
            wrong_size = fmt::format("layer {} does not have {} x {} cells, the size of the region",
                                     layer.name,
                                     box.nx,
                                     box.ny);
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
    // column of `region` that becomes column 0
    const std::int64_t dx = box.first_ix - had.first_ix;
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
