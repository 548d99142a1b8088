// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "surefoot/core/time.hpp"
#include "surefoot/odometry/recordings_testing.hpp"

namespace surefoot::odometry::testing {
namespace {

GreyImage to_image(const cv::Mat& grey) {
    GreyImage image(grey.cols, grey.rows);
    for (int v = 0; v < grey.rows; ++v)
        std::copy_n(grey.ptr<std::uint8_t>(v), grey.cols, image.row(v));
    return image;
}

camera::Camera pinhole(int width, int height, double fx, double fy, double cx, double cy) {
    camera::PinholeRadTan model;
    model.fx_px = fx;
    model.fy_px = fy;
    model.cx_px = cx;
    model.cy_px = cy;
    return {model, width, height};
}

camera::StereoRig rectified_rig(const camera::Camera& this_camera, double baseline_m) {
    camera::StereoRig rig;
    rig.left = this_camera;
    rig.right = this_camera;
    rig.T_left_right.translation_m = {baseline_m, 0.0, 0.0};
    rig.rectified = true;
    return rig;
}

std::vector<std::string> sorted_files(const std::string& folder) {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ".png") files.push_back(entry.path().string());
    std::sort(files.begin(), files.end());
    return files;
}

std::optional<Recording> pair_folders(const std::string& left,
                                      const std::string& right,
                                      std::function<std::int64_t(int, const std::string&)> stamp) {
    if (!std::filesystem::is_directory(left) || !std::filesystem::is_directory(right))
        return std::nullopt;
    Recording recording;
    const auto left_files = sorted_files(left);
    const auto right_files = sorted_files(right);
    recording.frames = static_cast<int>(std::min(left_files.size(), right_files.size()));
    recording.frame = [=](int index) {
        const auto i = static_cast<std::size_t>(index);
        StereoFrame frame;
        frame.index = index;
        frame.time_ns = stamp(index, std::filesystem::path(left_files[i]).stem().string());
        frame.left = to_image(cv::imread(left_files[i], cv::IMREAD_GRAYSCALE));
        frame.right = to_image(cv::imread(right_files[i], cv::IMREAD_GRAYSCALE));
        return frame;
    };
    return recording;
}

std::optional<Recording> euroc_layout(const std::string& folder) {
    auto recording = pair_folders(folder + "/mav0/cam0/data",
                                  folder + "/mav0/cam1/data",
                                  [](int, const std::string& stem) { return std::stoll(stem); });
    if (recording) recording->rig = euroc_rig();
    return recording;
}

}  // namespace

std::string data_folder() {
    const char* folder = std::getenv("SUREFOOT_DATA_DIR");
    return folder != nullptr ? folder : SUREFOOT_DEFAULT_DATA_DIR;
}

camera::StereoRig euroc_rig() {
    const auto this_camera =
        [](double fx, double fy, double cx, double cy, double k1, double k2, double p1, double p2) {
            camera::Camera camera = pinhole(752, 480, fx, fy, cx, cy);
            auto& model = std::get<camera::PinholeRadTan>(camera.model);
            model.k1 = k1;
            model.k2 = k2;
            model.p1 = p1;
            model.p2 = p2;
            return camera;
        };
    Eigen::Matrix4d left;
    Eigen::Matrix4d right;
    left << 0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975,  //
        0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768,          //
        -0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949, 0.0, 0.0, 0.0, 1.0;
    right << 0.0125552670891, -0.999755099723, 0.0182237714554, -0.0198435579556,  //
        0.999598781151, 0.0130119051815, 0.0251588363115, 0.0453689425024,         //
        -0.0253898008918, 0.0179005838253, 0.999517347078, 0.00786212447038, 0.0, 0.0, 0.0, 1.0;
    camera::StereoRig rig;
    rig.left = this_camera(
        458.654, 457.296, 367.215, 248.375, -0.28340811, 0.07395907, 0.00019359, 1.76187114e-05);
    rig.right = this_camera(
        457.587, 456.134, 379.999, 255.238, -0.28368365, 0.07451284, -0.00010473, -3.555e-05);
    rig.T_body_left = Pose::from_matrix(left);
    rig.T_left_right = rig.T_body_left->inverse() * Pose::from_matrix(right);
    rig.imu = camera::ImuMount{Pose{}, 200.0};
    rig.rate_hz = 20.0;
    return rig;
}

