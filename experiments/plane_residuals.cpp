// SPDX-License-Identifier: Apache-2.0
// How good are disparities on what is locally flat, as a function of the texture there? The same
// question put to real recordings and to simulated ones closes the reality gap.
// Usage: plane_residuals SOURCE OUT.csv [MAX_FRAMES [KEY=VALUE...]]
//   KEY=VALUE: stereo.* = settings of the matcher; for sim:SCENE sources also seed and the settings
//   of the simulated camera (see sim::SceneOptions).
//
// Windows of 32 x 32 px of the rectified left image. For each: horizontal gradient of the grey
// values (texture), share of matched pixels (density), scatter of the disparity about the robustly
// fitted plane. A line a window: frame, u, v, texture_dn, grey_dn, density, residual_px, inliers.
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

#include "apps/surefoot/log.hpp"
#include "apps/surefoot/settings.hpp"
#include "apps/surefoot/source.hpp"
#include "io/config_yaml.hpp"
#include "sim/scene_source.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/stereo/matcher.hpp"

namespace surefoot {
namespace {

constexpr int kWindow_px = 32;
constexpr std::string_view kStereo = "stereo.";

struct Window {
    double texture_dn = 0.0;
    double grey_dn = 0.0;
    double density = 0.0;
    double residual_px = 0.0;  ///< 1.4826 median |residual|: one sigma of a normal scatter
    double inliers = 0.0;      ///< share of the matched pixels within 3 sigma
};

/// Root mean square of the horizontal difference between pixels `reach` to either side, per pixel.
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

/// Plane d = a u + b v + c by five rounds of least squares on the points within 3 sigma of the
/// last.
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
    Eigen::Vector3d plane = Eigen::Vector3d::Zero();
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
    return window;
}

Result<std::unique_ptr<camera::FrameSource>> open(const std::string& source,
                                                  int max_frames,
                                                  const std::vector<std::string>& settings,
                                                  Executor& executor) {
    if (!source.starts_with("sim:"))
        return app::open_source({source, "", 0.0, max_frames, 1}, executor);
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

int run(const std::string& name,
        const std::string& out,
        int max_frames,
        const std::vector<std::string>& settings) {
    const auto executor = app::make_executor({});
    auto source = open(name, max_frames, settings, *executor);
    if (!source) return app::report(source.error());
    const auto rectifier = camera::Rectifier::make((*source)->rig());
    if (!rectifier) return app::report(rectifier.error());
    const auto matching = matcher_config(settings);
    if (!matching) return app::report(matching.error());
    const auto matcher = stereo::make_matcher(*matching);
    camera::RectifiedPair pair;
    camera::DepthImage depth;
    auto file = fmt::output_file(out);
    file.print("frame,u,v,texture_dn,coarse_dn,grey_dn,density,residual_px,inliers\n");
    for (int frame = 0;; ++frame) {
        const auto next = (*source)->next();
        if (!next) return app::report(next.error());
        if (!next->has_value()) break;
        rectifier->rectify(**next, pair);
        matcher->match(pair.left.view(), pair.right.view(), *executor, depth);
        // The left strip of the image is not seen by the right eye.
        for (int v = 8; v + kWindow_px + 8 <= pair.left.height(); v += kWindow_px) {
            for (int u = 72; u + kWindow_px + 8 <= pair.left.width(); u += kWindow_px) {
                Window window = fit(depth.disparity_px, u, v);
                double grey = 0.0;
                for (int y = v; y < v + kWindow_px; ++y)
                    for (int x = u; x < u + kWindow_px; ++x) grey += pair.left.at(x, y);
                file.print("{},{},{},{:.3f},{:.3f},{:.1f},{:.4f},{:.4f},{:.4f}\n",
                           frame,
                           u,
                           v,
                           texture_of(pair.left, u, v, 1),
                           texture_of(pair.left, u, v, 4),
                           grey / (kWindow_px * kWindow_px),
                           window.density,
                           window.residual_px,
                           window.inliers);
            }
        }
    }
    return 0;
}

}  // namespace
}  // namespace surefoot

// An exception ends an experiment with its message, as it should.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    if (argc < 3) {
        fmt::print(stderr, "usage: plane_residuals SOURCE OUT.csv [MAX_FRAMES [KEY=VALUE...]]\n");
        return 2;
    }
    const int max_frames = argc > 3 ? std::atoi(argv[3]) : 0;
    return surefoot::run(argv[1], argv[2], max_frames, {argv + std::min(argc, 4), argv + argc});
}
