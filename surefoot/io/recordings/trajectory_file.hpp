// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/pose.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::io {

/// A trajectory as a file holds it, and what was done to it.
struct TrajectoryFile {
    Trajectory poses;    ///< stamps strictly growing
    std::string format;  ///< "TUM", "EuRoC csv", "KITTI poses" or "columns by name"
    std::string stamps;  ///< unit in the file ("s", "ms", "us", "ns"); with KITTI poses "none", or
                         ///< where they are from
    std::int64_t repeated = 0;      ///< rows left out: their stamp was there already
    double repeated_apart_m = 0.0;  ///< largest distance of such a row from the one that was kept
    std::int64_t not_finite = 0;    ///< rows left out: a number is NaN or infinite
    bool sorted = false;            ///< the rows were not in the order of time
    /// KITTI poses have no stamps: they are 10 Hz from 0 until `give_stamps` is called, which needs
    /// the number of each pose's row, and how many rows there are. Empty where stamps are known.
    std::vector<std::size_t> row_of_pose;
    std::size_t rows = 0;

    [[nodiscard]] bool has_stamps() const noexcept { return stamps != "none"; }
    /// One sentence for each thing that was done to the rows.
    [[nodiscard]] std::vector<std::string> notes() const;
};

/// Reads a trajectory, told apart by its columns:
///  - TUM: "stamp_s tx ty tz qx qy qz qw",
///  - EuRoC ground truth and its kind: "stamp_ns,px,py,pz,qw,qx,qy,qz,...", by the names in its
///  head
///    or by its 17 columns,
///  - any table with a head line that names the stamp, the position and the quaternion,
///  - KITTI poses: twelve numbers, the upper 3x4 of T_world_camera row by row, without stamps.
/// Blanks, tabs or commas separate; '#' lines are comments. The unit of stamps is told by their
/// size. Repeated stamps and rows that are not finite are left out and counted; rows are sorted by
/// time. Errors name the line: a quaternion without length 1, a number that is none, other columns.
[[nodiscard]] Result<TrajectoryFile> parse_trajectory(std::string_view text,
                                                      const std::string& file);
/// KITTI poses get their stamps from times.txt in the same folder, where there is one and it is not
/// to be ignored.
[[nodiscard]] Result<TrajectoryFile> read_trajectory(const std::string& path,
                                                     bool ignore_times_beside = false);
/// Gives KITTI poses their stamps, of which `times_ns` holds one for each row, and sorts and thins
/// them as those of other files. `from`: where the stamps come from.
[[nodiscard]] Status give_stamps(std::span<const std::int64_t> times_ns,
                                 const std::string& from,
                                 TrajectoryFile& trajectory);

/// TUM: stamps with 9 decimals are exact; lengths to 1e-9 m.
[[nodiscard]] std::string format_tum_trajectory(const Trajectory& trajectory);
[[nodiscard]] Status write_tum_trajectory(const std::string& path, const Trajectory& trajectory);

/// One stamp per line (KITTI times.txt), in seconds, or in a unit that their size tells. Whoever
/// uses them checks that they grow.
[[nodiscard]] Result<std::vector<std::int64_t>> parse_times(std::string_view text,
                                                            const std::string& file);
[[nodiscard]] Result<std::vector<std::int64_t>> read_times(const std::string& path);

}  // namespace surefoot::io
