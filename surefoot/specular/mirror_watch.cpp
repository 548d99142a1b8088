// SPDX-License-Identifier: Apache-2.0
#include "surefoot/specular/mirror_watch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "surefoot/core/angles.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/specular/suspicion.hpp"

namespace surefoot::specular {
namespace {

constexpr double kAhead_m = 0.8;      ///< distance from the body to the middle of the patches
constexpr int kAheadDirections = 41;  ///< directions within 20 deg of the heading
/// Step between the directions of two turns. Every direction gets one of 180 turns, and
/// neighbouring directions are far apart in time.
constexpr unsigned kStride = 67;
/// A larger height step means another floor: the picture restarts.
constexpr double kFloorStep_m = 0.015;
constexpr double kFloorShare = 0.1;  ///< weight of one frame in the mean height of the floor
constexpr double kSameAngle_rad = 2.0 * kRadPerDeg;
constexpr double kSameOffset_m = 0.06;
constexpr double kFarthest_m = 4.0;     ///< a pane farther from the body is removed
constexpr double kFarthestNew_m = 2.0;  ///< a new pane farther ahead is not accepted yet
constexpr double kNearestNew_m = 0.2;   ///< the body occupies the space up to this distance
constexpr int kTurns = 2;
constexpr double kWorthTurning = 4.0;  ///< smallest score that justifies a turned search
constexpr double kStraight_rad = 0.1 * kRadPerDeg;
constexpr double kWayStep_m = 0.1;
constexpr std::size_t kMostWay = 64;
constexpr double kWayMargin_m = 0.3;
/// Growth of the hidden strip to each side, per metre behind the pane.
constexpr double kWiden = 0.5;

int wrapped(int direction) {
    const int rest = direction % MirrorWatch::kDirections;
    return rest < 0 ? rest + MirrorWatch::kDirections : rest;
}

bool is_same(const SuspectedPane& a, const SuspectedPane& b) {
    const double cosine = a.normal.dot(b.normal);
    if (cosine < std::cos(kSameAngle_rad)) return false;
    const Eigen::Vector2d middle_m = b.offset_m * b.normal + 0.5 * (b.from_m + b.to_m) * b.left();
    return std::abs(a.normal.dot(middle_m) - a.offset_m) < kSameOffset_m;
}

}  // namespace

MirrorWatch::MirrorWatch(const SpecularConfig& config) : config_(config), picture_(config) {
    panes_.reserve(kMostPanes);
    way_m_.reserve(kMostWay);
}

void MirrorWatch::forget() {
    picture_.clear();
    panes_.clear();
    way_m_.clear();
    floor_z_m_.reset();
}

void MirrorWatch::remember_way() {
    if (!way_m_.empty() && (way_m_.back() - body_m_).norm() < kWayStep_m) return;
    if (way_m_.size() == kMostWay) way_m_.erase(way_m_.begin());
    way_m_.push_back(body_m_);
}

bool MirrorWatch::is_impossible(const SuspectedPane& pane) const {
    const double ahead_m = pane.offset_m - pane.normal.dot(body_m_);
    if (ahead_m > kFarthestNew_m || ahead_m < kNearestNew_m) return true;
    return std::any_of(way_m_.begin(), way_m_.end(), [&](const Eigen::Vector2d& at_m) {
        const double side_m = pane.left().dot(at_m);
        return pane.normal.dot(at_m) > pane.offset_m - kNearestNew_m &&
               side_m > pane.from_m - kWayMargin_m && side_m < pane.to_m + kWayMargin_m;
    });
}

void MirrorWatch::follow_floor(double floor_z_m) {
    floor_z_m_ = floor_z_m_ ? *floor_z_m_ + kFloorShare * (floor_z_m - *floor_z_m_) : floor_z_m;
    if (std::abs(*floor_z_m_ - picture_z_m_) <= kFloorStep_m) return;
    floor_z_m_ = floor_z_m;
    picture_z_m_ = floor_z_m;
    picture_.clear();
}

void MirrorWatch::add(const camera::RectifiedRig& rig,
                      const Pose& T_odom_body,
                      ImageView<const std::uint8_t> left,
                      ImageView<const float> disparity_px,
                      std::optional<double> floor_z_m) {
    if (!config_.enabled || !T_odom_body.all_finite()) return;
    picture_.follow(T_odom_body);
    body_m_ = T_odom_body.translation_m.head<2>();
    remember_way();
    heading_rad_ = yaw_rad(T_odom_body);
    middle_m_ =
        body_m_ + kAhead_m * Eigen::Vector2d(std::cos(heading_rad_), std::sin(heading_rad_));
    std::erase_if(panes_, [&](const SuspectedPane& pane) {
        return std::abs(pane.normal.dot(body_m_) - pane.offset_m) > kFarthest_m;
    });
    if (!floor_z_m) return;
    follow_floor(*floor_z_m);
    picture_.add(rig, T_odom_body, left, disparity_px, picture_z_m_);
    ++frame_;
    if (!panes_.empty()) look_again(panes_[frame_ % panes_.size()]);
    for (int slot = 0; slot < 2 * config_.directions_per_frame; ++slot) look(next_direction(slot));
    std::erase_if(panes_, [&](const SuspectedPane& pane) {
        return pane.low_observations >= config_.forget_observations;
    });
}

/// Even slots search ahead: 0, 1, -1, 2, -2 ... deg from the heading. Odd slots search all around.
int MirrorWatch::next_direction(int slot) {
    if (slot % 2 == 1)
        return wrapped(static_cast<int>(kStride * other_turn_++ % unsigned{kDirections}));
    const int turn = static_cast<int>(ahead_turn_++ % unsigned{kAheadDirections});
    const int beside = turn % 2 == 1 ? (turn + 1) / 2 : -turn / 2;
    const int heading_deg = saturated_integer<int>(std::round(heading_rad_ / kRadPerDeg));
    return wrapped(heading_deg + beside);
}

SuspectedPane MirrorWatch::pane_of(const PatchLine& line, double angle_rad) const {
    const double cell_m = config_.cell_m;
    const Eigen::Vector2d across(std::cos(angle_rad), std::sin(angle_rad));
    const double lean_rad = angle_rad + line.lean_rad;
    SuspectedPane pane;
    pane.normal = {std::cos(lean_rad), std::sin(lean_rad)};
    const Eigen::Vector2d on_m =
        middle_m_ + cell_m * (line.at - 0.5 * (MirrorPatch::kLines - 1)) * across;
    pane.offset_m = pane.normal.dot(on_m);
    const double side_m = pane.left().dot(middle_m_);
    const double first = line.first_cell - 0.5 * MirrorPatch::kLineCells;
    const double last = line.last_cell + 1 - 0.5 * MirrorPatch::kLineCells;
    pane.from_m = side_m + cell_m * first;
    pane.to_m = side_m + cell_m * last;
    if (pane.normal.dot(body_m_) > pane.offset_m) {
        pane.normal = -pane.normal;
        pane.offset_m = -pane.offset_m;
        std::swap(pane.from_m, pane.to_m);
        pane.from_m = -pane.from_m;
        pane.to_m = -pane.to_m;
    }
    pane.score = line.score;
    pane.correlation = line.correlation;
    return pane;
}

void MirrorWatch::look(int direction) {
    double angle_rad = direction * kRadPerDeg;
    patch_.sample(picture_.geometry(), picture_.brightness(), middle_m_, angle_rad);
    auto line = scan_.find(patch_);
    // A line that is oblique in its patch is sharper in a patch that is turned to the direction of
    // the line.
    for (int turn = 0; turn < kTurns && line; ++turn) {
        const bool is_worth_it =
            line->score >= kWorthTurning || line->correlation >= config_.mirror_correlation;
        if (!is_worth_it || std::abs(line->lean_rad) < kStraight_rad) break;
        const SuspectedPane pane = pane_of(*line, angle_rad);
        const double turned_rad = angle_rad + line->lean_rad;
        patch_.sample(picture_.geometry(), picture_.brightness(), middle_m_, turned_rad);
        const auto turned = scan_.find(patch_, place_of(pane, turned_rad));
        if (!turned || turned->score <= line->score) break;
        line = turned;
        angle_rad = turned_rad;
    }
    if (!line || !is_suspect(*line, config_)) return;
    const SuspectedPane pane = pane_of(*line, angle_rad);
    if (!is_impossible(pane)) suspect(pane);
}

/// Returns the line number, with its fraction, at which the pane crosses the middle of a patch with
/// this angle.
double MirrorWatch::place_of(const SuspectedPane& pane, double angle_rad) const {
    const Eigen::Vector2d across(std::cos(angle_rad), std::sin(angle_rad));
    const double away_m = (pane.offset_m - pane.normal.dot(middle_m_)) / pane.normal.dot(across);
    return away_m / config_.cell_m + 0.5 * (MirrorPatch::kLines - 1);
}

void MirrorWatch::look_again(SuspectedPane& pane) {
    const double angle_rad = std::atan2(pane.normal.y(), pane.normal.x());
    const double at = place_of(pane, angle_rad);
    if (!(at > 0.0 && at < MirrorPatch::kLines)) return;
    patch_.sample(picture_.geometry(), picture_.brightness(), middle_m_, angle_rad);
    const auto line = scan_.find(patch_, at);
    if (!line) return;
    pane.score = line->score;
    pane.correlation = line->correlation;
    pane.low_observations = line->score < config_.keep_score ? pane.low_observations + 1 : 0;
}

void MirrorWatch::suspect(const SuspectedPane& found) {
    for (SuspectedPane& pane : panes_) {
        if (!is_same(pane, found)) continue;
        const double from_m = std::min(pane.from_m, found.from_m);
        const double to_m = std::max(pane.to_m, found.to_m);
        if (found.score > pane.score) pane = found;
        pane.from_m = from_m;
        pane.to_m = to_m;
        pane.low_observations = 0;
        return;
    }
    if (panes_.size() < kMostPanes) panes_.push_back(found);
}

std::optional<double> level_floor_z_m(const GroundObservation& ground_body,
                                      const Pose& T_odom_body) {
    constexpr double kLeastUp = 0.99966;  // cosine of 1.5 deg
    const Eigen::Vector3d normal = T_odom_body.rotation * ground_body.normal;
    if (!ground_body.accepted || !(normal.z() >= kLeastUp)) return std::nullopt;
    const double yaw = yaw_rad(T_odom_body);
    const Eigen::Vector2d ahead_m = kAhead_m * Eigen::Vector2d(std::cos(yaw), std::sin(yaw));
    const double below_m = (ground_body.height_m + normal.head<2>().dot(ahead_m)) / normal.z();
    return T_odom_body.translation_m.z() - below_m;
}

void hide_behind(std::span<const SuspectedPane> panes,
                 const SpecularConfig& config,
                 const grid::GridGeometry& geometry,
                 ImageView<std::uint8_t> hidden) {
    // A cell is hidden if any part of it is hidden, so half of its diagonal is added.
    const double reach_m = std::numbers::sqrt2 / 2.0 * geometry.resolution_m;
    for (const SuspectedPane& pane : panes) {
        const Eigen::Vector2d left = pane.left();
        for (int iy = 0; iy < geometry.ny; ++iy) {
            for (int ix = 0; ix < geometry.nx; ++ix) {
                const Eigen::Vector2d at_m = geometry.center_m({ix, iy});
                const double behind_m =
                    pane.normal.dot(at_m) - pane.offset_m + config.margin_m + reach_m;
                if (behind_m < 0.0) continue;
                const double beside_m = config.side_margin_m + reach_m + kWiden * behind_m;
                const double side_m = left.dot(at_m);
                if (side_m >= pane.from_m - beside_m && side_m <= pane.to_m + beside_m)
                    hidden.row(iy)[ix] = 1;
            }
        }
    }
}

}  // namespace surefoot::specular
