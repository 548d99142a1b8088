// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stairs/flights/ray_faces.hpp"

#include <algorithm>
#include <cmath>

#include "surefoot/geometry/statistics.hpp"
#include "surefoot/stairs/edges/edge_border.hpp"
#include "surefoot/stairs/flights/ray_plane.hpp"

namespace surefoot::stairs {
namespace {

constexpr double kMargin_m = 0.05;  ///< length left out at both ends of an edge
/// Lower and upper end of the used part of a face, as shares of its height. A semi-global matcher
/// places the top of a face 0.2-0.4 px too far, because its path from above comes from the tread.
/// It places the foot 0.1 px too near, and the rest within 0.05 px.
constexpr double kLowest = 0.1;
constexpr double kHighest = 0.6;
constexpr double kNearest_m = 0.1;  ///< smallest distance of a face from the camera
constexpr double kGate_m = 0.2;     ///< points farther from the face belong to another object
constexpr std::size_t kLeastSamples = 40;
constexpr double kLeastShare = 0.3;
constexpr double kSigmaOfMedian = 1.25;
constexpr double kOpen = 0.5;
constexpr int kRounds = 3;

}  // namespace

/// Fills runs_m_ with the distances to a face, measured by its pixels, across the edge. The pixels
/// are those that show the face if it stands `at_m` from the camera. Returns the number of these
/// pixels, matched or not.
std::size_t RayFaces::gather(const Terrain& terrain, const Edge& edge, double at_m) {
    const View& view = *terrain.view;
    const Eigen::Vector3d& camera_m = view.T_map_camera.translation_m;
    const Eigen::Vector2d along = edge.along();
    const RayPlane plane(view, -edge.down(), along);
    const double begin_m = (edge.from_m - camera_m.head<2>()).dot(along) + kMargin_m;
    const double end_m = begin_m + edge.length_m() - 2.0 * kMargin_m;
    const double foot_m = camera_m.z() - edge.lower_m;
    const double lowest = (foot_m - kLowest * edge.height_m()) / at_m;
    const double highest = (foot_m - kHighest * edge.height_m()) / at_m;
    const ImageView<const float> disparity_px = terrain.disparity_px;
    const double depth_px_m = view.fx_px * view.baseline_m;
    const double halfway = 0.5 * (lowest + highest);
    runs_m_.clear();
    lower_m_.clear();
    upper_m_.clear();
    std::size_t pixels = 0;
    for (int u = 0; u < disparity_px.width; u += kRayStride_px) {
        const RayPlane::Rows rows = plane.rows_between(lowest, highest, u, disparity_px.height);
        if (rows.last - rows.first + 1 >= disparity_px.height)
            continue;  // the face is seen edge-on
        for (int v = rows.first; v <= rows.last; ++v) {
            const double run = plane.run.at(u, v);
            const double along_m = at_m / run * plane.aside.at(u, v);
            if (!(run > 0.0 && along_m > begin_m && along_m < end_m)) continue;
            ++pixels;
            const double run_m = depth_px_m / static_cast<double>(disparity_px.row(v)[u]) * run;
            if (!(std::abs(run_m - at_m) < kGate_m)) continue;
            runs_m_.push_back(static_cast<float>(run_m));
            const bool upper = plane.fall.at(u, v) < halfway * run;
            (upper ? upper_m_ : lower_m_).push_back(static_cast<float>(run_m));
        }
    }
    return pixels;
}

namespace {

/// Returns the additional distance of level ground behind an open riser: the distance in the upper
/// half of the face's pixels minus that in the lower half.
double level_m(const Terrain& terrain, const Edge& edge, double at_m) {
    const double foot_m = terrain.view->T_map_camera.translation_m.z() - edge.lower_m;
    const double quarter_m = 0.25 * (kHighest - kLowest) * edge.height_m();
    const double middle_m = foot_m - 0.5 * (kLowest + kHighest) * edge.height_m();
    return 2.0 * quarter_m / middle_m * at_m;
}

}  // namespace

bool RayFaces::shows_level_ground(double level_m) {
    if (lower_m_.empty() || upper_m_.empty()) return false;
    return static_cast<double>(upper_median_in_place(upper_m_) - upper_median_in_place(lower_m_)) >
           kOpen * level_m;
}

std::optional<RayFaces::Face> RayFaces::see(const Terrain& terrain, const Edge& edge) {
    const View& view = *terrain.view;
    const double distance_m = edge.below_m(view.T_map_camera.translation_m.head<2>());
    if (!(distance_m > kNearest_m)) return std::nullopt;
    double at_m = distance_m;
    for (int round = 0; round < kRounds; ++round) {
        const std::size_t pixels = gather(terrain, edge, at_m);
        const std::size_t seen = runs_m_.size();
        if (seen < kLeastSamples ||
            static_cast<double>(seen) < kLeastShare * static_cast<double>(pixels))
            return std::nullopt;
        if (shows_level_ground(level_m(terrain, edge, at_m))) {
            Face face;
            face.open = true;
            return face;
        }
        at_m = static_cast<double>(upper_median_in_place(runs_m_));
        if (!(std::abs(at_m - distance_m) < kGate_m)) return std::nullopt;
    }
    const double scatter_m = robust_sigma_about(static_cast<float>(at_m), runs_m_);
    const double independent = std::max(
        1.0, static_cast<double>(runs_m_.size()) * kRayStride_px / (kRayColumns_px * kRayRows_px));
    Face face;
    face.behind_m = at_m - distance_m;
    face.sigma_m = std::hypot(kSigmaOfMedian * scatter_m / std::sqrt(independent),
                              view.range_error_m(kFaceShared_px, edge.middle_m(), edge.upper_m));
    return face;
}

void RayFaces::place(const Terrain& terrain, std::span<Edge> steps) {
    if (!terrain.view || terrain.disparity_px.empty()) return;
    for (Edge& edge : steps) {
        const std::optional<Face> face = see(terrain, edge);
        if (!face) continue;
        edge.open = face->open;
        // The map omits the part of a board beside the depth jump to the ground below.
        const Eigen::Vector3d middle_m(edge.middle_m().x(), edge.middle_m().y(), edge.upper_m);
        const double behind_m =
            face->open ? -terrain.view->unmapped_m(middle_m, -edge.down()) : face->behind_m;
        const Eigen::Vector2d shift_m = -behind_m * edge.down();
        edge.from_m += shift_m;
        edge.to_m += shift_m;
        if (!face->open) edge.across_sigma_m = face->sigma_m;
    }
}

}  // namespace surefoot::stairs
