// SPDX-License-Identifier: Apache-2.0
#include "studies/runs/sim_truth.hpp"

#include <cmath>

#include "studies/runs/run_output.hpp"
#include "studies/runs/run_session.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/nearest_pixel.hpp"
#include "surefoot/sim/scenes/truth.hpp"
#include "surefoot/traversability/traversability.hpp"

namespace surefoot::app {
namespace {

constexpr double kErrorBin_px = 0.01;
constexpr double kVisibleRange_m = 2.5;

double median_of(const std::vector<std::int64_t>& histogram, std::int64_t total) {
    std::int64_t below = 0;
    for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
        below += histogram[bin];
        if (2 * below >= total) return (static_cast<double>(bin) + 0.5) * kErrorBin_px;
    }
    return static_cast<double>(histogram.size()) * kErrorBin_px;
}

double share(std::int64_t part, std::int64_t whole) {
    return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole) : std::nan("");
}

sim::Lattice lattice_of(const grid::GridGeometry& geometry) {
    return {geometry.origin_m, geometry.nx, geometry.ny, geometry.resolution_m};
}

/// Returns the rectified left camera along the run.
eval::CameraTrack camera_track(const pipeline::Pipeline& pipeline, const Trajectory& bodies) {
    const camera::RectifiedRig& rig = pipeline.rig();
    eval::CameraTrack track;
    track.view = {rig.width, rig.height, rig.fx_px, rig.fy_px, rig.cx_px, rig.cy_px};
    track.max_depth_m = pipeline.config().elevation.prefilter.max_range_m;
    for (const StampedPose& pose : bodies)
        track.T_world_camera.push_back({pose.time_ns, pose.T_world_body * rig.T_body_camera});
    return track;
}

/// Removes the poses before `first_ns`, the time of the first processed frame. Returns false if the
/// body moved before this time: odom then does not start at the origin of the world, and a
/// comparison without alignment is impossible.
bool starts_at(std::vector<StampedPose>& trajectory, std::int64_t first_ns) {
    const Pose T_world_first = trajectory.front().T_world_body;
    std::erase_if(trajectory, [&](const StampedPose& pose) { return pose.time_ns < first_ns; });
    if (trajectory.empty()) return false;
    const Pose moved = T_world_first.inverse() * trajectory.front().T_world_body;
    constexpr double kMoved_m = 1e-3;
    constexpr double kTurned_rad = 1e-3;
    return moved.translation_m.norm() <= kMoved_m &&
           2.0 * moved.rotation.vec().norm() <= kTurned_rad;
}

void lift(grid::Layer& height_m, double by_m) {
    for (std::size_t i = 0; i < height_m.size(); ++i)
        height_m.data()[i] += static_cast<float>(by_m);
}

/// Rates true heights with the filters and settings of the live map.
grid::Layer rated(const pipeline::Pipeline& pipeline, const grid::Layer& height_m) {
    Serial serial;
    traversability::TraversabilityLayers layers;
    const double resolution_m = pipeline.map().geometry().resolution_m;
    traversability::rate(pipeline.config().traversability.widened_to(resolution_m),
                         height_m.view(),
                         resolution_m,
                         serial,
                         layers);
    return layers.traversability;
}

}  // namespace

Image<float> depth_seen_by(const camera::RectifiedRig& rig,
                           const camera::StereoRig& raw_rig,
                           const Image<float>& raw_m) {
    const auto* lens = std::get_if<camera::PinholeRadTan>(&raw_rig.left.model);
    if (lens == nullptr || raw_m.empty()) return {};
    const Eigen::Matrix3d R_raw_rectified =
        (raw_rig.body_from_left().inverse() * rig.T_body_camera).R();
    Image<float> seen_m(rig.width, rig.height, std::nanf(""));
    for (int v = 0; v < rig.height; ++v) {
        for (int u = 0; u < rig.width; ++u) {
            const Eigen::Vector3d ray =
                R_raw_rectified *
                Eigen::Vector3d((u - rig.cx_px) / rig.fx_px, (v - rig.cy_px) / rig.fy_px, 1.0);
            const auto raw = nearest_pixel(lens->fx_px * ray.x() / ray.z() + lens->cx_px,
                                           lens->fy_px * ray.y() / ray.z() + lens->cy_px,
                                           raw_m.width(),
                                           raw_m.height());
            if (!raw) continue;
            const float z_m = raw_m.at(raw->u, raw->v);
            seen_m.at(u, v) = z_m / static_cast<float>(ray.z());
        }
    }
    return seen_m;
}

double odom_height_m(const pipeline::Pipeline& pipeline,
                     const sim::SceneTruth& truth,
                     const std::vector<FrameReport>& frames) {
    if (pipeline.alignment().has_ground) return 0.0;
    return truth.trajectory.front().T_world_body.translation_m.z() -
           frames.front().motion.T_odom_body.translation_m.z();
}

SimTruth::SimTruth(camera::FrameSource& source)
    : scene_(dynamic_cast<const sim::SceneSource*>(&source)) {}

void SimTruth::remember_depth(const StereoFrame& frame) {
    if (scene_ != nullptr && scene_->rig().rectified)
        depths_.emplace_back(frame.index, scene_->last_depth_m());
}

