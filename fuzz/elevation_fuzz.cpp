// SPDX-License-Identifier: Apache-2.0
// After any sequence of motions, clouds, depth images and remembered regions, the elevation map
// equals the reference implementation (plain_map.hpp) bit for bit in every layer and count. A
// second map that processes its blocks backwards on another instruction set has the same bytes.
// Every known cell has a finite height and a positive variance; no cell is partly known. With
// height alignment, which the reference implementation lacks, only the two maps are compared. The
// last byte of an input configures the visibility clean-up.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <vector>

#include "fuzz/choices.hpp"
#include "fuzz/must.hpp"
#include "fuzz/plain_map.hpp"
#include "fuzz/twin.hpp"
#include "surefoot/core/unknown.hpp"

namespace {

using namespace surefoot;
using namespace surefoot::elevation;
using fuzz::Choices;
using fuzz::OnTarget;
using fuzz::PlainMap;

constexpr int kMostOperations = 16;

template <typename T>
bool same_cells(const grid::SlidingLayer<T>& a, const Image<T>& b) {
    // Fast path for equal bytes. The loop below accepts different bit patterns of NaN.
    if (std::memcmp(a.data(), b.data(), b.size() * sizeof(T)) == 0) return true;
    for (std::size_t i = 0; i < b.size(); ++i) {
        const bool both_unknown = a.data()[i] != a.data()[i] && b.data()[i] != b.data()[i];
        if (!both_unknown && std::memcmp(a.data() + i, b.data() + i, sizeof(T)) != 0) return false;
    }
    return true;
}

bool same(const FusionCounts& a, const FusionCounts& b) {
    return a.points == b.points && a.gated_range == b.gated_range &&
           a.gated_height == b.gated_height && a.gated_confidence == b.gated_confidence &&
           a.gated_density == b.gated_density && a.gated_border == b.gated_border &&
           a.outside == b.outside && a.cells_measured == b.cells_measured &&
           a.cells_new == b.cells_new && a.cells_fused == b.cells_fused &&
           a.cells_inflated == b.cells_inflated && a.cells_cleared == b.cells_cleared;
}

ElevationConfig config_of(Choices& choices) {
    ElevationConfig config;
    config.resolution_m = choices.yes() ? 0.05 : 0.025;
    constexpr int kSides[] = {1, 2, 15, 16, 17, 24};
    config.length_m = kSides[choices.below(6)] * config.resolution_m;
    config.prefilter.range = choices.below(4) != 0;
    config.prefilter.height = choices.below(4) != 0;
    config.prefilter.down_sampling = choices.below(8) == 1;
    config.prefilter.outlier_removal = choices.below(8) == 1;
    config.reduction.min_points = 1 + choices.below(3);
    config.fusion.scan_duration_s = choices.below(4) == 1 ? 0.5 : 0.0;
    config.sensor.model = static_cast<SensorModel>(choices.below(8) == 1 ? choices.below(7) : 0);
    config.pixels.surface_check = choices.yes();
    if (choices.below(4) == 1) {
        HeightDriftConfig& drift = config.height_drift;
        drift.enabled = true;
        drift.min_motions = 1 + choices.below(3);
        drift.min_drift_m = 0.001 * choices.below(4);
        drift.kept_motions = choices.below(8);
        drift.min_cells = 1 + choices.below(30);
        drift.min_tiles = 4;
        drift.min_spread_m = 0.0;
        drift.agreeing_share = 0.5;
        drift.significance_sigmas = 0.1;
        drift.motion_sigmas = 1e6;
    }
    return config;
}

/// Decodes the last input byte into the settings of the visibility clean-up; 0 = no clean-up.
void set_sight(std::uint8_t byte, ElevationConfig& config) {
    config.visibility.cleanup = (byte & 1U) != 0U;
    config.visibility.drops = (byte & 2U) == 0U;
    if ((byte & 4U) != 0U) config.visibility.frames = 1;
    if ((byte & 8U) != 0U) config.visibility.neighbour_s = 0.0;
    if ((byte & 16U) != 0U) config.visibility.margin_m = 0.01;
    if ((byte & 32U) != 0U) config.visibility.sigmas = 0.5;
    if ((byte & 64U) != 0U) config.min_overhead_m = 0.05;
    if ((byte & 128U) != 0U) config.prefilter.min_height_m = -1.0;
}

class Play {
  public:
    Play(const ElevationConfig& config, Choices& choices)
        : choices_(choices),
          target_(choices.byte()),
          config_(config),
          map_(config),
          twin_(config),
          plain_(config) {}

