// SPDX-License-Identifier: Apache-2.0
#include "io/trajectory_file.hpp"

#include <fmt/format.h>

#include <cmath>

#include "io/file.hpp"
#include "io/text.hpp"

namespace surefoot::io {
namespace {

/// Six printed decimals keep a unit quaternion to 1e-6; more than this is not a rounding error.
constexpr double kNormTolerance = 0.01;
/// KITTI prints seven digits.
constexpr double kRotationTolerance = 1e-3;
constexpr std::int64_t kKittiPeriod_ns = 100'000'000;

Error at_line(const std::string& file, int line, const std::string& what) {
    return input_error(fmt::format("{}:{}: {}", file, line, what));
}

/// Calls `take(words)` for every line with content; an error of it gets file and line.
template <typename Take>
Status for_each_row(std::string_view text,
                    const std::string& file,
                    std::size_t columns,
                    Take take) {
    LineReader lines(text);
    while (const auto line = lines.next()) {
        const std::vector<std::string_view> words = split(*line, " \t,");
        if (words.empty() || words[0].starts_with("#")) continue;
        if (words.size() != columns) {
            return at_line(file,
                           lines.number(),
                           fmt::format("{} numbers; {} belong in a line", words.size(), columns));
        }
        const std::string problem = take(words);
        if (!problem.empty()) return at_line(file, lines.number(), problem);
    }
    return {};
}

/// Finite numbers from words[first]...; the problem in words or an empty string.
std::string parse_numbers(const std::vector<std::string_view>& words,
                          std::size_t first,
                          std::vector<double>& out) {
    out.clear();
    for (std::size_t i = first; i < words.size(); ++i) {
        const auto value = parse_double(words[i]);
        if (!value || !std::isfinite(*value)) return quoted(words[i]) + " is not a finite number";
        out.push_back(*value);
    }
    return {};
}

std::string parse_stamp(std::string_view word, const std::int64_t* previous_ns, std::int64_t& out) {
    const auto time_ns = parse_seconds_as_ns(word);
    if (!time_ns) return fmt::format("stamp {} is not a time in seconds", quoted(word));
    if (previous_ns != nullptr && *time_ns <= *previous_ns) {
        return fmt::format("stamp {} s does not grow: {} s came before",
                           format_seconds(*time_ns),
                           format_seconds(*previous_ns));
    }
    out = *time_ns;
    return {};
}

}  // namespace

Result<Trajectory> parse_tum_trajectory(std::string_view text, const std::string& file) {
    Trajectory trajectory;
    std::vector<double> v;
    const Status status = for_each_row(text, file, 8, [&](const auto& words) -> std::string {
        StampedPose pose;
        const std::int64_t* previous_ns = trajectory.empty() ? nullptr : &trajectory.back().time_ns;
        if (auto problem = parse_stamp(words[0], previous_ns, pose.time_ns); !problem.empty()) {
            return problem;
        }
        if (auto problem = parse_numbers(words, 1, v); !problem.empty()) return problem;
        const Eigen::Quaterniond rotation(v[6], v[3], v[4], v[5]);
        if (std::abs(rotation.norm() - 1.0) > kNormTolerance) {
            return fmt::format("quaternion has length {:.4f}; it must be 1 +- {}",
                               rotation.norm(),
                               kNormTolerance);
        }
        pose.T_world_body = {rotation.normalized(), {v[0], v[1], v[2]}};
        trajectory.push_back(pose);
        return {};
    });
    if (!status) return status.error();
    if (trajectory.empty()) return input_error(file + ": no poses in this trajectory");
    return trajectory;
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

Result<std::vector<Pose>> parse_kitti_poses(std::string_view text, const std::string& file) {
    std::vector<Pose> poses;
    std::vector<double> v;
    const Status status = for_each_row(text, file, 12, [&](const auto& words) -> std::string {
        if (auto problem = parse_numbers(words, 0, v); !problem.empty()) return problem;
        Eigen::Matrix4d T_world_camera = Eigen::Matrix4d::Identity();
        for (Eigen::Index i = 0; i < 12; ++i) {
            T_world_camera(i / 4, i % 4) = v[static_cast<std::size_t>(i)];
        }
        const Eigen::Matrix3d R = T_world_camera.topLeftCorner<3, 3>();
        const double error =
            (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
        if (!(error < kRotationTolerance) || R.determinant() < 0.0) {
            return fmt::format("its left 3x3 is no rotation (R^T R differs from 1 by {:.3g})",
                               error);
        }
        poses.push_back(Pose::from_matrix(T_world_camera));
        return {};
    });
    if (!status) return status.error();
    if (poses.empty()) return input_error(file + ": no poses in this file");
    return poses;
}

Result<std::vector<std::int64_t>> parse_times(std::string_view text, const std::string& file) {
    std::vector<std::int64_t> times_ns;
    const Status status = for_each_row(text, file, 1, [&](const auto& words) -> std::string {
        std::int64_t time_ns = 0;
        std::string problem = parse_stamp(words[0], nullptr, time_ns);
        if (problem.empty() && time_ns < 0)
            problem = fmt::format("stamp {} s is negative", words[0]);
        if (problem.empty()) times_ns.push_back(time_ns);
        return problem;
    });
    if (!status) return status.error();
    return times_ns;
}

Result<Trajectory> read_tum_trajectory(const std::string& path) {
    const Result<std::string> text = read_file(path);
    if (!text) return text.error();
    return parse_tum_trajectory(*text, path);
}

Status write_tum_trajectory(const std::string& path, const Trajectory& trajectory) {
    return write_file(path, format_tum_trajectory(trajectory));
}

Result<std::vector<Pose>> read_kitti_poses(const std::string& path) {
    const Result<std::string> text = read_file(path);
    if (!text) return text.error();
    return parse_kitti_poses(*text, path);
}

Result<std::vector<std::int64_t>> read_times(const std::string& path) {
    const Result<std::string> text = read_file(path);
    if (!text) return text.error();
    return parse_times(*text, path);
}

Result<Trajectory> read_trajectory(const std::string& path) {
    const Result<std::string> text = read_file(path);
    if (!text) return text.error();
    std::size_t columns = 0;
    LineReader lines(*text);
    while (const auto line = lines.next()) {
        const auto words = split(*line, " \t,");
        if (words.empty() || words[0].starts_with("#")) continue;
        columns = words.size();
        break;
    }
    if (columns != 12) return parse_tum_trajectory(*text, path);
    const Result<std::vector<Pose>> poses = parse_kitti_poses(*text, path);
    if (!poses) return poses.error();
    std::vector<std::int64_t> times_ns;
    if (const std::string times = join_path(folder_of(path), "times.txt"); is_file(times)) {
        Result<std::vector<std::int64_t>> stamps = read_times(times);
        if (!stamps) return stamps.error();
        times_ns = std::move(stamps).value();
        if (times_ns.size() < poses->size()) {
            return input_error(fmt::format("{}: {} stamps for the {} poses of {}",
                                           times,
                                           times_ns.size(),
                                           poses->size(),
                                           path));
        }
    }
    Trajectory trajectory;
    for (std::size_t i = 0; i < poses->size(); ++i) {
        const auto index = static_cast<std::int64_t>(i);
        const std::int64_t time_ns = times_ns.empty() ? index * kKittiPeriod_ns : times_ns[i];
        if (!trajectory.empty() && time_ns <= trajectory.back().time_ns) {
            return input_error(
                fmt::format("{}: stamp {} of its times.txt does not grow", path, i + 1));
        }
        trajectory.push_back({time_ns, (*poses)[i]});
    }
    return trajectory;
}

}  // namespace surefoot::io
