// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "surefoot/eval/trajectory/trajectory.hpp"

namespace surefoot::eval {

/// Relative errors over path stretches of one length; NaN if no stretch has this length.
struct PathError {
    double length_m = 0.0;
    double trans_rmse_m = 0.0;
    double rot_rmse_deg = 0.0;
    double trans_percent = 0.0;  ///< rms of 100 |translation error| / true stretch length
    std::int64_t count = 0;      ///< number of stretches
};

/// Lengths that matter for a step (0.1 m, 0.5 m), a manoeuvre (1 m, 2 m) and a room (5 m).
inline const std::vector<double> kPathLengths_m = {0.1, 0.5, 1.0, 2.0, 5.0};

/// Relative pose errors over path lengths (Sturm et al. 2012, over metres instead of seconds). A
/// stretch may start at every matched pose. It ends at the later pose whose true path length from
/// the start is nearest to `length_m` (ties: the earliest), if it differs by at most a tenth. evo
/// uses the same rules for `evo_rpe --delta M --delta_unit m --all_pairs --pairs_from_reference`
/// with its default tolerance. The error of a stretch is relative_error, so alignment has no
/// effect. `pairs`: as in TrajectoryErrors. Lengths must be above 0.
[[nodiscard]] std::vector<PathError> errors_over_path(const Trajectory& estimate,
                                                      const Trajectory& truth,
                                                      const std::vector<PosePair>& pairs,
                                                      const std::vector<double>& lengths_m);

}  // namespace surefoot::eval
