// SPDX-License-Identifier: Apache-2.0
#include "surefoot/calibration/bundle/view_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/calibration/bundle/planar_pose.hpp"
#include "surefoot/geometry/statistics.hpp"

namespace surefoot::calibration {
namespace {

std::optional<std::string> point_problem(int id, const Eigen::Vector2d& pixel, ImageSize size) {
    if (!pixel.allFinite())
        return fmt::format("the pixel position of point {} is not a finite number", id);
    // A pixel extends half a pixel beyond its centre.
    if (pixel.x() < -0.5 || pixel.y() < -0.5 || pixel.x() > size.width - 0.5 ||
        pixel.y() > size.height - 0.5) {
        return fmt::format("point {} at ({:.1f}, {:.1f}) px lies outside the {}x{} image",
                           id,
                           pixel.x(),
                           pixel.y(),
                           size.width,
                           size.height);
    }
    return std::nullopt;
}

}  // namespace

void reject(std::vector<RejectedView>& rejected, std::size_t index, const std::string& reason) {
    const auto at = std::lower_bound(
        rejected.begin(), rejected.end(), index, [](const RejectedView& view, std::size_t i) {
            return view.index < i;
        });
    if (at != rejected.end() && at->index == index)
        at->reason += "; " + reason;
    else
        rejected.insert(at, {index, reason});
}

std::optional<std::string> view_problem(const Board& board,
                                        const BoardView& view,
                                        ImageSize size,
                                        int least_points) {
    if (view.ids.size() != view.pixels.size()) {
        return fmt::format("the view has {} ids but {} pixels; give one pixel for each id",
                           view.ids.size(),
                           view.pixels.size());
    }
    if (!(view.disc_radius_m >= 0.0 && view.disc_radius_m <= board.spacing_m))
        return fmt::format(
            "the circles have a radius of {} m and are {} m apart; the radius must be from 0 to "
            "this distance",
            view.disc_radius_m,
            board.spacing_m);
    if (view.ids.empty()) return "the board was not found";
    const std::vector<Eigen::Vector3d> all = board.points_m();
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < view.ids.size(); ++i) {
        const int id = view.ids[i];
        if (id < 0 || static_cast<std::size_t>(id) >= all.size())
            return fmt::format("point {} is not on a board of {} points", id, all.size());
        if (i > 0 && id <= view.ids[i - 1])
            return fmt::format(
                "point {} comes after point {}: ids must ascend", id, view.ids[i - 1]);
        if (auto found = point_problem(id, view.pixels[i], size)) return found;
        points.push_back(all[static_cast<std::size_t>(id)]);
    }
    if (static_cast<int>(points.size()) < least_points) {
        return fmt::format(
            "too few points: {}, at least {} are needed", points.size(), least_points);
    }
    if (collinear(points)) return "all points of the view lie on one line";
    return std::nullopt;
}

double motion_px(const BoardView& a, const BoardView& b) {
    double square = 0.0;
    std::size_t shared = 0;
    for (std::size_t i = 0, k = 0; i < a.ids.size() && k < b.ids.size();) {
        if (a.ids[i] < b.ids[k]) {
            ++i;
        } else if (b.ids[k] < a.ids[i]) {
            ++k;
        } else {
            square += (a.pixels[i++] - b.pixels[k++]).squaredNorm();
            ++shared;
        }
    }
    if (shared == 0 || 2 * shared < std::max(a.ids.size(), b.ids.size()))
        return std::numeric_limits<double>::infinity();
    return std::sqrt(square / static_cast<double>(shared));
}

double disc_radius_m(std::span<const BoardView> views) {
    std::vector<double> radii_m;
    for (const BoardView& view : views)
        if (view.disc_radius_m > 0.0) radii_m.push_back(view.disc_radius_m);
    return median(std::move(radii_m));
}

std::string summary_of(std::span<const RejectedView> rejected, std::size_t views) {
    constexpr std::size_t kShown = 3;
    std::string text = fmt::format("{} of {} views were left out", rejected.size(), views);
    for (std::size_t i = 0; i < std::min(kShown, rejected.size()); ++i) {
        text += fmt::format(
            "{} view {}: {}", i == 0 ? ":" : ";", rejected[i].index, rejected[i].reason);
    }
    return rejected.size() > kShown ? text + "; ..." : text;
}

double median(std::vector<double> values) {
    if (values.empty()) return 0.0;
    return upper_median_in_place(values);
}

}  // namespace surefoot::calibration
