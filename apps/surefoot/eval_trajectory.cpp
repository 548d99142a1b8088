// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/verbs.hpp"
#include "eval/path_errors.hpp"
#include "eval/picture.hpp"
#include "eval/trajectory.hpp"
#include "io/file.hpp"
#include "io/trajectory_file.hpp"
#include "surefoot/core/time.hpp"

namespace surefoot::app {
namespace {

/// KITTI poses have no stamps; --rate says when pose i was, counted from the first estimate.
Result<Trajectory> read_truth(const EvalTrajectoryOptions& options, const Trajectory& estimate) {
    if (options.rate_hz <= 0.0) return io::read_trajectory(options.truth);
    const auto poses = io::read_kitti_poses(options.truth);
    if (!poses) return poses.error();
    const std::int64_t start_ns = estimate.empty() ? 0 : estimate.front().time_ns;
    Trajectory truth;
    for (const Pose& pose : *poses) {
        const auto index = static_cast<double>(truth.size());
        truth.push_back({start_ns + ns_from_seconds(index / options.rate_hz), pose});
    }
    return truth;
}

eval::Alignment alignment_named(const std::string& name) {
    if (name == "none") return eval::Alignment::none;
    return name == "yaw" ? eval::Alignment::yaw : eval::Alignment::se3;
}

/// The trajectory over the true one from above, and below it the error over time. Drawn in the
/// estimate's world, whose z is up (odom): that of the truth may be a camera's (KITTI), a target's.
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
    const auto above =
        eval::render_trajectory(estimate,
                                eval::transformed(errors.T_truth_estimate.inverse(), matched_truth),
                                {"Trajectory from above",
                                 fmt::format("{} poses matched over {:.2f} m, aligned: {}",
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
        "{} poses matched over {:.2f} m (aligned: {})\nATE {:.4f} m rmse\nRPE {:.4f} m, {:.4f} "
        "deg rmse per pose\n",
        errors.matched,
        errors.path_length_m,
        options.align,
        errors.ate_rmse_m,
        errors.rpe_trans_rmse_m,
        errors.rpe_rot_rmse_deg);
    for (const eval::PathError& error : by_length) {
        if (error.count == 0) continue;
        fmt::print("RPE {:.4f} m ({:.2f} %), {:.4f} deg rmse over {:g} m of path ({} stretches)\n",
                   error.trans_rmse_m,
                   error.trans_percent,
                   error.rot_rmse_deg,
                   error.length_m,
                   error.count);
    }
    fmt::print("drift {:.2f} %\n", errors.drift_percent);
}

}  // namespace

int eval_trajectory(const EvalTrajectoryOptions& options) {
    const auto estimate = io::read_tum_trajectory(options.estimate);
    if (!estimate) return report(estimate.error());
    const auto truth = read_truth(options, *estimate);
    if (!truth) return report(truth.error());
    eval::EvalTrajectoryConfig config;
    config.align = alignment_named(options.align);
    const auto errors = eval::evaluate_trajectory(*estimate, *truth, config);
    if (!errors) return report(errors.error());
    const auto by_length = eval::errors_over_path(
        *estimate,
        *truth,
        errors->pairs,
        options.lengths_m.empty() ? eval::kPathLengths_m : options.lengths_m);
    if (options.common.json) {
        print_answer(trajectory_json(*errors, by_length));
    } else {
        print_errors(options, *errors, by_length);
    }
    if (options.plot_file.empty()) return kExitOk;
    const auto status = write_plot(options, *estimate, *truth, *errors);
    return status ? kExitOk : report(status.error());
}

}  // namespace surefoot::app
