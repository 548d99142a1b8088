// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/fusion/height_residuals.hpp"

#include <cmath>
#include <optional>

namespace surefoot::elevation {
namespace {

/// Distance [cells] to the neighbours that reveal a step between them and the cell. The distance
/// also covers an edge that the body's horizontal drift has moved by one cell.
constexpr int kBeside = 2;
/// Neighbours share the matcher's errors, so every second cell in both directions is enough.
constexpr int kEvery = 2;

bool is_old(const HeightResiduals::Input& input, std::ptrdiff_t cell) {
    if (input.alignment.is_asked[cell] != 0) return false;
    const float motion_m2 =
        motion_variance(input.layers.height_var_m2.data()[cell], input.alignment.var_m2[cell]);
    return static_cast<double>(motion_m2) >= input.min_drift_m * input.min_drift_m;
}

/// Returns the slope of the map around a cell, or nothing if the cell is not level.
std::optional<Eigen::Vector2f> level_slope(const HeightResiduals::Input& input,
                                           std::ptrdiff_t cell) {
    const float* z_m = input.layers.height_m.data() + cell;
    const auto row = static_cast<std::ptrdiff_t>(kBeside) * input.geometry.nx;
    const auto level_m = static_cast<float>(input.level_m);
    const auto is_level = [&](float other_m) {
        return std::abs(other_m - *z_m) <= level_m;  // false for NaN
    };
    if (!is_level(z_m[-kBeside]) || !is_level(z_m[kBeside])) return std::nullopt;
    if (!is_level(z_m[-row]) || !is_level(z_m[row])) return std::nullopt;
    const auto span_m = static_cast<float>(2 * kBeside * input.geometry.resolution_m);
    return Eigen::Vector2f((z_m[kBeside] - z_m[-kBeside]) / span_m,
                           (z_m[row] - z_m[-row]) / span_m);
}

bool is_usable(const HeightResidual& residual) {
    return std::isfinite(residual.offset_m) && std::isfinite(residual.motion_var_m2) &&
           std::isfinite(residual.drift_m) && std::isfinite(residual.var_m2) &&
           residual.var_m2 > 0.0F;
}

HeightResidual residual_of(const HeightResiduals::Input& input,
                           grid::Cell at,
                           std::ptrdiff_t cell,
                           const Eigen::Vector2f& slope) {
    const CellMeasurement& measured = input.measured[cell];
    const float height_m = input.layers.height_m.data()[cell];
    const float var_m2 = input.layers.height_var_m2.data()[cell];
    const float aligned_m2 = input.alignment.var_m2[cell];
    const Eigen::Vector2d at_m = input.geometry.center_m(at);
    const Eigen::Vector2d from_m = at_m - input.camera_m;
    const Eigen::Vector2d left(-input.ahead.y(), input.ahead.x());
    return {at_m,
            {static_cast<float>(from_m.dot(input.ahead)), static_cast<float>(from_m.dot(left))},
            slope,
            height_m,
            measured.z_m - height_m,
            measured.var_m2 + aligned_m2,
            motion_variance(var_m2, aligned_m2),
            input.layers.horizontal_drift_m.data()[cell],
            input.alignment.step[cell],
            input.motions};
}

}  // namespace

std::size_t HeightResiduals::gather(const Input& input) {
    const int nx = input.geometry.nx;
    const int ny = input.geometry.ny;
    recent_.clear();
    recent_.reserve(input.layers.height_m.size() / 4 + 1);
    old_.reserve(kMostOld);
    std::erase_if(old_, [&](const HeightResidual& residual) {
        return input.motions - residual.seen_step > input.kept_motions;
    });
    const std::size_t before = old_.size();
    for (int iy = kBeside; iy < ny - kBeside; iy += kEvery) {
        for (int ix = kBeside; ix < nx - kBeside; ix += kEvery) {
            const auto cell = static_cast<std::ptrdiff_t>(iy) * nx + ix;
            if (input.measured[cell].points == 0) continue;
            const bool is_recent = input.motions - input.alignment.step[cell] < input.min_motions;
            if (!is_recent && (old_.size() == kMostOld || !is_old(input, cell))) continue;
            const auto slope = level_slope(input, cell);
            if (!slope) continue;
            const HeightResidual residual = residual_of(input, {ix, iy}, cell, *slope);
            if (!is_usable(residual)) continue;
            if (!is_recent) input.alignment.is_asked[cell] = 1;
            (is_recent ? recent_ : old_).push_back(residual);
        }
    }
    return old_.size() - before;
}

}  // namespace surefoot::elevation