    void one_operation() {
        switch (choices_.below(8)) {
            case 0:
            case 1: follow(); break;
            case 2: depth_image(); break;
            case 3: region(); break;
            case 4: clear(); break;
            case 7: config_.visibility.cleanup ? floor() : cloud(); break;
            default: cloud(); break;
        }
        compare();
    }

  private:
    Pose small_pose() {
        return {
            exp_so3(
                {0.01 * choices_.below(16), -0.01 * choices_.below(16), 0.1 * choices_.below(63)}),
            {static_cast<double>(choices_.number(0.02F)),
             static_cast<double>(choices_.number(0.02F)),
             static_cast<double>(choices_.number(0.05F))}};
    }

    void follow() {
        T_odom_body_ = small_pose();
        if (choices_.below(8) == 1) T_odom_body_.translation_m *= 1e3;
        Matrix6 covariance = Matrix6::Zero();
        if (choices_.yes()) {
            for (int i = 0; i < 6; ++i)
                covariance(i, i) = std::abs(static_cast<double>(choices_.number(1e-5F)));
        }
        map_.follow(T_odom_body_, covariance);
        {
            const OnTarget other(target_);
            twin_.follow(T_odom_body_, covariance);
        }
        plain_.follow(T_odom_body_, covariance);
    }

    /// Fuses points around the machine, many of them in a few cells, like ground and obstacles on
    /// it. Some points are invalid.
    void cloud() {
        std::vector<MeasuredPoint> points;
        const int patches = 1 + choices_.below(4);
        for (int patch = 0; patch < patches; ++patch) {
            const Eigen::Vector3f at_m(
                choices_.number(0.02F), choices_.number(0.02F), choices_.number(0.05F));
            const float along_m2 = choices_.number(1e-4F);
            const float lateral_m2 = std::abs(choices_.number(1e-5F));
            const int count = choices_.below(80);
            for (int i = 0; i < count; ++i) {
                const Eigen::Vector3f off_m(0.007F * static_cast<float>(i % 9),
                                            0.011F * static_cast<float>(i % 7),
                                            0.002F * static_cast<float>(i % 5));
                points.push_back({at_m + off_m, std::abs(along_m2), lateral_m2});
            }
            if (choices_.yes()) points.push_back({at_m, along_m2, lateral_m2});
        }
        const Pose T_body_sensor = choices_.below(4) == 1 ? small_pose() : Pose{};
        fuse(points, T_body_sensor);
    }

    void fuse(const std::vector<MeasuredPoint>& points, const Pose& T_body_sensor) {
        const std::int64_t time_ns = next_time_ns();
        const FusionCounts counts = map_.add_points(points, T_body_sensor, T_odom_body_, time_ns);
        {
            const OnTarget other(target_);
            const FusionCounts again =
                twin_.add_points(points, T_body_sensor, T_odom_body_, time_ns, backwards_);
            must(same(counts, again), "counts of a cloud depend on executor or target");
        }
        if (config_.height_drift.enabled) return;
        must(same(counts, plain_.add_points(points, T_body_sensor, T_odom_body_, time_ns)),
             "counts of a cloud differ from the plain map");
    }

    /// Fuses level ground in most cells of the window, seen from above its middle. Rays pass over
    /// higher remembered cells and through them.
    void floor() {
        const Pose T_body_sensor{Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.0}};
        const Pose T_sensor_odom = (T_odom_body_ * T_body_sensor).inverse();
        const grid::GridGeometry& grid = map_.geometry();
        const auto z_m = static_cast<double>(choices_.number(0.05F));
        const int left_out = 2 + choices_.below(6);
        std::vector<MeasuredPoint> points;
        for (int iy = 0; iy < grid.ny; ++iy) {
            for (int ix = 0; ix < grid.nx; ++ix) {
                if ((ix + 2 * iy) % left_out == 1) continue;
                const Eigen::Vector2d at_m = grid.center_m({ix, iy});
                const Eigen::Vector3d point_m =
                    T_sensor_odom * Eigen::Vector3d(at_m.x(), at_m.y(), z_m);
                points.insert(points.end(), 4, {point_m.cast<float>(), 1e-5F, 1e-6F});
            }
        }
        fuse(points, T_body_sensor);
    }

