// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/safety_oracle/swept_box.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#include "surefoot/core/checked_index.hpp"

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;

constexpr double kPiece_rad = 0.5 * std::numbers::pi / 180.0;
/// A point on the border belongs to the box, despite rounding errors of the motion.
constexpr double kRim_m = 1e-9;

/// Narrows [enter, leave] to the part of the path where `offset - s * travel` lies in [low, high].
/// The result is empty (leave < enter) if there is no such part.
void clip_slab(
    double offset, double travel, double low, double high, double& enter, double& leave) {
    if (travel == 0.0) {
        if (offset < low || offset > high) leave = -1.0;
        return;
    }
    const double a = (offset - low) / travel;
    const double b = (offset - high) / travel;
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
}

}  // namespace

Rect grown(const Rect& box, double by_m) {
    return {box.min_m.array() - by_m, box.max_m.array() + by_m};
}

SweptBox::SweptBox(const Rect& box, const PlanarPose& T_a_start, const PlanarPose& T_start_target)
    : box_(grown(box, kRim_m)) {
    const double turn_rad = std::atan2(T_start_target.sin_yaw, T_start_target.cos_yaw);
    const int count =
        std::max(1, saturated_integer<int>(std::ceil(std::abs(turn_rad) / kPiece_rad)));
    const Vector2d step_m = T_start_target.position_m / count;
    bounds_ = {Vector2d::Constant(std::numeric_limits<double>::infinity()),
               Vector2d::Constant(-std::numeric_limits<double>::infinity())};
    const auto enclose = [&](const PlanarPose& T_a_box) {
        for (const double x_m : {box_.min_m.x(), box_.max_m.x()}) {
            for (const double y_m : {box_.min_m.y(), box_.max_m.y()}) {
                const Vector2d corner_m = T_a_box * Vector2d(x_m, y_m);
                bounds_.min_m = bounds_.min_m.cwiseMin(corner_m);
                bounds_.max_m = bounds_.max_m.cwiseMax(corner_m);
            }
        }
    };
    const auto pose_after = [&](double parts, double turned_parts) {
        const Vector2d p_m = parts * step_m;
        return T_a_start * PlanarPose::of(p_m.x(), p_m.y(), turned_parts * turn_rad / count);
    };
    // The box poses at both ends are exact; a piece between them has the yaw of its middle.
    pieces_.push_back({pose_after(0, 0), Vector2d::Zero()});
    for (int k = 0; k < count; ++k) {
        const PlanarPose from = pose_after(k, k + 0.5);
        const PlanarPose to = pose_after(k + 1, k + 0.5);
        pieces_.push_back({from, from.inverse_times(to.position_m)});
        enclose(from);
        enclose(to);
    }
    pieces_.push_back({T_a_start * T_start_target, Vector2d::Zero()});
    enclose(pieces_.front().T_a_box);
    enclose(pieces_.back().T_a_box);
}

bool SweptBox::covers(const Vector2d& p_a) const {
    if ((p_a.array() < bounds_.min_m.array()).any() || (p_a.array() > bounds_.max_m.array()).any())
        return false;
    return std::any_of(pieces_.begin(), pieces_.end(), [&](const Piece& piece) {
        const Vector2d p = piece.T_a_box.inverse_times(p_a);
        double enter = 0.0;
        double leave = 1.0;
        for (int axis = 0; axis < 2; ++axis) {
            clip_slab(
                p[axis], piece.travel_m[axis], box_.min_m[axis], box_.max_m[axis], enter, leave);
        }
        return enter <= leave;
    });
}

}  // namespace surefoot::sim
