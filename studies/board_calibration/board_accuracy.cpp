// SPDX-License-Identifier: Apache-2.0
#include "studies/board_calibration/board_accuracy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <sstream>

#include "service/live/measured_pair.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/checked_index.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/sim/sensors/board_view.hpp"

namespace surefoot::app {
namespace {

/// Half side of the evaluated part, as a share of the half side of the board. The border is left
/// out, because stereo matchers smear foreground and background there.
constexpr double kInnerShare = 0.8;
/// With fewer trusted pixels on the board [share] no error is given: the board is out of range, and
/// the few matches are wrong.
constexpr double kLeastTrusted = 0.05;
constexpr double kMinDistance_m = 0.1;
constexpr double kMaxDistance_m = 20.0;
constexpr std::array kUsualDistances_m = {0.3, 0.4, 0.6, 0.8, 1.0, 1.5, 2.0};
/// Two distances count as equal if they differ by less than this [m]. The reference thesis (Lange
/// 2016) uses round numbers.
constexpr double kSameDistance_m = 1e-6;

/// Errors of one image pair of a board.
struct BoardObservation {
    double distance_m;
    std::optional<eval::BoardErrors> errors;
    double density_percent;
};

/// Widens the configured disparity range if a board at this distance needs more. The new range is
/// 1.1 times the need, rounded up to a multiple of 16 px, but at most the longest range of the
/// algorithm.
pipeline::PipelineConfig with_range_for(double distance_m,
                                        const camera::RectifiedRig& rig,
                                        pipeline::PipelineConfig config) {
    constexpr int kStep = 16;
    const int most = stereo::longest_range_px(config.stereo.algorithm);
    const double steps = std::ceil(1.1 * rig.depth_to_disparity_px_m() / distance_m / kStep);
    const int needed = std::min(saturated_integer<int>(steps), most / kStep) * kStep;
    config.stereo.disparities = std::min(std::max(config.stereo.disparities, needed), most);
    return config;
}

/// Returns the points of the trusted pixels that show the inner part of the board. `pixels` counts
/// all pixels that show this part.
std::vector<Eigen::Vector3d> board_points(const camera::RectifiedRig& rig,
                                          const DepthImage& depth,
                                          double distance_m,
                                          double side_m,
                                          std::int64_t& pixels) {
    const double limit = 0.5 * kInnerShare * side_m / distance_m;  // position on the plane z = 1
    // Farther left, the matching point lies outside the right image.
    const double first_u = rig.depth_to_disparity_px_m() / distance_m;
    std::vector<Eigen::Vector3d> points_m;
    for (int v = 0; v < rig.height; ++v) {
        for (int u = saturated_integer<int>(std::ceil(first_u)); u < rig.width; ++u) {
            if (std::abs((u - rig.cx_px) / rig.fx_px) > limit ||
                std::abs((v - rig.cy_px) / rig.fy_px) > limit) {
                continue;
            }
            ++pixels;
            const float disparity_px = depth.disparity_px.at(u, v);
            if (disparity_px > 0.0F &&
                depth.outlier_probability.at(u, v) <= kTrustedOutlierProbability) {
                points_m.push_back(rig.point(u, v, static_cast<double>(disparity_px)));
            }
        }
    }
    return points_m;
}

BoardObservation look_at(const MeasuredPair& measured,
                         double nominal_m,
                         double true_m,
                         double side_m) {
    std::int64_t pixels = 0;
    const auto points_m = board_points(*measured.rig, measured.depth, nominal_m, side_m, pixels);
    const double share =
        pixels == 0 ? 0.0 : static_cast<double>(points_m.size()) / static_cast<double>(pixels);
    if (share < kLeastTrusted) return {nominal_m, std::nullopt, 100.0 * share};
    return {nominal_m, eval::board_errors(points_m, true_m), 100.0 * share};
}

/// Returns the true distance of the board along the optical axis of the rectified camera. This axis
/// differs from the axis of the raw camera if the cameras of the rig are rotated against each
/// other.
double true_distance_m(const camera::RectifiedRig& rig,
                       const Image<float>& disparity_px,
                       double nominal_m,
                       double side_m) {
    DepthImage exact;
    exact.resize(rig.width, rig.height);
    exact.disparity_px = disparity_px;
    std::int64_t pixels = 0;
    const auto points_m = board_points(rig, exact, nominal_m, side_m, pixels);
    const auto plane = eval::fit_board(points_m);
    return plane ? plane->distance_m() : nominal_m;
}

Result<std::vector<BoardObservation>> rendered_observations(const DepthAccuracyOptions& options,
                                                            const Settings& settings,
                                                            const camera::StereoRig& rig,
                                                            Executor& executor) {
    const auto rectifier = camera::Rectifier::make(rig, settings.pipeline.camera);
    if (!rectifier) return rectifier.error();
    sim::BoardView view;
    view.side_m = options.board_m;
    view.profile = settings.sim.profile;
    view.noise = settings.sim.noise;
    view.contrast = settings.sim.contrast;
    view.camera = settings.sim.camera;
    view.calibration_error = settings.sim.calibration_error;
    std::vector<double> distances_m = options.distances_m;
    if (distances_m.empty()) distances_m.assign(kUsualDistances_m.begin(), kUsualDistances_m.end());
    std::vector<BoardObservation> observations;
    for (const double distance_m : distances_m) {
        const auto config = with_range_for(distance_m, rectifier->rig(), settings.pipeline);
        for (int k = 0; k < options.repeats; ++k) {
            view.distance_m = distance_m;
            view.seed = options.common.seed + static_cast<std::uint64_t>(k);
            const auto seen = sim::see_board(view, rig, rectifier->rig(), executor);
            if (!seen) return seen.error();
            const auto measured = measure_pair(seen->frame, rig, config, executor);
            if (!measured) return measured.error();
            const double true_m =
                true_distance_m(*measured->rig, seen->disparity_px, distance_m, options.board_m);
            observations.push_back(look_at(*measured, distance_m, true_m, options.board_m));
        }
    }
    return observations;
}

struct PairLine {
    std::string left;
    std::string right;
    double distance_m = 0.0;
};

Result<std::vector<PairLine>> read_pairs(const std::string& path) {
    const auto text = io::read_file(path);
    if (!text) return text.error();
    const std::string folder = io::folder_of(path);
    std::vector<PairLine> pairs;
    std::istringstream lines(*text);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        std::istringstream words(line.substr(0, line.find('#')));
        PairLine pair;
        std::string rest;
        if (!(words >> pair.left)) continue;
        if (!(words >> pair.right >> pair.distance_m) || (words >> rest)) {
            return input_error(fmt::format(
                "{}:{}: expected LEFT RIGHT DISTANCE_M, found '{}'", path, number, line));
        }
        if (!(pair.distance_m >= kMinDistance_m && pair.distance_m <= kMaxDistance_m)) {
            return input_error(
                fmt::format("{}:{}: the distance is {} m, but it must be between {} and {} m",
                            path,
                            number,
                            pair.distance_m,
                            kMinDistance_m,
                            kMaxDistance_m));
        }
        pair.left = io::join_path(folder, pair.left);
        pair.right = io::join_path(folder, pair.right);
        pairs.push_back(std::move(pair));
    }
    if (pairs.empty()) return input_error(path + ": the file has no line LEFT RIGHT DISTANCE_M");
    return pairs;
}

Result<std::vector<BoardObservation>> recorded_observations(const DepthAccuracyOptions& options,
                                                            const Settings& settings,
                                                            const camera::StereoRig& rig,
                                                            Executor& executor) {
    const auto pairs = read_pairs(options.pairs_file);
    if (!pairs) return pairs.error();
    const auto rectifier = camera::Rectifier::make(rig, settings.pipeline.camera);
    if (!rectifier) return rectifier.error();
    std::vector<BoardObservation> observations;
    for (const PairLine& pair : *pairs) {
        const auto config = with_range_for(pair.distance_m, rectifier->rig(), settings.pipeline);
        const auto measured = measure_files(pair.left, pair.right, rig, config, executor);
        if (!measured) return measured.error();
        observations.push_back(
            look_at(*measured, pair.distance_m, pair.distance_m, options.board_m));
    }
    return observations;
}

DistanceAccuracy summary_of(double distance_m,
                            const std::vector<BoardObservation>& observations,
                            const std::optional<std::string>& thesis) {
    DistanceAccuracy row;
    row.distance_m = distance_m;
    row.observations = static_cast<int>(observations.size());
    std::vector<eval::BoardErrors> found;
    for (const BoardObservation& observation : observations) {
        row.density_percent +=
            observation.density_percent / static_cast<double>(observations.size());
        if (observation.errors) found.push_back(*observation.errors);
    }
    if (!found.empty()) row.errors = eval::mean_of(found);
    for (const ThesisAccuracy& value : thesis_accuracy()) {
        if (thesis && value.camera == *thesis &&
            std::abs(value.distance_m - distance_m) < kSameDistance_m) {
            row.thesis = value;
        }
    }
    return row;
}

}  // namespace