    void depth_image() {
        camera::RectifiedRig rig;
        rig.width = choices_.below(40);
        rig.height = choices_.below(40);
        rig.fx_px = rig.fy_px = 20.0;
        rig.cx_px = 0.5 * rig.width;
        rig.cy_px = 0.5 * rig.height;
        rig.baseline_m = 0.12;
        rig.T_body_camera =
            Pose{exp_so3({0.0, 0.5 * std::numbers::pi, 0.0}), {0.0, 0.0, 1.0}} * T_body_optical();
        DepthImage depth;
        depth.resize(rig.width, rig.height);
        const float disparity_px = choices_.number(0.5F);
        const float sigma_px = choices_.number(0.1F);
        for (std::size_t i = 0; i < depth.disparity_px.size(); ++i) {
            depth.disparity_px.data()[i] = disparity_px;
            depth.sigma_px.data()[i] = sigma_px;
            depth.outlier_probability.data()[i] = 0.1F;
        }
        const int spoilt = choices_.below(8);
        for (int i = 0; i < spoilt && depth.disparity_px.size() > 0; ++i) {
            const std::size_t at = choices_.byte() * 7U % depth.disparity_px.size();
            depth.disparity_px.data()[at] = choices_.number(0.5F);
            depth.sigma_px.data()[at] = choices_.number(0.1F);
            depth.outlier_probability.data()[at] = choices_.number(0.05F);
        }
        const std::int64_t time_ns = next_time_ns();
        const FusionCounts counts = map_.add(rig, T_odom_body_, depth, time_ns);
        {
            const OnTarget other(target_);
            must(same(counts, twin_.add(rig, T_odom_body_, depth, time_ns, backwards_)),
                 "counts of an image depend on executor or target");
        }
        if (config_.height_drift.enabled) return;
        must(same(counts, plain_.add(rig, T_odom_body_, depth, time_ns)),
             "counts of an image differ from the plain map");
    }

    /// Inserts a remembered patch near the window: cells of one kind with a few holes.
    void region() {
        grid::MapRegion region;
        region.resolution_m = config_.resolution_m;
        region.box = grid::box_of(map_.geometry());
        region.box.first_ix += choices_.below(32) - 16;
        region.box.first_iy += choices_.below(32) - 16;
        region.box.nx = 1 + choices_.below(30);
        region.box.ny = 1 + choices_.below(30);
        grid::for_each_layer([&](const grid::RegionLayer&, auto member, auto unknown) {
            (region.*member).resize(region.box.nx, region.box.ny);
            (region.*member).fill(unknown);
        });
        const float z_m = choices_.number(0.02F);
        const float clearance_m = choices_.yes() ? choices_.number(0.1F) : kNanF;
        const float var_m2 = choices_.number(1e-4F);
        const int holes = 1 + choices_.below(5);
        for (std::size_t i = 0; i < region.height_m.size(); ++i) {
            if (i % static_cast<std::size_t>(holes) == 1) continue;
            region.height_m.data()[i] = z_m;
            region.height_var_m2.data()[i] = var_m2;
            region.count.data()[i] = 1U + choices_.byte() % 2U;
            region.seen_ns.data()[i] = 5;
            region.horizontal_drift_m.data()[i] = 0.01F;
            region.highest_m.data()[i] = z_m;
            region.lowest_m.data()[i] = z_m;
            region.clearance_m.data()[i] = clearance_m;
            region.confidence.data()[i] = 0.75F;
        }
        const Matrix6 placement = 1e-6 * Matrix6::Identity() * choices_.below(100);
        const auto filled = map_.insert(region, T_odom_body_, placement);
        const OnTarget other(target_);
        const auto again = twin_.insert(region, T_odom_body_, placement);
        must(filled.ok() == again.ok(), "only one of two equal maps accepts a region");
        must(!(filled.ok() && region.problem()), "the map accepted an invalid region");
        must_explain(filled);
        if (!filled.ok()) return;
        must(*filled == *again, "two equal maps filled different numbers of cells");
        must(config_.height_drift.enabled ||
                 *filled == plain_.insert(region, T_odom_body_, placement),
             "the map and the plain map filled different numbers of cells");
    }

    void clear() {
        map_.clear();
        twin_.clear();
        plain_.clear();
    }

    /// Time of the next frame: usually later, sometimes earlier, sometimes by years.
    std::int64_t next_time_ns() {
        constexpr std::int64_t kYear_ns = 31'536'000'000'000'000;
        const int way = choices_.below(16);
        time_ns_ += way == 15 ? -kYear_ns : way == 14 ? kYear_ns : way * 33'000'000 - 66'000'000;
        return time_ns_;
    }

