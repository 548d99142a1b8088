// SPDX-License-Identifier: Apache-2.0
#include "service/live/page_telemetry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "surefoot/core/checked_index.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/eval/maps/shown_part.hpp"
#include "surefoot/geometry/statistics.hpp"
#include "surefoot/io/settings/urdf_file.hpp"

namespace surefoot::app {
namespace {

constexpr double kStairs_hz = 3.0;
constexpr std::size_t kRateFrames = 30;
constexpr std::size_t kMedianFrames = 64;

/// Names of the layers that a page can show. These layers are only copied, not computed for the
/// page.
constexpr std::array kLayerNames{
    "elevation", "variance", "traversability", "slope", "step", "roughness"};
std::array<grid::Layer, kLayerNames.size()> layers_of(const pipeline::Pipeline& pipeline) {
    const auto& map = pipeline.map().layers();
    const auto& rating = pipeline.rating();
    return {pipeline.surface_m(),
            map.height_var_m2.copy(),
            rating.traversability,
            rating.slope,
            rating.step,
            rating.roughness};
}

std::int64_t tenth_mm(double metres) {
    return saturated_integer<std::int64_t>(std::round(1e4 * metres));
}

const char* kind_of(const camera::SourceInfo& info) {
    if (info.kind == "sim") return "simulated";
    return info.steady_stamps ? "live" : "recording";
}

/// Returns true if `due_ns` has passed, and then sets `due_ns` to one period from now.
bool is_due(std::int64_t now_ns, double rate_hz, std::int64_t& due_ns) {
    if (now_ns < due_ns) return false;
    // in range: a page cannot wish for less than PageWish::kSlowest_hz
    due_ns = now_ns + static_cast<std::int64_t>(1e9 / rate_hz);
    return true;
}

double median(const std::deque<double>& values) {
    return upper_median(std::vector<double>(values.begin(), values.end()));
}

/// Returns the part of a map that is shown. A small map is shown completely. Of a large map only
/// the rectangle of blocks of 64 x 64 cells around the known cells is shown. Whole blocks keep the
/// size of the picture stable while cells are added.
eval::ShownPart shown_part(const grid::GridGeometry& geometry, const grid::Layer& height_m) {
    constexpr int kLarge = 512;
    constexpr int kBlock = 64;
    const int nx = geometry.nx;
    const int ny = geometry.ny;
    if (nx <= kLarge && ny <= kLarge) return {geometry, 0, 0};
    int x = nx;
    int y = ny;
    int x_end = 1;
    int y_end = 1;
    for (int iy = 0; iy < ny; ++iy) {
        for (int ix = 0; ix < nx; ++ix) {
            if (std::isnan(height_m.at(ix, iy))) continue;
            x = std::min(x, ix);
            y = std::min(y, iy);
            x_end = std::max(x_end, ix + 1);
            y_end = iy + 1;
        }
    }
    if (x == nx) x = y = 0;  // no known cell: show the first block
    const auto down = [](int first) { return first / kBlock * kBlock; };
    const auto up = [](int end) { return (end + kBlock - 1) / kBlock * kBlock; };
    eval::ShownPart part{geometry, down(x), down(y)};
    part.geometry.nx = std::min(up(x_end), nx) - part.first_ix;
    part.geometry.ny = std::min(up(y_end), ny) - part.first_iy;
    part.geometry.origin_m += geometry.resolution_m * Eigen::Vector2d(part.first_ix, part.first_iy);
    return part;
}

void copy_layers(const pipeline::Pipeline& pipeline,
                 std::uint64_t version,
                 std::vector<page::PageLayer>& out) {
    const grid::GridGeometry& geometry = pipeline.map().geometry();
    auto layers = layers_of(pipeline);
    const eval::ShownPart part = shown_part(geometry, layers.front());
    const bool whole = part.geometry.nx == geometry.nx && part.geometry.ny == geometry.ny;
    std::uint16_t index = 0;
    for (grid::Layer& values : layers) {
        if (values.width() == geometry.nx && values.height() == geometry.ny) {
            out.push_back({version,
                           tenth_mm(part.geometry.origin_m.x()),
                           tenth_mm(part.geometry.origin_m.y()),
                           // in range: ElevationConfig::describe() keeps cells below 10 m
                           static_cast<std::int32_t>(tenth_mm(geometry.resolution_m)),
                           index,
                           whole ? std::move(values) : part.of(values, std::nanf(""))});
        }
        ++index;
    }
}

}  // namespace

std::vector<page::PageHello::GroundPoint> blind_zone_of(const camera::RectifiedRig& rig,
                                                        double sole_depth_m) {
    const Eigen::Vector3d& camera = rig.T_body_camera.translation_m;
    std::vector<page::PageHello::GroundPoint> zone;
    for (const double column_px : {rig.width - 1.0, 0.0}) {
        const Eigen::Vector3d ray =
            rig.T_body_camera.rotation * Eigen::Vector3d((column_px - rig.cx_px) / rig.fx_px,
                                                         (rig.height - 1.0 - rig.cy_px) / rig.fy_px,
                                                         1.0);
        if (ray.z() >= 0.0) return {};
        const Eigen::Vector3d floor = camera - (sole_depth_m + camera.z()) / ray.z() * ray;
        zone.push_back({floor.x(), floor.y()});
    }
    if (!(zone[0].x_m > 0.0 && zone[1].x_m > 0.0)) return {};
    zone.push_back({0.0, zone[1].y_m});
    zone.push_back({0.0, zone[0].y_m});
    return zone;
}

page::PageHello hello_of(const camera::FrameSource& source,
                         const camera::StereoRig& rig,
                         const std::optional<io::MachineFile>& machine,
                         const std::optional<io::MachineModel>& model,
                         std::uint16_t gate_port,
                         double rate_hz) {
    page::PageHello hello;
    hello.program = fmt::format("surefoot {}", SUREFOOT_VERSION);
    hello.source = source.info().path;
    hello.source_kind = kind_of(source.info());
    hello.gate_port = gate_port;
    hello.layers.assign(kLayerNames.begin(), kLayerNames.end());
    hello.rate_hz = rate_hz;
    const auto rectifier = camera::Rectifier::make(rig);
    if (rectifier) hello.T_body_camera = rectifier->rig().T_body_camera;
    if (!machine) return hello;
    hello.machine.emplace();
    hello.machine->name = machine->name;
    hello.machine->limits = machine->machine;
    if (model) {
        hello.machine->urdf = io::urdf_text(*model);
        for (const io::ModelJoint* joint : model->moving_joints())
            hello.machine->joints.push_back({joint->name, joint->stand_rad});
    }
    if (rectifier) {
        hello.blind_zone =
            blind_zone_of(rectifier->rig(), 1e-4 * machine->machine.sole_depth_tenth_mm);
    }
    return hello;
}

void PageTelemetry::fill_status(const FrameReport& report, page::PageStatus& status) {
    status.time_ns = report.time_ns;
    status.frames = static_cast<std::int64_t>(serial_);
    status.state = page::SourceState::running;
    status.health = report.motion.health;
    status.reasons.clear();
    if (report.motion.health != Health::ok)
        status.reasons.emplace_back(to_string(report.motion.reason));
    if (report.camera != CameraState::ok) status.reasons.emplace_back(to_string(report.camera));
    status.text = report.known_cells == 0 ? "the map does not contain ground yet" : source_;
    const double span_s = seconds_from_ns(lately_ns_.back() - lately_ns_.front());
    status.rate_hz = span_s > 0.0 ? static_cast<double>(lately_ns_.size() - 1) / span_s : 0.0;
    status.stages.clear();
    for (std::size_t i = 0; i < kStageCount; ++i) {
        std::deque<double>& last_ms = stages_ms_[i];
        last_ms.push_back(report.stage_ms[i]);
        if (last_ms.size() > kMedianFrames) last_ms.pop_front();
        status.stages.push_back(
            {to_string(static_cast<Stage>(i)), report.stage_ms[i], median(last_ms)});
    }
}

/// Copies images, layers and features if a page wants them, but not more often than pages receive
/// them.
void PageTelemetry::fill_extras(const pipeline::Pipeline& pipeline,
                                const FrameReport& report,
                                std::uint64_t map_version,
                                std::int64_t now_steady_ns,
                                page::PageFrame& frame) {
    frame.images_time_ns = 0;
    if (feed_.wants_images() && is_due(now_steady_ns, feed_.rates.image_hz, images_due_ns_)) {
        frame.images_time_ns = report.time_ns;
        frame.left = pipeline.pair().left;
        frame.disparity_px = pipeline.depth().disparity_px;
    }
    frame.layers.clear();
    if (feed_.wants_layers() && is_due(now_steady_ns, feed_.rates.layer_hz, layers_due_ns_))
        copy_layers(pipeline, map_version, frame.layers);
    frame.has_stairs = feed_.wants_stairs() && is_due(now_steady_ns, kStairs_hz, stairs_due_ns_);
    if (frame.has_stairs) frame.stairs = pipeline.features();
}

void PageTelemetry::tell(const pipeline::Pipeline& pipeline,
                         const FrameReport& report,
                         const grid::MapSnapshot& map,
                         std::int64_t map_time_ns,
                         std::int64_t now_steady_ns) {
    page::PageFrame& frame = feed_.blank();
    frame.serial = ++serial_;
    lately_ns_.push_back(now_steady_ns);
    if (lately_ns_.size() > kRateFrames) lately_ns_.pop_front();
    fill_status(report, status_);
    frame.status = status_;
    frame.has_map = grid::is_sealed(map);
    if (frame.has_map) frame.map = map;
    frame.map_time_ns = map_time_ns;
    drift_.add(report.motion.relative_covariance,
               report.motion.T_odom_body.rotation.toRotationMatrix());
    pose_.time_ns = report.time_ns;
    pose_.T_odom_body = report.motion.T_odom_body;
    pose_.variance_x_m2 = pose_.variance_y_m2 = drift_.horizontal_var_m2;
    pose_.variance_yaw_rad2 = drift_.yaw_var_rad2;
    pose_.health = report.motion.health;
    pose_.camera = report.camera;
    if (joints_at_) joints_at_(report.time_ns, pose_.joints_rad);
    frame.pose = pose_;
    fill_extras(pipeline, report, map.version, now_steady_ns, frame);
    feed_.hand_over();
}

void PageTelemetry::tell_the_end(const pipeline::Pipeline& pipeline) {
    tell_state(page::SourceState::ended, source_ + " has ended", pipeline.features());
}

void PageTelemetry::tell_new_beginning() {
    // The previous features lie in the old odom frame.
    tell_state(page::SourceState::waiting,
               "the map and the position start again; wait for the first frame",
               {});
}

void PageTelemetry::tell_state(page::SourceState state,
                               std::string text,
                               stairs::TerrainFeatures stairs) {
    page::PageFrame& frame = feed_.blank();
    frame.serial = ++serial_;
    frame.status = status_;
    frame.status.state = state;
    frame.status.text = std::move(text);
    frame.pose = pose_;
    frame.has_map = false;
    frame.images_time_ns = 0;
    frame.layers.clear();
    frame.has_stairs = true;
    frame.stairs = std::move(stairs);
    feed_.hand_over();
}

}  // namespace surefoot::app
