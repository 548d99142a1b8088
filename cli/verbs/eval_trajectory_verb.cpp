// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "cli/json/eval_answers.hpp"
#include "cli/verbs/verbs.hpp"
#include "service/console/log.hpp"
#include "surefoot/core/time.hpp"
#include "surefoot/eval/report/picture.hpp"
#include "surefoot/eval/trajectory/path_errors.hpp"
#include "surefoot/eval/trajectory/trajectory.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/recordings/trajectory_file.hpp"

namespace surefoot::app {
namespace {

struct EvalTrajectoryOptions {
    CommonOptions common;
    std::string estimate;
    std::string truth;
    std::string align = "se3";
    double rate_hz = 0.0;
    std::string times_file;  ///< file of the time stamps of KITTI poses; empty = no file
    /// Path lengths over which relative errors are computed; empty = 0.1, 0.5, 1, 2 and 5 m.
    std::vector<double> lengths_m;
    std::string plot_file;
};

/// Both trajectories, as read from their files.
struct TrajectoryPair {
    io::TrajectoryFile estimate;
    io::TrajectoryFile truth;
};

/// Gives the stamps of the --times file to each trajectory that has no stamps.
Status stamp_from_file(const std::string& times_file, TrajectoryPair& pair) {
    if (pair.estimate.has_stamps() && pair.truth.has_stamps()) {
        return usage_error(fmt::format(
            "--times {}: both trajectories have time stamps of their own; remove --times",
            times_file));
    }
    const auto times_ns = io::read_times(times_file);
    if (!times_ns) return times_ns.error();
    for (io::TrajectoryFile* file : {&pair.estimate, &pair.truth}) {
        if (file->has_stamps()) continue;
        if (auto status = io::give_stamps(*times_ns, times_file, *file); !status) return status;
    }
    return {};
}

/// Stamps pose i of the truth with i / --rate after the first pose of the estimate.
Status stamp_at_rate(const EvalTrajectoryOptions& options, TrajectoryPair& pair) {
    if (pair.truth.has_stamps()) {
        return usage_error(fmt::format("--rate {:g}: {} has time stamps of its own; remove --rate",
                                       options.rate_hz,
                                       options.truth));
    }
    std::vector<std::int64_t> times_ns;
    for (std::size_t i = 0; i < pair.truth.rows; ++i) {
        times_ns.push_back(pair.estimate.poses.front().time_ns +
                           ns_from_seconds(static_cast<double>(i) / options.rate_hz));
    }
    return io::give_stamps(times_ns, fmt::format("--rate {:g}", options.rate_hz), pair.truth);
}

/// Handles the case that only one trajectory has stamps. If both have the same number of poses,
/// pose i without a stamp gets the stamp of pose i of the other trajectory. A truth with another
/// number of poses keeps stamps at 10 Hz from 0 s, the frame rate of KITTI.
Status stamp_by_index(const EvalTrajectoryOptions& options, TrajectoryPair& pair) {
    const bool of_estimate = !pair.estimate.has_stamps();
    // Nothing to do if both trajectories have stamps, or if both have none.
    if (of_estimate == !pair.truth.has_stamps()) return {};
    io::TrajectoryFile& bare = of_estimate ? pair.estimate : pair.truth;
    const io::TrajectoryFile& other = of_estimate ? pair.truth : pair.estimate;
    if (bare.rows == other.poses.size()) {
        std::vector<std::int64_t> times_ns;
        for (const StampedPose& pose : other.poses) times_ns.push_back(pose.time_ns);
        return io::give_stamps(times_ns, "the same rows as the other trajectory", bare);
    }
    if (!of_estimate) return {};
    return input_error(
        fmt::format("{}: {} poses have no time stamps, and {} has another number of poses, {}; "
                    "give the time stamps with --times",
                    options.estimate,
                    bare.rows,
                    options.truth,
                    other.poses.size()));
}

Result<TrajectoryPair> read_pair(const EvalTrajectoryOptions& options) {
    const bool time_is_known = !options.times_file.empty() || options.rate_hz > 0.0;
    auto estimate = io::read_trajectory(options.estimate, !options.times_file.empty());
    if (!estimate) return estimate.error();
    auto truth = io::read_trajectory(options.truth, time_is_known);
    if (!truth) return truth.error();
    TrajectoryPair pair{std::move(estimate).value(), std::move(truth).value()};
    Status status = !options.times_file.empty() ? stamp_from_file(options.times_file, pair)
                    : options.rate_hz > 0.0     ? stamp_at_rate(options, pair)
                                                : stamp_by_index(options, pair);
    if (!status) return status.error();
    return pair;
}

void print_file(const char* what, const io::TrajectoryFile& file) {
    fmt::print("{}: {}, stamps: {}, {} poses\n", what, file.format, file.stamps, file.poses.size());
}

eval::Alignment alignment_named(const std::string& name) {
    if (name == "none") return eval::Alignment::none;
    return name == "yaw" ? eval::Alignment::yaw : eval::Alignment::se3;
}

/// Plots both trajectories from above, and the error over time below. The plot uses the frame of
/// the estimate (odom), in which z points up. The frame of the truth may be a camera (KITTI) or a
/// tracking target.
Status write_plot(const EvalTrajectoryOptions& options,
                  const Trajectory& estimate,
                  const Trajectory& truth,
                  const eval::TrajectoryErrors& errors) {
    Trajectory matched_truth;
    std::vector<eval::ErrorSample> samples;
    for (std::size_t k = 0; k < errors.pairs.size(); ++k) {
        const std::int64_t time_ns = estimate[errors.pairs[k].estimate].time_ns;
        const std::int64_t start_ns = estimate[errors.pairs.front().estimate].time_ns;
        matched_truth.push_back(truth[errors.pairs[k].truth]);
        samples.push_back({seconds_from_ns(time_ns - start_ns), errors.position_error_m[k]});
    }
    const auto above = eval::render_trajectory(
        estimate,
        eval::transformed(errors.T_truth_estimate.inverse(), matched_truth),
        {"Trajectory from above",
         fmt::format("{} matched poses over a path of {:.2f} m, alignment: {}",
                     errors.matched,
                     errors.path_length_m,
                     options.align)});
    const auto over_time = eval::render_error_over_time(
        samples, {"Position error over time", fmt::format("ATE {:.4f} m rmse", errors.ate_rmse_m)});
    const auto png = eval::encode_png(eval::stacked(above, over_time));
    return io::write_file(options.plot_file, png);
}

void print_errors(const EvalTrajectoryOptions& options,
                  const eval::TrajectoryErrors& errors,
                  const std::vector<eval::PathError>& by_length) {
    fmt::print(
        "{} matched poses over a path of {:.2f} m (alignment: {})\nabsolute error (ATE): {:.4f} m "
        "rmse\nrelative error (RPE) from pose to pose: {:.4f} m, {:.4f} deg rmse\n",
        errors.matched,
        errors.path_length_m,
        options.align,
        errors.ate_rmse_m,
        errors.rpe_trans_rmse_m,
        errors.rpe_rot_rmse_deg);
    for (const eval::PathError& error : by_length) {
        if (error.count == 0) continue;
        fmt::print(
            "relative error (RPE): {:.4f} m ({:.2f} %), {:.4f} deg rmse over {:g} m of path ({} "
            "path sections)\n",
            error.trans_rmse_m,
            error.trans_percent,
            error.rot_rmse_deg,
            error.length_m,
            error.count);
    }
    fmt::print("drift {:.2f} %\n", errors.drift_percent);
}

/// `surefoot eval trajectory`: computes the absolute error, the relative error and the drift of a
/// trajectory.
int eval_trajectory(const EvalTrajectoryOptions& options) {
    const auto pair = read_pair(options);
    if (!pair) return report(pair.error());
    const Trajectory& estimate = pair->estimate.poses;
    const Trajectory& truth = pair->truth.poses;
    for (const std::string& note : pair->estimate.notes())
        log_warning(fmt::format("{}: {}", options.estimate, note));
    for (const std::string& note : pair->truth.notes())
        log_warning(fmt::format("{}: {}", options.truth, note));
    eval::EvalTrajectoryConfig config;
    config.align = alignment_named(options.align);
    const auto errors = eval::evaluate_trajectory(estimate, truth, config);
    if (!errors) return report(errors.error());
    const auto by_length = eval::errors_over_path(
        estimate,
        truth,
        errors->pairs,
        options.lengths_m.empty() ? eval::kPathLengths_m : options.lengths_m);
    if (options.common.json) {
        print_answer(trajectory_json(*errors, by_length, pair->estimate, pair->truth));
    } else {
        print_file("estimate", pair->estimate);
        print_file("truth", pair->truth);
        print_errors(options, *errors, by_length);
    }
    if (options.plot_file.empty()) return kExitOk;
    const auto status = write_plot(options, estimate, truth, *errors);
    return status ? kExitOk : report(status.error());
}

}  // namespace

void add_eval_trajectory(VerbGroup verbs) {
    auto [verb, o] = verbs.add<EvalTrajectoryOptions>(
        "trajectory",
        "compute the absolute error (ATE), the relative error (RPE) and the drift of a trajectory",
        "surefoot eval trajectory out/floor/trajectory.tum "
        "out/floor_recording/groundtruth.tum --json",
        eval_trajectory,
        Reads::no_settings);
    verb.option("estimate",
                o.estimate,
                "file of the estimated trajectory: TUM, EuRoC csv, or KITTI 3x4 poses")
        .required()
        .value("EST");
    verb.option("truth", o.truth, "file of the true trajectory: TUM, EuRoC csv, or KITTI 3x4 poses")
        .required()
        .value("TRUTH");
    verb.option("--align",
                o.align,
                "transformation that aligns the estimate with the truth before the comparison. se3 "
                "(default): rotation and translation; yaw: translation and rotation about z; none: "
                "no alignment")
        .one_of({"se3", "yaw", "none"});
    const Option rate = verb.option("--rate",
                                    o.rate_hz,
                                    "frame rate of a true trajectory that is a file of KITTI poses "
                                    "without times.txt, in Hz")
                            .value("HZ")
                            .in(0.01, 1000.0);
    verb.option("--times", o.times_file, "file with one time stamp per line, in s, for KITTI poses")
        .value("FILE")
        .excludes(rate);
    verb.option("--delta",
                o.lengths_m,
                "path length over which a relative error is computed, in m; repeat the option for "
                "more lengths (default 0.1, 0.5, 1, 2 and 5)")
        .value("M")
        .one_value_each()
        .in(1e-3, 1e6);
    verb.option("--plot",
                o.plot_file,
                "file for a picture that shows the trajectory from above and the error over time")
        .value("F.png");
}

}  // namespace surefoot::app
