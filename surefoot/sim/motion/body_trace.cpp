// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/motion/body_trace.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace surefoot::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kEvery_s = 0.05;
constexpr double kLegSide_m = 0.15;
constexpr double kFrameBelowHips_m = 0.30;
constexpr double kFrameTop_m = 1.30;
constexpr double kUserTop_m = 2.05;

/// A box in the frame of a link.
struct LinkBox {
    Vector3d min_m;
    Vector3d max_m;
};

enum Part : std::size_t { left_lower, right_lower, left_upper, right_upper, frame, user, count };
constexpr std::array<const char*, Part::count> kNames{
    "left lower leg", "right lower leg", "left upper leg", "right upper leg", "frame", "user"};

LinkBox leg_box(double length_m) {
    const double half = 0.5 * kLegSide_m;
    return {{-half, -half, -length_m}, {half, half, 0.0}};
}
/// A vertical box above base_link; heights are above the soles of the standing machine.
LinkBox trunk_box(double length_m, double width_m, double low_m, double high_m) {
    return {{-0.5 * length_m, -0.5 * width_m, low_m - rex::kStand_m},
            {0.5 * length_m, 0.5 * width_m, high_m - rex::kStand_m}};
}

/// Extends the boxes by points of the parts. Each point is expressed in base_link at the pose of
/// the movement that brings the point nearest to the box, so that it extends the box least.
class Boxes {
  public:
    explicit Boxes(const RexMovement& still) : movement_(still) {
        for (std::size_t i = 0; i < Part::count; ++i) parts_[i].name = kNames[i];
    }
    void start(const RexMovement& movement) { movement_ = movement; }

    void add(Part part, const Pose& T_world_link, const LinkBox& box) {
        for (int corner = 0; corner < 8; ++corner) {
            const Vector3d p((corner & 1) != 0 ? box.max_m.x() : box.min_m.x(),
                             (corner & 2) != 0 ? box.max_m.y() : box.min_m.y(),
                             (corner & 4) != 0 ? box.max_m.z() : box.min_m.z());
            add(part, T_world_link * p);
        }
    }
    [[nodiscard]] std::vector<TracedPart> all() const { return {parts_.begin(), parts_.end()}; }

  private:
    void add(Part part, const Vector3d& p_world_m) {
        TracedPart& traced = parts_[part];
        if (!begun_[part]) {
            begun_[part] = true;
            traced.box = {p_world_m.head<2>(), p_world_m.head<2>()};
            traced.low_m = traced.high_m = p_world_m.z();
            return;
        }
        traced.low_m = std::min(traced.low_m, p_world_m.z());
        traced.high_m = std::max(traced.high_m, p_world_m.z());
        constexpr int kPlaces = 40;
        Vector2d nearest = Vector2d::Zero();
        double least_m = 1e9;
        for (int i = 0; i <= kPlaces; ++i) {
            const RexStand place = moved({}, movement_, static_cast<double>(i) / kPlaces);
            const Vector2d from = p_world_m.head<2>() - Vector2d(place.x_m, place.y_m);
            const double c = std::cos(place.yaw_rad);
            const double s = std::sin(place.yaw_rad);
            const Vector2d p(c * from.x() + s * from.y(), c * from.y() - s * from.x());
            const double out_m = (traced.box.min_m - p).cwiseMax(p - traced.box.max_m).maxCoeff();
            if (out_m < least_m) {
                least_m = out_m;
                nearest = p;
            }
        }
        traced.box.min_m = traced.box.min_m.cwiseMin(nearest);
        traced.box.max_m = traced.box.max_m.cwiseMax(nearest);
    }

    RexMovement movement_;
    std::array<TracedPart, Part::count> parts_;
    std::array<bool, Part::count> begun_{};
};

void add_moment(const RexMotion& motion, double time_s, Boxes& boxes) {
    const Pose T_world_pelvis = motion.pelvis(time_s);
    for (const Side side : {Side::left, Side::right}) {
        const LegPoses leg = leg_poses(side, motion.joints(side, time_s));
        const bool left = side == Side::left;
        boxes.add(left ? left_upper : right_upper,
                  T_world_pelvis * leg.T_body_upper,
                  leg_box(rex::kUpperLeg_m));
        boxes.add(left ? left_lower : right_lower,
                  T_world_pelvis * leg.T_body_lower,
                  leg_box(rex::kLowerLeg_m));
    }
    const Pose T_world_body = motion.at(time_s).T_world_body;
    boxes.add(frame,
              T_world_body,
              trunk_box(0.660, 0.645, rex::kStand_m - kFrameBelowHips_m, kFrameTop_m));
    boxes.add(user, T_world_body, trunk_box(0.40, 0.55, kFrameTop_m, kUserTop_m));
}

}  // namespace

Result<std::vector<TracedPart>> trace_body(const std::vector<RexMovement>& movements,
                                           const RexGaitConfig& gait,
                                           std::uint64_t first_seed,
                                           int seeds) {
    Boxes boxes{RexMovement{}};
    for (int k = 0; k < seeds; ++k) {
        for (const RexMovement& movement : movements) {
            RexPlan plan;
            plan.steps.push_back({0.0, movement, {}, moved({}, movement, 1.0)});
            const auto motion = RexMotion::make(
                plan,
                gait,
                [](double, double) { return 0.0; },
                first_seed + static_cast<std::uint64_t>(k));
            if (!motion) return motion.error();
            boxes.start(movement);
            for (double t = 0.0; t <= motion->duration_s(); t += kEvery_s)
                add_moment(*motion, t, boxes);
        }
    }
    return boxes.all();
}

}  // namespace surefoot::sim
