// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/visibility/viewpoint_history.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace surefoot::elevation {
namespace {

constexpr std::size_t kCapacity = 1024;
/// A pose closer to the newest entry than this share of the limits adds no entry.
constexpr double kSharedEntry = 0.25;

double angle_rad(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
    return 2.0 * std::acos(std::min(1.0, std::abs(a.dot(b))));
}

}  // namespace

void ViewpointConfig::describe(ConfigVisitor& visitor) {
    visitor.number(
        "min_translation_m",
        min_translation_m,
        0.0,
        10.0,
        "smallest translation of base_link between two independent views of a cell. A view with "
        "less translation and less rotation is not averaged with the earlier view");
    visitor.number(
        "min_rotation_deg",
        min_rotation_deg,
        0.0,
        180.0,
        "smallest rotation of base_link between two independent views of a cell. A view with less "
        "translation and less rotation is not averaged with the earlier view");
}

ViewpointHistory::ViewpointHistory(const ViewpointConfig& config)
    : config_(config), poses_(kCapacity), is_near_(kCapacity, 0) {}

bool ViewpointHistory::apart(const Pose& a, const Pose& b, double share) const {
    const double way_m = (a.translation_m - b.translation_m).norm();
    return way_m >= share * config_.min_translation_m ||
           angle_rad(a.rotation, b.rotation) >=
               share * config_.min_rotation_deg * std::numbers::pi / 180.0;
}

ViewpointHistory::Id ViewpointHistory::look_from(const Pose& T_odom_body) {
    if (newest_ == kNever || apart(poses_[newest_ % kCapacity], T_odom_body, kSharedEntry)) {
        ++newest_;
        poses_[newest_ % kCapacity] = T_odom_body;
    }
    const Id oldest = newest_ >= kCapacity ? newest_ - static_cast<Id>(kCapacity) + 1 : 1;
    for (Id id = oldest; id <= newest_; ++id) {
        is_near_[id % kCapacity] = apart(poses_[id % kCapacity], T_odom_body, 1.0) ? 0 : 1;
    }
    return newest_;
}

bool ViewpointHistory::is_new_since(Id id) const {
    if (id == kNever || newest_ - id >= kCapacity) return true;
    return is_near_[id % kCapacity] == 0;
}

}  // namespace surefoot::elevation
