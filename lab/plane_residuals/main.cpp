// SPDX-License-Identifier: Apache-2.0
// How accurate are disparities on locally flat surfaces, as a function of texture? The same
// statistic of real and of simulated recordings shows how realistic the simulator is.
// Usage: plane_residuals SOURCE OUT.csv [MAX_FRAMES [KEY=VALUE...]]
//   MAX_FRAMES: 0 (default) = all. KEY=VALUE: stereo.* = settings of the matcher; for sim:SCENE
//   sources also seed and the settings of the simulated camera (sim::SceneOptions).
//
// Writes OUT.csv, one line per window of 32 x 32 px of the rectified left image: frame, u, v,
// texture_dn (horizontal gradient of the grey values), coarse_dn, grey_dn, density (share of
// matched pixels), residual_px (scatter of the disparity about the robustly fitted plane), rms_px,
// inliers, cameras_dn (difference of the two images after alignment by that plane).
#include <fmt/format.h>
#include <fmt/os.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/camera/rectifier.hpp"
#include "surefoot/io/recordings/recording.hpp"
#include "surefoot/io/settings/config_yaml.hpp"
#include "surefoot/sim/scene_source.hpp"
#include "surefoot/stereo/matcher.hpp"

namespace surefoot {
namespace {

constexpr int kWindow_px = 32;
constexpr std::string_view kStereo = "stereo.";

struct Window {
    double texture_dn = 0.0;
    double grey_dn = 0.0;
    double density = 0.0;
    double residual_px = 0.0;  ///< 1.4826 median |residual| = one sigma of a normal scatter
    double rms_px = 0.0;       ///< rms over all matched pixels, with outliers
    double inliers = 0.0;      ///< share of the matched pixels within 3 sigma
    /// Disparity [px] = plane . (u, v, 1), with u and v from the first pixel of the window.
    Eigen::Vector3d plane = Eigen::Vector3d::Zero();
    std::vector<double> departure_px;  ///< disparity minus plane; NaN = no match or outlier
};

/// Returns the rms horizontal gradient of the grey values: difference of the pixels `reach` to the
/// left and right, divided by their distance.
double texture_of(const GreyImage& image, int u0, int v0, int reach) {
    double sum = 0.0;
    for (int v = v0; v < v0 + kWindow_px; ++v) {
        for (int u = u0; u < u0 + kWindow_px; ++u) {
            const double step = (image.at(u + reach, v) - image.at(u - reach, v)) / (2.0 * reach);
            sum += step * step;
        }
    }
    return std::sqrt(sum / (kWindow_px * kWindow_px));
}

/// Fits the plane d = a u + b v + c in five rounds of least squares. Each round uses the points
/// within 3 sigma of the plane of the previous round.
Window fit(const Image<float>& disparity_px, int u0, int v0) {
    std::vector<Eigen::Vector3d> places;
    std::vector<double> values;
    for (int v = 0; v < kWindow_px; ++v) {
        for (int u = 0; u < kWindow_px; ++u) {
            const float d = disparity_px.at(u0 + u, v0 + v);
            if (!(d > 0.0F)) continue;
            places.emplace_back(u, v, 1.0);
            values.push_back(static_cast<double>(d));
        }
    }
    Window window;
    window.density =
        static_cast<double>(values.size()) / static_cast<double>(kWindow_px * kWindow_px);
    if (values.size() < 50) return window;
    double limit_px = 1e9;
    Eigen::Vector3d& plane = window.plane;
    for (int round = 0; round < 5; ++round) {
        Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
        Eigen::Vector3d b = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (std::abs(places[i].dot(plane) - values[i]) > limit_px) continue;
            A += places[i] * places[i].transpose();
            b += places[i] * values[i];
        }
        plane = A.ldlt().solve(b);
        std::vector<double> residuals;
        for (std::size_t i = 0; i < values.size(); ++i)
            residuals.push_back(std::abs(places[i].dot(plane) - values[i]));
        std::vector<double> sorted = residuals;
        const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
        std::nth_element(sorted.begin(), middle, sorted.end());
        window.residual_px = 1.4826 * *middle;
        limit_px = std::max(3.0 * window.residual_px, 0.05);
        const auto in = std::count_if(
            residuals.begin(), residuals.end(), [&](double r) { return r <= limit_px; });
        window.inliers = static_cast<double>(in) / static_cast<double>(residuals.size());
    }
    window.departure_px.assign(kWindow_px * kWindow_px, std::nan(""));
    double sum_sq = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double departure_px = values[i] - places[i].dot(plane);
        sum_sq += departure_px * departure_px;
        if (std::abs(departure_px) > limit_px) continue;
        window.departure_px[static_cast<std::size_t>(places[i].y() * kWindow_px + places[i].x())] =
            departure_px;
    }
    window.rms_px = std::sqrt(sum_sq / static_cast<double>(values.size()));
    return window;
}