void SimTruth::compare_depth(const StereoFrame& frame, const pipeline::Pipeline& pipeline) {
    while (!depths_.empty() && depths_.front().first < frame.index) depths_.pop_front();
    if (depths_.empty() || depths_.front().first != frame.index) return;
    const Image<float> truth_m =
        depth_seen_by(pipeline.rig(), scene_->rig(), depths_.front().second);
    if (truth_m.empty()) return;
    const DepthImage& depth = pipeline.depth();
    const double fb_px_m = pipeline.rig().depth_to_disparity_px_m();
    for (std::size_t i = 0; i < truth_m.size(); ++i) {
        const double disparity_px = static_cast<double>(depth.disparity_px.data()[i]);
        const double true_z_m = static_cast<double>(truth_m.data()[i]);
        if (!(disparity_px > 0.0) || !(true_z_m > 0.0)) continue;
        if (depth.outlier_probability.data()[i] > kTrustedOutlierProbability) {
            ++outliers_;
            continue;
        }
        const double error_px = std::abs(disparity_px - fb_px_m / true_z_m);
        const double sigma_px = static_cast<double>(depth.sigma_px.data()[i]);
        ++compared_;
        within_3_sigma_ += error_px <= 3.0 * sigma_px ? 1 : 0;
        within_1_sigma_ += error_px <= sigma_px ? 1 : 0;
        const auto bin = saturated_integer<std::size_t>(error_px / kErrorBin_px);
        ++error_histogram_[std::min(bin, error_histogram_.size() - 1)];
        const double z_m = fb_px_m / disparity_px;
        const double sigma_z_m = z_m * sigma_px / disparity_px;
        RangeMean* range = std::abs(z_m - 1.0) <= 0.05  ? &near_
                           : std::abs(z_m - 2.0) <= 0.1 ? &far_
                                                        : nullptr;
        if (range != nullptr) {
            range->sum_m += sigma_z_m;
            ++range->count;
        }
    }
}

std::optional<TruthFigures> SimTruth::figures(const pipeline::Pipeline& pipeline,
                                              const std::vector<FrameReport>& frames,
                                              const eval::EvalMapsConfig& config) const {
    if (scene_ == nullptr || frames.empty()) return std::nullopt;
    sim::SceneTruth truth = scene_->truth();
    if (!starts_at(truth.trajectory, frames.front().time_ns)) return std::nullopt;
    truth.trajectory.resize(std::min(truth.trajectory.size(), frames.size()));
    TruthFigures figures;
    const grid::GridGeometry& geometry = pipeline.map().geometry();
    const grid::Layer live_m = pipeline.surface_m();
    const sim::Lattice lattice = lattice_of(geometry);

    eval::MapPair maps;
    maps.geometry = geometry;
    maps.live_m = live_m;
    maps.live_var_m2 = pipeline.map().layers().height_var_m2.copy();
    maps.tilt_sigma_rad = pipeline.alignment().tilt_sigma_rad;
    maps.live_traversability = or_unknown(pipeline.rating().traversability, geometry);
    maps.truth_m = sim::dem(truth.scene, lattice);
    const double odom_z_m = odom_height_m(pipeline, truth, frames);
    grid::Layer live_world_m = live_m;
    lift(live_world_m, odom_z_m);
    maps.compared_m = sim::dem_below_overhead(maps.truth_m,
                                              truth.scene,
                                              lattice,
                                              live_world_m.view(),
                                              pipeline.map().layers().clearance_m.view());
    for (grid::Layer* true_m : {&maps.truth_m, &maps.compared_m}) lift(*true_m, -odom_z_m);
    maps.truth_traversability = rated(pipeline, maps.truth_m);
    maps.trajectory = trajectory_of(frames);
    maps.camera = camera_track(pipeline, maps.trajectory);
    figures.maps = eval::compare_maps(maps, config);
    Serial serial;
    const auto visible = sim::visibility_mask(truth, lattice, {.range_m = kVisibleRange_m}, serial);
    figures.coverage_within_2_5_m = eval::coverage(live_m, maps.truth_m, visible);
    figures.traversability = eval::traversability_errors(figures.maps.calls, visible);

    for (StampedPose pose : truth.trajectory) {
        pose.T_world_body.translation_m.z() -= odom_z_m;
        figures.truth_trajectory.push_back(pose);
    }
    if (const auto errors = eval::evaluate_trajectory(
            maps.trajectory, figures.truth_trajectory, {.align = eval::Alignment::none})) {
        figures.trajectory = *errors;
    }

    figures.depth.pixels = compared_;
    figures.depth.within_3_sigma = share(within_3_sigma_, compared_);
    figures.depth.within_1_sigma = share(within_1_sigma_, compared_);
    figures.depth.median_abs_error_px = median_of(error_histogram_, compared_);
    figures.depth.sigma_at_1_m_m = near_.sum_m / static_cast<double>(near_.count);
    figures.depth.sigma_at_2_m_m = far_.sum_m / static_cast<double>(far_.count);
    figures.depth.outlier_share = share(outliers_, outliers_ + compared_);
    return figures;
}

}  // namespace surefoot::app
