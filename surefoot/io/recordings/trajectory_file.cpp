// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/recordings/trajectory_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "surefoot/io/file.hpp"
#include "surefoot/io/recordings/stamps.hpp"
#include "surefoot/io/recordings/trajectory_table.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

/// Limit of the length error of a quaternion. Six printed decimals keep the length to 1e-6; an
/// error above this limit is not a rounding error.
constexpr double kNormTolerance = 0.01;
/// Limit of R^T R - I; KITTI prints seven digits.
constexpr double kRotationTolerance = 1e-3;
constexpr double kFarthest_m = 1e9;  ///< largest coordinate; a double still resolves 1 um there
constexpr std::int64_t kKittiPeriod_ns = 100'000'000;

Error at_line(const std::string& file, int line, const std::string& what) {
    return input_error(fmt::format("{}:{}: {}", file, line, what));
}

/// Builds a pose from x y z qx qy qz qw.
Result<Pose> pose_of_seven(const std::array<double, 12>& v) {
    const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
    if (std::abs(rotation.norm() - 1.0) > kNormTolerance) {
        return input_error(fmt::format(
            "quaternion has length {:.4f}; it must be 1 +- {}", rotation.norm(), kNormTolerance));
    }
    return Pose{rotation.normalized(), {v[0], v[1], v[2]}};
}

/// Builds a pose from the upper 3x4 part of a matrix, row by row.
Result<Pose> pose_of_twelve(const std::array<double, 12>& v) {
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    for (Eigen::Index i = 0; i < 12; ++i) T(i / 4, i % 4) = v[static_cast<std::size_t>(i)];
    const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
    const double error = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
    if (!(error < kRotationTolerance) || R.determinant() < 0.0) {
        return input_error(
            fmt::format("the left 3x3 part of the matrix is not a rotation: R^T R differs from 1 "
                        "by {:.3g} (limit 0.001), or the matrix is a reflection",
                        error));
    }
    return Pose::from_matrix(T);
}

StampUnit unit_of(const TrajectoryTable& table) {
    if (table.layout().unit) return *table.layout().unit;
    std::vector<std::string_view> stamps;
    for (const TrajectoryRow& row : table.rows()) stamps.push_back(row.stamp);
    return stamp_unit_of(stamps);
}

/// Sorts poses by time. Keeps the first pose of the file if several poses have the same stamp.
void sort_and_thin(TrajectoryFile& out) {
    const auto earlier = [](const StampedPose& a, const StampedPose& b) {
        return a.time_ns < b.time_ns;
    };
    out.sorted = !std::is_sorted(out.poses.begin(), out.poses.end(), earlier);
    std::stable_sort(out.poses.begin(), out.poses.end(), earlier);
    Trajectory kept;
    for (const StampedPose& pose : out.poses) {
        if (kept.empty() || pose.time_ns != kept.back().time_ns) {
            kept.push_back(pose);
            continue;
        }
        ++out.repeated;
        const double apart_m =
            (pose.T_world_body.translation_m - kept.back().T_world_body.translation_m).norm();
        out.repeated_apart_m = std::max(out.repeated_apart_m, apart_m);
    }
    out.poses = std::move(kept);
}

}  // namespace

std::vector<std::string> TrajectoryFile::notes() const {
    std::vector<std::string> notes;
    if (repeated > 0) {
        notes.push_back(
            fmt::format("{} rows with a repeated time stamp are left out; the first row of each "
                        "stamp is kept (the other rows are at most {:.4f} m away)",
                        repeated,
                        repeated_apart_m));
    }
    if (not_finite > 0)
        notes.push_back(fmt::format("{} rows with NaN or infinity are left out", not_finite));
    if (sorted) notes.emplace_back("the rows were not in order of time; the program sorted them");
    return notes;
}

