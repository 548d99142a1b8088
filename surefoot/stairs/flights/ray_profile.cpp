// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/flights/ray_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/geometry/statistics.hpp"
#include "surefoot/stairs/flights/ray_plane.hpp"

namespace surefoot::stairs {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kBefore_rad = 0.035;  ///< angle of the included upper ground, before the edge
/// Angle of the examined ground behind the edge. It shows three steps (riser 0.15 m, going 0.31 m)
/// from 0.7 m away.
constexpr double kBehind_rad = 0.3;
constexpr double kMargin_m = 0.1;  ///< length left out at both ends, which are less certain
constexpr std::size_t kLeastSamples = 6;
constexpr double kLeastSigma_m = 0.004;
constexpr double kSigmaOfMedian = 1.25;

}  // namespace

void RayProfile::gather(const Terrain& terrain,
                        const Edge& edge,
                        double height_m,
                        double distance_m) {
    const View& view = *terrain.view;
    const Vector2d down = edge.down();
    const Vector2d along = edge.along();
    const RayPlane plane(view, down, along);
    const double begin_m = (edge.from_m - view.T_map_camera.translation_m.head<2>()).dot(along);
    const double length_m = edge.length_m();
    const double steep = height_m / distance_m;  // steepness of the ray that meets the edge
    bin_rad_ = kRayBin_px / view.fy_px;
    // Returns the steepness of the ray that is flatter by the angle with this tangent.
    const auto steepness_at = [&](double tangent) {
        return (steep - tangent) / (1.0 + steep * tangent);
    };
    // in range: Camera::problem() bounds the focal length
    const int bins = static_cast<int>((kBefore_rad + kBehind_rad) / bin_rad_);
    bins_.resize(static_cast<std::size_t>(bins));
    for (int k = 0; k < bins; ++k)
        bins_[static_cast<std::size_t>(k)].steepness =
            steepness_at((k + 0.5) * bin_rad_ - kBefore_rad);

    samples_.clear();
    const ImageView<const float> disparity_px = terrain.disparity_px;
    const double depth_px_m = view.fx_px * view.baseline_m;
    for (int u = 0; u < disparity_px.width; u += kRayStride_px) {
        const RayPlane::Rows rows = plane.rows_between(
            steepness_at(-kBefore_rad), steepness_at(kBehind_rad), u, disparity_px.height);
        for (int v = rows.first; v <= rows.last; ++v) {
            const double z_m = depth_px_m / static_cast<double>(disparity_px.row(v)[u]);
            if (!(z_m > 0.0)) continue;
            const double along_m = z_m * plane.aside.at(u, v) - begin_m;
            const double run_here = plane.run.at(u, v);
            if (!(along_m > kMargin_m && along_m < length_m - kMargin_m && run_here > 0.0))
                continue;
            const double fall_here = plane.fall.at(u, v);
            const double steepness = fall_here / run_here;
            const double tangent = (steep - steepness) / (1.0 + steep * steepness);
            const double bin = (tangent + kBefore_rad) / bin_rad_;
            if (!(bin >= 0.0 && bin < bins)) continue;
            samples_.push_back(
                {static_cast<std::int32_t>(bin), static_cast<float>(z_m * fall_here - height_m)});
        }
    }
}

void RayProfile::measure_bins() {
    const std::size_t bins = bins_.size();
    first_.assign(bins + 1, 0);
    for (const Sample& sample : samples_) ++first_[static_cast<std::size_t>(sample.bin) + 1];
    for (std::size_t k = 0; k < bins; ++k) first_[k + 1] += first_[k];
    next_.assign(first_.begin(), first_.end());
    depths_m_.resize(samples_.size());
    for (const Sample& sample : samples_)
        depths_m_[next_[static_cast<std::size_t>(sample.bin)]++] = sample.depth_m;
    for (std::size_t k = 0; k < bins; ++k) {
        RayBin& bin = bins_[k];
        bin.depth_m = bin.sigma_m = std::numeric_limits<double>::quiet_NaN();
        const std::size_t count = first_[k + 1] - first_[k];
        if (count < kLeastSamples) continue;
        values_m_.assign(depths_m_.begin() + static_cast<std::ptrdiff_t>(first_[k]),
                         depths_m_.begin() + static_cast<std::ptrdiff_t>(first_[k + 1]));
        const float middle_m = upper_median_in_place(values_m_);
        const double scatter_m = robust_sigma_about(middle_m, values_m_);
        const double independent =
            std::max(1.0, static_cast<double>(count) * kRayStride_px / kRayColumns_px);
        bin.depth_m = static_cast<double>(middle_m);
        bin.sigma_m = std::max(kLeastSigma_m, kSigmaOfMedian * scatter_m / std::sqrt(independent));
    }
}

std::span<const RayBin> RayProfile::observation(const Terrain& terrain, const Edge& edge) {
    bins_.clear();
    if (!terrain.view || terrain.disparity_px.empty()) return {};
    const Vector3d& camera_m = terrain.view->T_map_camera.translation_m;
    const double height_m = camera_m.z() - edge.upper_m;
    const double distance_m = -edge.below_m(camera_m.head<2>());
    if (!(height_m > 0.0 && distance_m > 0.0 && terrain.view->fy_px > 0.0)) return {};
    gather(terrain, edge, height_m, distance_m);
    measure_bins();
    return bins_;
}

}  // namespace surefoot::stairs