std::vector<ImuSample> read_imu(const std::string& path) {
    std::vector<ImuSample> imu;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream fields(line);
        ImuSample s;
        auto& w = s.angular_velocity_rad_s;
        auto& a = s.specific_force_m_s2;
        fields >> s.time_ns >> w.x() >> w.y() >> w.z() >> a.x() >> a.y() >> a.z();
        imu.push_back(s);
    }
    return imu;
}

std::vector<ImuSample> samples_between(const std::vector<ImuSample>& imu,
                                       std::int64_t after_ns,
                                       std::int64_t until_ns) {
    const auto first = std::ranges::upper_bound(imu, after_ns, {}, &ImuSample::time_ns);
    return {first, std::ranges::upper_bound(first, imu.end(), until_ns, {}, &ImuSample::time_ns)};
}

Trajectory read_tum(const std::string& path) {
    Trajectory poses;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        if (line.empty() || line[0] == '#') continue;
        std::istringstream fields(line);
        double stamp_s = 0.0;
        Eigen::Vector3d t;
        Eigen::Vector4d q;
        fields >> stamp_s >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w();
        poses.push_back({ns_from_seconds(stamp_s), {Eigen::Quaterniond(q).normalized(), t}});
    }
    return poses;
}

std::optional<Recording> kitti_city() {
    const std::string folder = data_folder() + "/sequences/kitti_city";
    auto recording =
        pair_folders(folder + "/image_0", folder + "/image_1", [](int index, const std::string&) {
            return index * 100'000'000LL;
        });
    if (!recording) return recording;
    recording->rig = rectified_rig(pinhole(1226, 370, 707.0912, 707.0912, 601.8873, 183.1104),
                                   379.8145 / 707.0912);
    std::ifstream poses(folder + "/poses.txt");
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    while (true) {
        for (int i = 0; i < 12; ++i) poses >> T(i / 4, i % 4);
        if (!poses) break;
        recording->T_world_camera.push_back(Pose::from_matrix(T));
    }
    return recording;
}

std::optional<Recording> zed_office() {
    const std::string folder = data_folder() + "/sequences/zed_office";
    if (!std::filesystem::is_directory(folder)) return std::nullopt;
    Recording recording;
    recording.rig = rectified_rig(pinhole(672, 376, 350.0, 350.0, 336.0, 188.0), 0.12);
    recording.frames = 8;
    recording.frame = [folder](int index) {
        const std::string path = folder + "/ZED_image" + std::to_string(index + 1) + ".png";
        const cv::Mat both = cv::imread(path, cv::IMREAD_GRAYSCALE);
        StereoFrame frame;
        frame.index = index;
        frame.time_ns = index * 500'000'000LL;
        frame.left = to_image(both.colRange(0, both.cols / 2));
        frame.right = to_image(both.colRange(both.cols / 2, both.cols));
        return frame;
    };
    return recording;
}

std::optional<Recording> euroc_still() {
    return euroc_layout(data_folder() + "/sequences/euroc_still");
}

std::optional<Recording> rendered_room(const std::string& folder) {
    auto recording = euroc_layout(folder);
    if (!recording) return recording;
    for (const StampedPose& pose : read_tum(folder + "/groundtruth.tum"))
        recording->T_world_camera.push_back(pose.T_world_body);
    // Frames must be requested in order.
    recording->frame = [frame = recording->frame,
                        imu = read_imu(folder + "/mav0/imu0/data.csv"),
                        before_ns = std::int64_t{0}](int index) mutable {
        StereoFrame f = frame(index);
        f.imu = samples_between(imu, index == 0 ? f.time_ns - 50'000'000 : before_ns, f.time_ns);
        before_ns = f.time_ns;
        return f;
    };
    return recording;
}

double aligned_rmse_m(const std::vector<Eigen::Vector3d>& estimate,
                      const std::vector<Eigen::Vector3d>& truth) {
    const auto n = static_cast<Eigen::Index>(estimate.size());
    Eigen::Matrix3Xd a(3, n);
    Eigen::Matrix3Xd b(3, n);
    for (Eigen::Index i = 0; i < n; ++i) {
        a.col(i) = estimate[static_cast<std::size_t>(i)];
        b.col(i) = truth[static_cast<std::size_t>(i)];
    }
    const Eigen::Matrix4d T = Eigen::umeyama(a, b, false);
    const Eigen::Matrix3Xd moved =
        (T.topLeftCorner<3, 3>() * a).colwise() + T.topRightCorner<3, 1>();
    return std::sqrt((moved - b).squaredNorm() / static_cast<double>(n));
}

}  // namespace surefoot::odometry::testing