const std::vector<ThesisAccuracy>& thesis_accuracy() {
    static const std::vector<ThesisAccuracy> table = {{"DUO", 0.6, 0.005, 0.0105},
                                                      {"DUO", 0.8, 0.045, 0.015},
                                                      {"DUO", 1.0, 0.011, 0.015},
                                                      {"DUO", 1.5, 0.045, 0.027},
                                                      {"DUO", 2.0, 0.155, 0.032},
                                                      {"ZED", 1.0, 0.018, 0.0125},
                                                      {"ZED", 1.5, 0.018, 0.0247},
                                                      {"ZED", 2.0, 0.006, 0.010},
                                                      {"R200", 1.0, 0.045, 0.004},
                                                      {"R200", 1.5, 0.026, 0.0145}};
    return table;
}

std::optional<std::string> thesis_camera(const std::string& rig_name) {
    if (rig_name.starts_with("zed")) return "ZED";
    if (rig_name.starts_with("duo")) return "DUO";
    return std::nullopt;
}

Result<std::vector<DistanceAccuracy>> measure_accuracy(const DepthAccuracyOptions& options,
                                                       const Settings& settings,
                                                       const camera::StereoRig& rig,
                                                       Executor& executor) {
    const auto observations = options.pairs_file.empty()
                                  ? rendered_observations(options, settings, rig, executor)
                                  : recorded_observations(options, settings, rig, executor);
    if (!observations) return observations.error();
    std::map<double, std::vector<BoardObservation>> by_distance;
    for (const BoardObservation& observation : *observations)
        by_distance[observation.distance_m].push_back(observation);
    std::vector<DistanceAccuracy> rows;
    rows.reserve(by_distance.size());
    for (const auto& [distance_m, same] : by_distance)
        rows.push_back(summary_of(distance_m, same, thesis_camera(rig.name)));
    return rows;
}

}  // namespace surefoot::app
