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

/// A trajectory with the format of its file and the corrections that were made.
struct TrajectoryFile {
    Trajectory poses;    ///< poses with strictly increasing stamps
    std::string format;  ///< "TUM", "EuRoC csv", "KITTI poses" or "columns by name"
    std::string stamps;  ///< unit in the file ("s", "ms", "us", "ns"); for KITTI poses "none" or
                         ///< the source of the stamps
    std::int64_t repeated = 0;      ///< number of left-out rows with a repeated stamp
    double repeated_apart_m = 0.0;  ///< largest distance of a left-out row from its kept row
    std::int64_t not_finite = 0;    ///< number of left-out rows with NaN or infinity
    bool sorted = false;            ///< true if the rows of the file were not in time order
    /// Row number of each pose, for `give_stamps`; empty if the file has stamps. KITTI poses have
    /// no stamps: until `give_stamps` they have a rate of 10 Hz and start at 0 s.
    std::vector<std::size_t> row_of_pose;
    std::size_t rows = 0;

    [[nodiscard]] bool has_stamps() const noexcept { return stamps != "none"; }
    /// Returns one sentence for each correction of the rows.
    [[nodiscard]] std::vector<std::string> notes() const;
};

/// Reads a trajectory; the columns select the format:
///  - TUM: "stamp_s tx ty tz qx qy qz qw",
///  - EuRoC ground truth and similar: "stamp_ns,px,py,pz,qw,qx,qy,qz,...", by the names in its
///    header, or by its 17 columns,
///  - any table whose header names the stamp, the position and the quaternion,
///  - KITTI poses: twelve numbers, the upper 3x4 of T_world_camera row by row, without stamps.
/// Blanks, tabs, ',' or ';' separate numbers; '#' begins a comment line. The header or the size of
/// the stamps gives their unit. Repeated stamps and rows that are not finite are left out and
/// counted; rows are sorted by time. Errors name the line: a quaternion without length 1, a value
/// that is not a number, other columns.
[[nodiscard]] Result<TrajectoryFile> parse_trajectory(std::string_view text,
                                                      const std::string& file);
/// Reads a trajectory file. KITTI poses get their stamps from times.txt in the same folder, if the
/// file exists and the caller does not disable this.
[[nodiscard]] Result<TrajectoryFile> read_trajectory(const std::string& path,
                                                     bool ignore_times_beside = false);
/// Assigns stamps to KITTI poses; `times_ns` has one stamp per row. Sorts and thins the poses like
/// those of other files. `from`: source of the stamps, for reports.
[[nodiscard]] Status give_stamps(std::span<const std::int64_t> times_ns,
                                 const std::string& from,
                                 TrajectoryFile& trajectory);

/// Formats poses as TUM. Stamps have 9 decimals and are exact; lengths are exact to 1e-9 m.
[[nodiscard]] std::string format_tum_trajectory(const Trajectory& trajectory);
[[nodiscard]] Status write_tum_trajectory(const std::string& path, const Trajectory& trajectory);

/// Parses one stamp per line (KITTI times.txt), in seconds, or in a unit recognised by size. The
/// caller must check that the stamps increase.
[[nodiscard]] Result<std::vector<std::int64_t>> parse_times(std::string_view text,
                                                            const std::string& file);
[[nodiscard]] Result<std::vector<std::int64_t>> read_times(const std::string& path);

}  // namespace surefoot::io
