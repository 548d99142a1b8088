// SPDX-License-Identifier: Apache-2.0
#include "surefoot/odometry/visual/landmark_map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace surefoot::odometry {
namespace {

/// Step in the image for measuring the local deformation: a little more than the radius of a patch
/// template.
constexpr double kWarpStep_px = 6.0;
constexpr double kMinDepth_m = 0.05;
/// An observation with a larger residual after an adjustment is a mismatch.
constexpr double kGate_sigmas = 5.0;

}  // namespace

LandmarkMap::LandmarkMap(const LandmarkMapConfig& config, const camera::Rectifier& rectifier)
    : config_(config), rectifier_(rectifier) {}

void LandmarkMap::clear() {
    keyframes_.clear();
    landmarks_.clear();
    free_slots_.clear();
}

int LandmarkMap::add_keyframe(const Pose& T_odom_camera) {
    if (keyframes() >= config_.most_keyframes) forget_oldest_keyframe();
    keyframes_.push_back({next_keyframe_++, T_odom_camera});
    return keyframes_.back().id;
}

void LandmarkMap::forget_oldest_keyframe() {
    const int id = keyframes_.front().id;
    keyframes_.erase(keyframes_.begin());
    for (int slot = 0; slot < slots(); ++slot) {
        Landmark& landmark = at(slot);
        if (landmark.id < 0) continue;
        std::erase_if(landmark.sightings, [&](const Sighting& s) { return s.keyframe == id; });
        if (landmark.host == id || landmark.sightings.empty()) remove(slot);
    }
}

std::optional<Eigen::Matrix<double, 3, 2>> LandmarkMap::axes_at(
    const Eigen::Vector2d& raw_px) const {
    const auto& rig = rectifier_.rig();
    const auto ray = [&](const Eigen::Vector2d& raw) -> std::optional<Eigen::Vector3d> {
        const auto px = rectifier_.rectified_from_raw(camera::Side::left, raw);
        if (!px) return std::nullopt;
        return Eigen::Vector3d(
            (px->x() - rig.cx_px) / rig.fx_px, (px->y() - rig.cy_px) / rig.fy_px, 1.0);
    };
    Eigen::Matrix<double, 3, 2> axes;
    for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector2d step = kWarpStep_px * Eigen::Vector2d::Unit(axis);
        const auto ahead = ray(raw_px + step);
        const auto behind = ray(raw_px - step);
        if (!ahead || !behind) return std::nullopt;
        axes.col(axis) = (*ahead - *behind) / (2.0 * kWarpStep_px);
    }
    return axes;
}

std::optional<int> LandmarkMap::add_landmark(ImageView<const std::uint8_t> left,
                                             const Eigen::Vector2d& raw_px,
                                             const StereoPixel& pixel) {
    const auto patch = cut_patch(left, raw_px);
    const auto axes = axes_at(raw_px);
    if (!patch || !axes) return std::nullopt;
    const int slot = add_point(pixel);
    Landmark& landmark = at(slot);
    landmark.patch = *patch;
    landmark.host = newest().id;
    landmark.host_axes = *axes;
    return slot;
}

int LandmarkMap::add_point(const StereoPixel& pixel) {
    int slot = slots();
    if (free_slots_.empty()) {
        landmarks_.emplace_back();
    } else {
        slot = free_slots_.back();
        free_slots_.pop_back();
    }
    const auto& rig = rectifier_.rig();
    const Pose& T_odom_camera = newest().T_odom_camera;
    Landmark& landmark = at(slot);
    landmark.id = next_landmark_++;
    landmark.p_odom_m = T_odom_camera * triangulate(rig, pixel);
    const Eigen::Matrix3d R = T_odom_camera.R();
    landmark.covariance_m2 =
        R * point_covariance(rig, pixel, config_.bundle.sigma_px) * R.transpose();
    landmark.host = -1;
    landmark.sightings.assign(1, {newest().id, pixel, 1.0});
    landmark.failures = 0;
    landmark.agreed = 0;
    return slot;
}

void LandmarkMap::renew_patch(int slot,
                              ImageView<const std::uint8_t> left,
                              const Eigen::Vector2d& raw_px) {
    const auto patch = cut_patch(left, raw_px);
    const auto axes = axes_at(raw_px);
    if (!patch || !axes) return;
    Landmark& landmark = at(slot);
    landmark.patch = *patch;
    landmark.host_axes = *axes;
    landmark.host = newest().id;
    landmark.failures = 0;
}

void LandmarkMap::add_sighting(int slot, const StereoPixel& pixel, double noise_factor) {
    at(slot).sightings.push_back({newest().id, pixel, noise_factor});
}

void LandmarkMap::remove(int slot) {
    at(slot).id = -1;
    at(slot).sightings.clear();
    free_slots_.push_back(slot);
}

const Keyframe* LandmarkMap::find_keyframe(int id) const {
    const int position = id - keyframes_.front().id;
    if (position < 0 || position >= keyframes()) return nullptr;
    return &keyframes_[static_cast<std::size_t>(position)];
}