/// Returns one sigma [dn] of the difference between both cameras. The images are first aligned by
/// the plane of the window and corrected in gain and offset. The matcher does not affect this image
/// noise. NaN = the right camera does not see the whole window.
double camera_difference_of(const camera::RectifiedPair& pair,
                            const Window& window,
                            int u0,
                            int v0) {
    std::vector<double> differences;
    Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
    Eigen::Vector2d b = Eigen::Vector2d::Zero();
    std::vector<Eigen::Vector2d> greys;  // right, left
    for (int v = 0; v < kWindow_px; ++v) {
        for (int u = 0; u < kWindow_px; ++u) {
            const double place = u0 + u - window.plane.dot(Eigen::Vector3d(u, v, 1.0));
            const int left = static_cast<int>(std::floor(place));
            if (!(place >= 0.0) || left + 1 >= pair.right.width()) return std::nan("");
            const double share = place - left;
            const double right = (1.0 - share) * pair.right.at(left, v0 + v) +
                                 share * pair.right.at(left + 1, v0 + v);
            const Eigen::Vector2d row(right, 1.0);
            greys.emplace_back(right, pair.left.at(u0 + u, v0 + v));
            A += row * row.transpose();
            b += row * greys.back().y();
        }
    }
    const Eigen::Vector2d gain = A.ldlt().solve(b);
    differences.reserve(differences.size() + greys.size());
    for (const Eigen::Vector2d& grey : greys)
        differences.push_back(std::abs(grey.y() - gain.x() * grey.x() - gain.y()));
    const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
    std::nth_element(differences.begin(), middle, differences.end());
    return 1.4826 * *middle;
}

/// Correlation of the departures from the plane at the same pixel in consecutive frames. If the
/// camera or the scene has moved, only a fixed error of the lens or its rectification repeats.
class Repetition {
  public:
    void add(const Window& before, const Window& now) {
        if (!is_even(before) || !is_even(now)) return;
        ++windows_;
        for (std::size_t i = 0; i < now.departure_px.size(); ++i) {
            const double a = before.departure_px[i];
            const double b = now.departure_px[i];
            if (std::isnan(a) || std::isnan(b)) continue;
            both_ += a * b;
            first_ += a * a;
            second_ += b * b;
        }
    }
    void print() const {
        if (windows_ == 0) return;
        fmt::print(
            "departures at the same pixel in the next frame: correlation {:.3f}, {} windows\n",
            both_ / std::sqrt(first_ * second_),
            windows_);
    }

  private:
    static bool is_even(const Window& window) {
        constexpr double kEven_px = 0.4;  // largest scatter that is not clutter
        return window.density > 0.8 && window.residual_px < kEven_px;
    }
    int windows_ = 0;
    double both_ = 0.0;
    double first_ = 0.0;
    double second_ = 0.0;
};

