// SPDX-License-Identifier: Apache-2.0
// Reads the corners of euroc_april out of their archive.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <sstream>

#include "surefoot/odometry/recordings_testing.hpp"

namespace surefoot::odometry::testing {
namespace {

/// Observed corners by stamp [ns] and id.
using Corners = std::map<std::int64_t, std::map<std::int64_t, Eigen::Vector2d>>;

std::string output_of(const std::string& command) {
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), &pclose);
    std::string text;
    std::array<char, 1 << 16> block{};
    while (pipe) {
        const std::size_t n = std::fread(block.data(), 1, block.size(), pipe.get());
        if (n == 0) break;
        text.append(block.data(), n);
    }
    return text;
}

/// Reads all files cam0/STAMP.csv. Files of frames without a corner have no rows.
std::set<std::int64_t> frame_stamps(const std::string& archive) {
    std::set<std::int64_t> stamps;
    std::istringstream names(output_of("tar -tJf '" + archive + "' cam0"));
    for (std::string name; std::getline(names, name);)
        if (name.ends_with(".csv")) stamps.insert(std::stoll(name.substr(name.find('/') + 1)));
    return stamps;
}

/// Rows of ts, tag_rows, tag_cols, tag_size, tag_spacing, kp_x, kp_y, p_x, p_y, p_z, tag_id,
/// corner_idx. The points' positions on the grid (p) are not used.
Corners read_corners(const std::string& archive, const char* camera) {
    Corners corners;
    std::istringstream rows(output_of("tar -xJOf '" + archive + "' " + camera));
    for (std::string row; std::getline(rows, row);) {
        if (row.empty() || row[0] == '#') continue;
        std::replace(row.begin(), row.end(), ',', ' ');
        std::istringstream fields(row);
        std::int64_t time_ns = 0;
        double skipped = 0.0;
        Eigen::Vector2d px;
        std::int64_t tag = 0;
        std::int64_t corner = 0;
        fields >> time_ns >> skipped >> skipped >> skipped >> skipped >> px.x() >> px.y();
        fields >> skipped >> skipped >> skipped >> tag >> corner;
        corners[time_ns][4 * tag + corner] = px;
    }
    return corners;
}

/// The pose within half a millisecond, because the stamps of the file are rounded.
std::optional<Pose> pose_at(const Trajectory& truth, std::int64_t time_ns) {
    constexpr std::int64_t kTolerance_ns = 500'000;
    const auto it =
        std::ranges::lower_bound(truth, time_ns - kTolerance_ns, {}, &StampedPose::time_ns);
    if (it == truth.end() || it->time_ns > time_ns + kTolerance_ns) return std::nullopt;
    return it->T_world_body;
}

}  // namespace

std::optional<PointRecording> euroc_april() {
    const std::string folder = data_folder() + "/sequences/euroc_april";
    const std::string archive = folder + "/corners.tar.xz";
    if (!std::filesystem::exists(archive)) return std::nullopt;
    Corners left = read_corners(archive, "cam0");
    Corners right = read_corners(archive, "cam1");
    if (left.empty() || right.empty()) return std::nullopt;
    const auto imu = read_imu(folder + "/imu0.csv");
    const Trajectory truth = read_tum(folder + "/gt_cam0_in_target_pnp.tum");
    PointRecording recording;
    recording.rig = euroc_rig();
    std::int64_t before_ns = std::numeric_limits<std::int64_t>::min();
    for (const std::int64_t time_ns : frame_stamps(archive)) {
        PointFrame frame;
        frame.time_ns = time_ns;
        frame.imu = samples_between(imu, before_ns, time_ns);
        for (const auto& [id, px] : left[time_ns]) {
            SeenPoint point{id, px, std::nullopt};
            if (const auto it = right[time_ns].find(id); it != right[time_ns].end())
                point.raw_right_px = it->second;
            frame.points.push_back(point);
        }
        recording.frames.push_back(std::move(frame));
        recording.T_world_camera.push_back(pose_at(truth, time_ns));
        before_ns = time_ns;
    }
    return recording;
}

}  // namespace surefoot::odometry::testing