Result<TrajectoryFile> parse_trajectory(std::string_view text, const std::string& file) {
    const auto table = TrajectoryTable::read(text, file);
    if (!table) return table.error();
    TrajectoryFile out;
    out.format = table->layout().format;
    const bool stamped = table->layout().stamped;
    const StampUnit unit = unit_of(*table);
    out.stamps = stamped ? std::string(unit.name) : "none";
    for (const TrajectoryRow& row : table->rows()) {
        const std::size_t index = out.rows++;
        if (!row.finite) {
            ++out.not_finite;
            continue;
        }
        const auto time_ns = stamped ? parse_stamp_ns(row.stamp, unit)
                                     : static_cast<std::int64_t>(index) * kKittiPeriod_ns;
        if (!time_ns) {
            return at_line(file,
                           row.line,
                           fmt::format("stamp {} must be a number below 9.2e18 ns (unit: {})",
                                       quoted(row.stamp),
                                       unit.name));
        }
        const auto pose = stamped ? pose_of_seven(row.numbers) : pose_of_twelve(row.numbers);
        if (!pose) return at_line(file, row.line, pose.error().message);
        if (const double far_m = pose->translation_m.cwiseAbs().maxCoeff(); far_m > kFarthest_m) {
            return at_line(file,
                           row.line,
                           fmt::format("a coordinate of the position is {:g} m; at most {:g} m are "
                                       "allowed: check the unit",
                                       far_m,
                                       kFarthest_m));
        }
        out.poses.push_back({*time_ns, *pose});
        if (!stamped) out.row_of_pose.push_back(index);
    }
    if (out.poses.empty()) {
        return input_error(
            fmt::format("{}: no poses in this trajectory ({} rows of numbers; rows with NaN or "
                        "infinity do not count)",
                        file,
                        table->rows().size()));
    }
    if (stamped) sort_and_thin(out);
    return out;
}

Status give_stamps(std::span<const std::int64_t> times_ns,
                   const std::string& from,
                   TrajectoryFile& trajectory) {
    if (times_ns.size() < trajectory.rows) {
        return input_error(
            fmt::format("{}: {} time stamps for {} poses; each pose needs a time stamp",
                        from,
                        times_ns.size(),
                        trajectory.rows));
    }
    for (std::size_t i = 0; i < trajectory.poses.size(); ++i) {
        trajectory.poses[i].time_ns = times_ns[trajectory.row_of_pose[i]];
    }
    trajectory.stamps = from;
    trajectory.row_of_pose.clear();
    sort_and_thin(trajectory);
    return {};
}

std::string format_tum_trajectory(const Trajectory& trajectory) {
    std::string out = "# stamp_s tx ty tz qx qy qz qw\n";
    for (const StampedPose& pose : trajectory) {
        const Eigen::Vector3d& t = pose.T_world_body.translation_m;
        const Eigen::Quaterniond& q = pose.T_world_body.rotation;
        out += fmt::format("{} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n",
                           format_seconds(pose.time_ns),
                           t.x(),
                           t.y(),
                           t.z(),
                           q.x(),
                           q.y(),
                           q.z(),
                           q.w());
    }
    return out;
}

Result<TrajectoryFile> read_trajectory(const std::string& path, bool ignore_times_beside) {
    const Result<std::string> text = read_file(path);
    if (!text) return text.error();
    Result<TrajectoryFile> trajectory = parse_trajectory(*text, path);
    if (!trajectory || trajectory->has_stamps() || ignore_times_beside) return trajectory;
    const std::string times = join_path(folder_of(path), "times.txt");
    if (!is_file(times)) return trajectory;
    const auto times_ns = read_times(times);
    if (!times_ns) return times_ns.error();
    if (Status status = give_stamps(*times_ns, times, *trajectory); !status) return status.error();
    return trajectory;
}

Status write_tum_trajectory(const std::string& path, const Trajectory& trajectory) {
    return write_file(path, format_tum_trajectory(trajectory));
}

Result<std::vector<std::int64_t>> parse_times(std::string_view text, const std::string& file) {
    if (const auto problem = encoding_problem(text)) return at_line(file, 1, *problem);
    std::vector<std::string_view> words;
    std::vector<int> line_of;
    LineReader lines(text);
    while (const auto line = lines.next()) {
        const std::string_view content = trimmed(*line);
        if (content.empty() || is_comment(content)) continue;
        if (!parse_double(content))
            return at_line(file, lines.number(), "stamp " + why_no_number(content));
        words.push_back(content);
        line_of.push_back(lines.number());
    }
    const StampUnit unit = stamp_unit_of(words);
    std::vector<std::int64_t> times_ns;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const auto time_ns = parse_stamp_ns(words[i], unit);
        if (!time_ns || *time_ns < 0) {
            return at_line(
                file,
                line_of[i],
                fmt::format("time stamp {} must be a number from 0 to 9.2e18 ns (unit: {})",
                            quoted(words[i]),
                            unit.name));
        }
        times_ns.push_back(*time_ns);
    }
    return times_ns;
}

Result<std::vector<std::int64_t>> read_times(const std::string& path) {
    const Result<std::string> text = read_file(path);
    if (!text) return text.error();
    return parse_times(*text, path);
}

}  // namespace surefoot::io