Result<std::unique_ptr<camera::FrameSource>> open(const std::string& source,
                                                  int max_frames,
                                                  const std::vector<std::string>& settings,
                                                  Executor& executor) {
    if (!source.starts_with("sim:")) return io::open_source(source);
    sim::SceneOptions options;
    options.scene = source.substr(4);
    options.frames = max_frames;
    for (const std::string& setting : settings) {
        if (setting.starts_with(kStereo)) continue;
        if (setting.starts_with("seed=")) {
            options.seed = std::strtoull(setting.c_str() + 5, nullptr, 10);
            continue;
        }
        if (auto status = io::override_config(setting, io::describe_config(options)); !status)
            return status.error();
    }
    auto scene = sim::open_scene(options, &executor);
    if (!scene) return scene.error();
    return std::unique_ptr<camera::FrameSource>(std::move(scene).value());
}

Result<stereo::MatcherConfig> matcher_config(const std::vector<std::string>& settings) {
    stereo::MatcherConfig config;
    for (const std::string& setting : settings) {
        if (!setting.starts_with(kStereo)) continue;
        const std::string own = setting.substr(kStereo.size());
        if (auto status = io::override_config(own, io::describe_config(config)); !status)
            return status.error();
    }
    if (const auto wrong = config.problem()) return usage_error(*wrong);
    return config;
}

int failed(const Error& error) {
    fmt::print(stderr, "plane_residuals: {}\n", error.message);
    return 1;
}

int run(const std::string& name,
        const std::string& out,
        int max_frames,
        const std::vector<std::string>& settings) {
    Serial executor;
    auto source = open(name, max_frames, settings, executor);
    if (!source) return failed(source.error());
    const auto rectifier = camera::Rectifier::make((*source)->rig());
    if (!rectifier) return failed(rectifier.error());
    const auto matching = matcher_config(settings);
    if (!matching) return failed(matching.error());
    const auto matcher = stereo::make_matcher(*matching);
    camera::RectifiedPair pair;
    DepthImage depth;
    auto file = fmt::output_file(out);
    file.print(
        "frame,u,v,texture_dn,coarse_dn,grey_dn,density,residual_px,rms_px,inliers,cameras_dn\n");
    std::vector<Window> before;
    Repetition repetition;
    for (int frame = 0; max_frames == 0 || frame < max_frames; ++frame) {
        const auto next = (*source)->next();
        if (!next) return failed(next.error());
        if (!next->has_value()) break;
        rectifier->rectify(**next, pair);
        matcher->match(pair.left.view(), pair.right.view(), executor, depth);
        std::vector<Window> windows;
        // The right camera does not see the left strip of the image.
        for (int v = 8; v + kWindow_px + 8 <= pair.left.height(); v += kWindow_px) {
            for (int u = 72; u + kWindow_px + 8 <= pair.left.width(); u += kWindow_px) {
                const Window window = fit(depth.disparity_px, u, v);
                double grey = 0.0;
                for (int y = v; y < v + kWindow_px; ++y)
                    for (int x = u; x < u + kWindow_px; ++x) grey += pair.left.at(x, y);
                file.print("{},{},{},{:.3f},{:.3f},{:.1f},{:.4f},{:.4f},{:.4f},{:.4f},{:.3f}\n",
                           frame,
                           u,
                           v,
                           texture_of(pair.left, u, v, 1),
                           texture_of(pair.left, u, v, 4),
                           grey / (kWindow_px * kWindow_px),
                           window.density,
                           window.residual_px,
                           window.rms_px,
                           window.inliers,
                           camera_difference_of(pair, window, u, v));
                if (!before.empty()) repetition.add(before[windows.size()], window);
                windows.push_back(window);
            }
        }
        before = std::move(windows);
    }
    repetition.print();
    return 0;
}

}  // namespace
}  // namespace surefoot

// An uncaught exception ends the experiment and prints its message. This is intended.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    if (argc < 3) {
        fmt::print(stderr, "usage: plane_residuals SOURCE OUT.csv [MAX_FRAMES [KEY=VALUE...]]\n");
        return 2;
    }
    const int max_frames = argc > 3 ? std::atoi(argv[3]) : 0;
    return surefoot::run(argv[1], argv[2], max_frames, {argv + std::min(argc, 4), argv + argc});
}
