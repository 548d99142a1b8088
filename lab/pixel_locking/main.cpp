// SPDX-License-Identifier: Apache-2.0
// Does a matcher prefer whole pixels? The input is slanted planes, on which every fraction of a
// pixel is equally frequent.
// Usage: pixel_locking OUT.csv FIRST_SEED [SEEDS]     SEEDS: number of seeds, default 6
//
// Writes OUT.csv: camera,matcher,tenth,count,mean_px,rms_px: matched minus true disparity of
// matches within 1 px, by the fraction of the true disparity: 0 = whole pixels within 0.05 px, 5 =
// half pixels, 9 = just below a whole pixel. Cameras: "ideal", and "zed" with its noise and smear
// but without its calibration error, which would shift disparities. All matchers have default
// settings.
#include <fmt/format.h>
#include <fmt/os.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "lab/scenes/scene_cases.hpp"
#include "lab/stereo_pairs/rival_matchers.hpp"
#include "lab/stereo_pairs/stereo_pairs.hpp"
#include "service/console/log.hpp"

namespace surefoot::experiments {
namespace {

constexpr const char* kScenes[] = {"floor", "cross_fall"};
constexpr int kTenths = 10;
constexpr int kReach_px = 6;  ///< smallest half width of the plane around a counted pixel
constexpr float kFlatness_px = 1e-3F;
constexpr float kRight_px = 1.0F;

/// Returns true if the surface around a pixel is a plane: its disparities are linear in the image.
bool on_plane(const Image<float>& truth_px, int u, int v) {
    if (!truth_px.contains(u - kReach_px, v - kReach_px) ||
        !truth_px.contains(u + kReach_px, v + kReach_px))
        return false;
    const float twice_px = 2.0F * truth_px.at(u, v);
    const float bent_along = truth_px.at(u - kReach_px, v) + truth_px.at(u + kReach_px, v);
    const float bent_down = truth_px.at(u, v - kReach_px) + truth_px.at(u, v + kReach_px);
    return std::abs(bent_along - twice_px) < kFlatness_px &&
           std::abs(bent_down - twice_px) < kFlatness_px;
}

/// Errors by the fraction of the true disparity, in tenths of a pixel.
struct Locking {
    std::array<double, kTenths> count{};
    std::array<double, kTenths> sum_px{};
    std::array<double, kTenths> sum_px2{};

    void add(double truth_px, double error_px) {
        const double fraction = truth_px - std::floor(truth_px);
        const auto tenth = static_cast<std::size_t>(std::lround(fraction * kTenths) % kTenths);
        ++count[tenth];
        sum_px[tenth] += error_px;
        sum_px2[tenth] += error_px * error_px;
    }
    void add(const TruePair& pair, const Image<float>& disparity_px) {
        for (int v = 0; v < disparity_px.height(); ++v) {
            for (int u = 0; u < disparity_px.width(); ++u) {
                const float truth_px = pair.truth_px.at(u, v);
                const float error_px = disparity_px.at(u, v) - truth_px;
                // Also skips pixels whose true or matched disparity is unknown, because comparisons
                // with NaN are false.
                if (!(std::abs(error_px) <= kRight_px) || !on_plane(pair.truth_px, u, v)) continue;
                add(static_cast<double>(truth_px), static_cast<double>(error_px));
            }
        }
    }
    void print(fmt::ostream& out, const char* camera, const std::string& matcher) const {
        for (std::size_t k = 0; k < count.size(); ++k)
            out.print("{},{},{},{},{:.5f},{:.5f}\n",
                      camera,
                      matcher,
                      k,
                      count[k],
                      sum_px[k] / count[k],
                      std::sqrt(sum_px2[k] / count[k]));
    }
};

Result<std::vector<TruePair>> floors(const char* profile, std::uint64_t first_seed, int seeds) {
    std::vector<TruePair> pairs;
    pairs.reserve(std::size(kScenes) * static_cast<std::size_t>(seeds));
    for (const char* scene : kScenes) {
        for (int k = 0; k < seeds; ++k) {
            sim::SceneOptions options;
            const SceneCase wanted{scene, first_seed + static_cast<std::uint64_t>(k), profile};
            if (auto set = wanted.put_into(options); !set) return set.error();
            auto pair = simulated_pair(options);
            if (!pair) return pair.error();
            forget_hidden(*pair);
            pairs.push_back(std::move(*pair));
        }
    }
    return pairs;
}

Status run(const std::string& file, std::uint64_t first_seed, int seeds) {
    auto out = fmt::output_file(file);
    out.print("camera,matcher,tenth,count,mean_px,rms_px\n");
    for (const auto& [camera, profile] :
         {std::pair{"ideal", "ideal"}, std::pair{"zed", "zed_calibrated"}}) {
        const auto pairs = floors(profile, first_seed, seeds);
        if (!pairs) return pairs.error();
        std::vector<Candidate> matchers = candidates();
        matchers.push_back({"our trusted matches", trusted_chain(), {}});
        for (const Candidate& candidate : matchers) {
            Locking locking;
            for (const TruePair& pair : *pairs) locking.add(pair, candidate.as_it_comes(pair));
            locking.print(out, camera, candidate.name);
        }
    }
    return {};
}

}  // namespace
}  // namespace surefoot::experiments

// An uncaught exception ends the experiment and prints its message. This is intended.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    using namespace surefoot;
    if (argc < 3) {
        fmt::print(stderr, "usage: pixel_locking OUT.csv FIRST_SEED [SEEDS]\n");
        return 2;
    }
    cv::setNumThreads(1);
    const auto done = experiments::run(
        argv[1], std::strtoull(argv[2], nullptr, 10), argc > 3 ? std::atoi(argv[3]) : 6);
    return done ? 0 : app::report(done.error());
}