void LandmarkMap::limit(const std::vector<std::uint8_t>& in_use) {
    std::vector<int> idle;
    int alive = 0;
    for (int slot = 0; slot < slots(); ++slot) {
        if (at(slot).id < 0) continue;
        alive += 1;
        if (in_use[static_cast<std::size_t>(slot)] == 0) idle.push_back(slot);
    }
    const int excess = alive - config_.most_landmarks;
    if (excess <= 0) return;
    // Landmarks with few observations go first, then old ones.
    std::sort(idle.begin(), idle.end(), [&](int a, int b) {
        const auto seen_a = std::min<std::size_t>(at(a).sightings.size(), 3);
        const auto seen_b = std::min<std::size_t>(at(b).sightings.size(), 3);
        return seen_a != seen_b ? seen_a < seen_b : at(a).id < at(b).id;
    });
    for (int i = 0; i < std::min(excess, static_cast<int>(idle.size())); ++i)
        remove(idle[static_cast<std::size_t>(i)]);
}

std::optional<Eigen::Vector2d> LandmarkMap::predict_pixel(const Landmark& landmark,
                                                          camera::Side side,
                                                          const Pose& T_odom_camera) const {
    const Eigen::Vector3d p =
        T_odom_camera.rotation.conjugate() * (landmark.p_odom_m - T_odom_camera.translation_m);
    if (p.z() < kMinDepth_m) return std::nullopt;
    return rectifier_.raw_from_point(side, p);
}

std::optional<PredictedView> LandmarkMap::predict_view(const Landmark& landmark,
                                                       camera::Side side,
                                                       const Pose& T_odom_camera) const {
    const Keyframe* host = find_keyframe(landmark.host);
    if (host == nullptr) return std::nullopt;
    const Eigen::Quaterniond R_camera_odom = T_odom_camera.rotation.conjugate();
    const Eigen::Vector3d p = R_camera_odom * (landmark.p_odom_m - T_odom_camera.translation_m);
    const Eigen::Quaterniond R_host_odom = host->T_odom_camera.rotation.conjugate();
    const double host_depth_m =
        (R_host_odom * (landmark.p_odom_m - host->T_odom_camera.translation_m)).z();
    if (p.z() < kMinDepth_m || host_depth_m < kMinDepth_m) return std::nullopt;
    const auto centre = rectifier_.raw_from_point(side, p);
    if (!centre) return std::nullopt;
    // Approximates the surface by a small plane that faces the host, and projects it into this
    // view.
    Eigen::Matrix2d view_from_host;
    for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Vector3d step =
            R_camera_odom *
            (host->T_odom_camera.rotation *
             Eigen::Vector3d(host_depth_m * kWarpStep_px * landmark.host_axes.col(axis)));
        if (p.z() + step.z() < kMinDepth_m) return std::nullopt;
        const auto moved = rectifier_.raw_from_point(side, p + step);
        if (!moved) return std::nullopt;
        view_from_host.col(axis) = (*moved - *centre) / kWarpStep_px;
    }
    const double det = view_from_host.determinant();
    if (!(det > 0.2 && det < 5.0)) return std::nullopt;  // the views are too different to compare
    return PredictedView{*centre, view_from_host.inverse()};
}

void LandmarkMap::collect_problem(std::vector<int>& slots_used) {
    problem_.clear();
    const int first_free =
        newest().id - config_.window_keyframes + 2;  // the window's oldest keyframe stays fixed
    const int oldest = keyframes_.front().id;
    for (const Keyframe& keyframe : keyframes_) {
        problem_.T_world_camera.push_back(keyframe.T_odom_camera);
        problem_.fixed.push_back(keyframe.id < std::max(first_free, oldest + 1) ? 1 : 0);
    }
    for (int slot = 0; slot < slots(); ++slot) {
        const Landmark& landmark = at(slot);
        if (landmark.id < 0 || landmark.sightings.size() < 2 ||
            landmark.sightings.back().keyframe < first_free)
            continue;
        const int point = static_cast<int>(problem_.p_world_m.size());
        problem_.p_world_m.push_back(landmark.p_odom_m);
        slots_used.push_back(slot);
        for (const Sighting& s : landmark.sightings)
            problem_.sights.push_back({s.keyframe - oldest, point, s.pixel_px, s.noise_factor});
    }
}

void LandmarkMap::adjust() {
    if (keyframes() < 2) return;
    std::vector<int> slots_used;
    collect_problem(slots_used);
    if (slots_used.empty()) return;
    apply(adjust_bundle(rectifier_.rig(), config_.bundle, problem_), slots_used);
}

void LandmarkMap::apply(const BundleResult& result, const std::vector<int>& slots_used) {
    for (std::size_t i = 0; i < keyframes_.size(); ++i)
        keyframes_[i].T_odom_camera = problem_.T_world_camera[i];
    std::size_t sight = 0;
    for (std::size_t i = 0; i < slots_used.size(); ++i) {
        Landmark& landmark = at(slots_used[i]);
        landmark.p_odom_m = problem_.p_world_m[i];
        const Eigen::Matrix3d covariance = result.information[i].inverse();
        if (covariance.allFinite()) landmark.covariance_m2 = covariance;
        std::size_t kept = 0;
        for (const Sighting& s : std::vector<Sighting>(landmark.sightings))
            if (result.residual_sigmas[sight++] <= kGate_sigmas) landmark.sightings[kept++] = s;
        landmark.sightings.resize(kept);
        if (kept == 0) remove(slots_used[i]);
    }
}

}  // namespace surefoot::odometry
