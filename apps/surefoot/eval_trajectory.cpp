// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "apps/surefoot/json_output.hpp"
#include "apps/surefoot/log.hpp"
#include "apps/surefoot/verbs.hpp"
#include "eval/trajectory.hpp"
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

}  // namespace

int eval_trajectory(const EvalTrajectoryOptions& options) {
    const auto estimate = io::read_tum_trajectory(options.estimate);
    if (!estimate) return report(estimate.error());
    const auto truth = read_truth(options, *estimate);
    if (!truth) return report(truth.error());
    eval::EvalTrajectoryConfig config;
    config.align = options.align == "none"  ? eval::Alignment::none
                   : options.align == "yaw" ? eval::Alignment::yaw
                                            : eval::Alignment::se3;
    const auto errors = eval::evaluate_trajectory(*estimate, *truth, config);
    if (!errors) return report(errors.error());
    if (options.common.json) {
        fmt::print("{}\n", trajectory_json(*errors));
    } else {
        fmt::print(
            "{} poses matched over {:.2f} m (aligned: {})\nATE {:.4f} m rmse\nRPE {:.4f} m, {:.4f} "
            "deg rmse per pose\n"
            "drift {:.2f} %\n",
            errors->matched,
            errors->path_length_m,
            options.align,
            errors->ate_rmse_m,
            errors->rpe_trans_rmse_m,
            errors->rpe_rot_rmse_deg,
            errors->drift_percent);
    }
    return kExitOk;
}

}  // namespace surefoot::app