    void compare() const {
        must(map_.geometry().origin_m == plain_.geometry().origin_m,
             "the windows of map and plain map differ");
        if (config_.height_drift.enabled) {
            compare_aligned();
            return;
        }
        const grid::MapRegion plain = plain_.layers();
        must(same_layers(map_.layers(), plain), "the map differs from the plain map");
        must(same_layers(twin_.layers(), plain), "the map depends on executor or target");
        const Image<float> free_above_m = plain_.free_above_m();
        must(same_cells(map_.layers().free_above_m, free_above_m),
             "free-space rays differ from the plain map");
        must(same_cells(twin_.layers().free_above_m, free_above_m),
             "free-space rays depend on executor or target");
        for (std::size_t i = 0; i < plain.height_m.size(); ++i) must_be_whole(plain, i);
    }

    void compare_aligned() const {
        const HeightDriftReport& a = map_.height_drift();
        const HeightDriftReport& b = twin_.height_drift();
        must(std::memcmp(&a.offset_m, &b.offset_m, sizeof(double)) == 0 &&
                 std::memcmp(&a.sigma_m, &b.sigma_m, sizeof(double)) == 0 && a.cells == b.cells &&
                 a.moved_cells == b.moved_cells && a.reason == b.reason,
             "the height drift depends on executor or target");
        must(std::isfinite(a.offset_m) && a.sigma_m >= 0.0,
             "a height drift is not finite or its sigma is negative");
        grid::MapRegion twin = plain_.layers();  // any region of the same size
        const ElevationLayers& layers = twin_.layers();
        twin.height_m = layers.height_m.copy();
        twin.height_var_m2 = layers.height_var_m2.copy();
        twin.count = layers.count.copy();
        twin.seen_ns = layers.seen_ns.copy();
        twin.horizontal_drift_m = layers.horizontal_drift_m.copy();
        twin.highest_m = layers.highest_m.copy();
        twin.lowest_m = layers.lowest_m.copy();
        twin.clearance_m = layers.clearance_m.copy();
        twin.confidence = layers.confidence.copy();
        twin.density_ratio = layers.density_ratio.copy();
        must(same_layers(map_.layers(), twin), "the map depends on executor or target");
        const Image<float> free_above_m = layers.free_above_m.copy();
        must(same_cells(map_.layers().free_above_m, free_above_m),
             "free-space rays depend on executor or target");
        for (std::size_t i = 0; i < twin.height_m.size(); ++i) must_be_whole(twin, i);
    }

    static bool same_layers(const ElevationLayers& a, const grid::MapRegion& b) {
        return same_cells(a.height_m, b.height_m) && same_cells(a.height_var_m2, b.height_var_m2) &&
               same_cells(a.count, b.count) && same_cells(a.seen_ns, b.seen_ns) &&
               same_cells(a.horizontal_drift_m, b.horizontal_drift_m) &&
               same_cells(a.highest_m, b.highest_m) && same_cells(a.lowest_m, b.lowest_m) &&
               same_cells(a.clearance_m, b.clearance_m) && same_cells(a.confidence, b.confidence) &&
               same_cells(a.density_ratio, b.density_ratio);
    }

    static void must_be_whole(const grid::MapRegion& map, std::size_t i) {
        const float height_m = map.height_m.data()[i];
        const float var_m2 = map.height_var_m2.data()[i];
        const float drift_m = map.horizontal_drift_m.data()[i];
        const float confidence = map.confidence.data()[i];
        const bool counted = map.count.data()[i] > 0;
        if (std::isnan(height_m)) {
            must(!counted && map.seen_ns.data()[i] == 0 && std::isnan(var_m2) &&
                     std::isnan(drift_m) && std::isnan(confidence),
                 "a cell of unknown height has other data");
            return;
        }
        must(std::isfinite(height_m), "a height is not finite");
        must(var_m2 > 0.0F, "a variance is not positive");
        must(drift_m >= 0.0F, "a drift is negative or NaN");
        must(confidence >= 0.0F && confidence <= 1.0F, "a confidence is outside 0 to 1");
        must(counted, "a cell with a height has no measurement");
    }

    Choices& choices_;
    int target_;
    ElevationConfig config_;
    ElevationMap map_;
    ElevationMap twin_;  ///< processes blocks backwards, on another instruction set
    PlainMap plain_;
    Backwards backwards_;
    Pose T_odom_body_;
    std::int64_t time_ns_ = 1'000'000'000'000;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    Choices choices(data, size - 1);
    ElevationConfig config = config_of(choices);
    set_sight(data[size - 1], config);
    if (config.problem()) return 0;
    Play play(config, choices);
    for (int i = 0; i < kMostOperations && !choices.done(); ++i) play.one_operation();
    return 0;
}
