// SPDX-License-Identifier: Apache-2.0
#include "surefoot/elevation/sampling/depth_samples.hpp"

#include <algorithm>
#include <limits>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/unknown.hpp"

namespace surefoot::elevation {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

DepthFrame frame_of(const ElevationConfig& config,
                    const camera::RectifiedRig& rig,
                    const Pose& T_odom_body,
                    const grid::GridGeometry& geometry) {
    const Pose T_odom_camera = T_odom_body * rig.T_body_camera;
    const Eigen::Vector3d camera_m = T_odom_camera.translation_m;
    const PrefilterConfig& cut = config.prefilter;
    const double body_z_m = T_odom_body.translation_m.z();
    DepthFrame f;
    f.cx_px = static_cast<float>(rig.cx_px);
    f.per_fx = static_cast<float>(1.0 / rig.fx_px);
    f.depth_to_disparity_px_m = static_cast<float>(rig.depth_to_disparity_px_m());
    f.per_focal_px = f.per_fx;
    f.lateral_px = static_cast<float>(config.sensor.matcher_lateral_px);
    f.min_var_m2 = static_cast<float>(config.sensor.min_var_m2);
    f.tilt_var = static_cast<float>(config.camera_tilt_sigma_rad * config.camera_tilt_sigma_rad);
    f.camera_m[0] = static_cast<float>(camera_m.x() - geometry.origin_m.x());
    f.camera_m[1] = static_cast<float>(camera_m.y() - geometry.origin_m.y());
    f.camera_m[2] = static_cast<float>(camera_m.z());
    f.min_range_m = static_cast<float>(cut.range ? cut.min_range_m : -kInfinity);
    f.max_range_m = static_cast<float>(cut.range ? cut.max_range_m : kInfinity);
    f.max_z_m = static_cast<float>(cut.height ? body_z_m + cut.max_height_m : kInfinity);
    f.max_outlier_probability = static_cast<float>(config.pixels.max_outlier_probability);
    f.surface_check = config.pixels.surface_check;
    f.surface =
        SurfaceCheck(config.pixels, rig.fx_px, rig.fy_px, T_odom_camera.R().row(2).transpose())
            .limits();
    f.per_cell_m = static_cast<float>(1.0 / geometry.resolution_m);
    f.nx = geometry.nx;
    f.ny = geometry.ny;
    return f;
}

void copy(const Eigen::Vector3d& from, float to[3]) {
    for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(from[i]);
}

}  // namespace

bool DepthSampler::can(const ElevationConfig& config) noexcept {
    return config.sensor.model == SensorModel::matcher && !config.prefilter.down_sampling &&
           !config.prefilter.outlier_removal;
}

void DepthSampler::sample(const ElevationConfig& config,
                          const camera::RectifiedRig& rig,
                          const Pose& T_odom_body,
                          const DepthImage& depth,
                          const grid::GridGeometry& geometry,
                          Executor& executor,
                          CellSamples& samples,
                          FusionCounts& counts) {
    const int width = depth.disparity_px.width();
    const int height = depth.disparity_px.height();
    frame_ = frame_of(config, rig, T_odom_body, geometry);
    reach_px_ = config.pixels.reach_px;
    fy_px_ = rig.fy_px;
    cy_px_ = rig.cy_px;
    R_odom_camera_ = (T_odom_body * rig.T_body_camera).R();
    const int blocks = (height + kBlockRows - 1) / kBlockRows;
    const auto columns = static_cast<std::size_t>(width);
    const std::size_t padded = columns + 2 * static_cast<std::size_t>(reach_px_);
    samples.reset(blocks, columns * kBlockRows);
    nothing_px_.assign(columns, kNanF);
    padded_px_.assign(padded * static_cast<std::size_t>(blocks), kNanF);
    counts_.assign(static_cast<std::size_t>(blocks), {});

    struct Job {
        DepthSampler& sampler;
        const DepthImage& depth;
        CellSamples& samples;
    } job{*this, depth, samples};
    // The closure holds one reference only, so std::function allocates no memory.
    executor.parallel_for(
        blocks, [&job](int block) { job.sampler.sample_block(block, job.depth, job.samples); });
    for (const RowCounts& block : counts_) {
        counts.points += block.points;
        counts.gated_confidence += block.gated_confidence;
        counts.gated_range += block.gated_range;
        counts.gated_height += block.gated_height;
        counts.outside += block.outside;
    }
}

void DepthSampler::sample_block(int block, const DepthImage& depth, CellSamples& samples) {
    const int first = block * kBlockRows;
    const int last = std::min(first + kBlockRows, depth.disparity_px.height());
    const std::size_t padded = padded_px_.size() / counts_.size();
    RowCounts& sum = counts_[static_cast<std::size_t>(block)];
    for (int v = first; v < last; ++v) {
        float* around_px = padded_px_.data() + padded * static_cast<std::size_t>(block);
        CellSamples::Columns out = samples.columns(block);
        out.cell += sum.samples;
        out.z_m += sum.samples;
        out.var_m2 += sum.samples;
        const RowCounts row = samples_of_row(frame_, row_at(v, depth, around_px), out);
        sum.points += row.points;
        sum.gated_confidence += row.gated_confidence;
        sum.gated_range += row.gated_range;
        sum.gated_height += row.gated_height;
        sum.outside += row.outside;
        sum.samples += row.samples;
    }
    samples.set_count(block, sum.samples);
}

DepthRow DepthSampler::row_at(int v, const DepthImage& depth, float* padded) const {
    const Image<float>& disparity_px = depth.disparity_px;
    const int width = disparity_px.width();
    std::copy_n(disparity_px.row(v), width, padded + reach_px_);
    const auto other = [&](int row) {
        return row >= 0 && row < disparity_px.height() ? disparity_px.row(row) : nothing_px_.data();
    };
    DepthRow row;
    row.disparity_px = padded + reach_px_;
    row.sigma_px = depth.sigma_px.row(v);
    row.outlier_probability = depth.outlier_probability.row(v);
    row.before_px = padded;
    row.after_px = padded + 2 * reach_px_;
    row.above_px = other(v - reach_px_);
    row.below_px = other(v + reach_px_);
    row.width = width;
    const double y = (v - cy_px_) / fy_px_;
    row.ray_y = static_cast<float>(y);
    copy(R_odom_camera_.col(1) * y + R_odom_camera_.col(2), row.start);
    copy(R_odom_camera_.col(0), row.along);
    return row;
}

}  // namespace surefoot::elevation
