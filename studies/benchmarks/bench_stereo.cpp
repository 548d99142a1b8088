// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <hwy/targets.h>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <thread>
#include <vector>

#include "service/console/source.hpp"
#include "studies/benchmarks/bench_result.hpp"
#include "studies/runs/run_output.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/pipeline/fine_depth.hpp"
#include "surefoot/stereo/matcher.hpp"
#include "surefoot/stereo/semi_global.hpp"

namespace surefoot::app {
namespace {

constexpr int kRepeats = 31;
constexpr double kGroundHeight_m = 0.95;  ///< of base_link in the demonstration scene

struct Work {
    const char* rig;
    int disparities;
    camera::RectifiedPair pair;
    [[nodiscard]] std::string name() const {
        return fmt::format("{}x{}/{}", pair.left.width(), pair.left.height(), disparities);
    }
};

/// Renders one pair of the demonstration scene and rectifies it, or only the part that the pipeline
/// matches at full size. The settings determine the noise.
Status see(const CommonOptions& common,
           const Settings& settings,
           bool only_fine_region,
           Executor& executor,
           Work& work) {
    SourceRequest request{"demo_stairs", work.rig, 0.0, 1, common.seed, settings.sim};
    auto source = open_simulation(request, executor);
    if (!source) return source.error();
    const auto frame = (*source)->next();
    if (!frame) return frame.error();
    const auto rectifier = camera::Rectifier::make((*source)->rig());
    if (!rectifier) return rectifier.error();
    if (!only_fine_region) {
        rectifier->rectify(**frame, work.pair);
        return {};
    }
    const camera::RectifiedRig& whole = rectifier->rig();
    const pipeline::FineConfig& fine = settings.pipeline.fine;
    work.disparities = pipeline::at_scale(settings.pipeline.stereo,
                                          pipeline::fine_scale(fine, whole.width, whole.height))
                           .disparities;
    const Pose T_odom_body{Eigen::Quaterniond::Identity(), {0.0, 0.0, kGroundHeight_m}};
    const camera::PixelBox box =
        pipeline::fine_region(fine, whole, T_odom_body, kGroundHeight_m, work.disparities);
    if (box.width == 0)
        return input_error(fmt::format(
            "stereo/fine: {} does not see the fine region; change fine.from_m and fine.to_m",
            work.rig));
    rectifier->rectify_part(**frame, box, work.pair);
    return {};
}

stereo::MatcherConfig config_of(const Work& work, const Settings& settings) {
    stereo::MatcherConfig config = settings.pipeline.stereo;
    config.disparities = work.disparities;
    return config;
}

BenchResult time_search(const Work& work, const std::string& what, Executor& executor) {
    stereo::SemiGlobalConfig config;
    config.disparities = work.disparities;
    stereo::SemiGlobalSearch search(config);
    stereo::Winners winners;
    const Timing timing = timed(kRepeats, [&] {
        search.search(work.pair.left.view(), work.pair.right.view(), executor, winners);
    });
    return {fmt::format("stereo/{}_{}", what, work.name()), timing};
}

BenchResult time_match(const Work& work,
                       const Settings& settings,
                       const std::string& what,
                       Executor& executor) {
    const auto matcher = stereo::make_census_matcher(config_of(work, settings));
    DepthImage depth;
    const Timing timing = timed(kRepeats, [&] {
        matcher->match(work.pair.left.view(), work.pair.right.view(), executor, depth);
    });
    return {fmt::format("stereo/{}_{}", what, work.name()), timing};
}

/// Times OpenCV's SGBM in three-way mode with its left-right check, uniqueness and speckle filter.
Timing opencv(const Work& work, const Settings& settings) {
    const auto image = [](const GreyImage& grey) {
        return cv::Mat(
            grey.height(), grey.width(), CV_8UC1, const_cast<std::uint8_t*>(grey.data()));
    };
    constexpr int kBlock = 3;
    const auto matcher = cv::StereoSGBM::create(0,
                                                work.disparities,
                                                kBlock,
                                                8 * kBlock * kBlock,
                                                32 * kBlock * kBlock,
                                                1,
                                                63,
                                                settings.pipeline.stereo.uniqueness_percent,
                                                100,
                                                2,
                                                cv::StereoSGBM::MODE_SGBM_3WAY);
    cv::Mat disparity;
    return timed(kRepeats, [&] {
        matcher->compute(image(work.pair.left), image(work.pair.right), disparity);
    });
}

/// Times two matchers that run on two threads without shared data. Half of this time is the lower
/// bound for one pair on two threads. The two matchers share only memory bandwidth and clock
/// frequency.
BenchResult time_two_copies(const Work& work, const Settings& settings) {
    const auto first = stereo::make_census_matcher(config_of(work, settings));
    const auto second = stereo::make_census_matcher(config_of(work, settings));
    Serial serial;
    DepthImage depths[2];
    const auto match = [&](stereo::Matcher& matcher, DepthImage& depth) {
        matcher.match(work.pair.left.view(), work.pair.right.view(), serial, depth);
    };
    Timing both = timed(kRepeats, [&] {
        std::thread other([&] { match(*second, depths[1]); });
        match(*first, depths[0]);
        other.join();
    });
    return {fmt::format("stereo/half_of_two_copies_{}", work.name()),
            {both.median_ms / 2.0,
             both.p99_ms / 2.0,
             *both.least_cpu_ms / 2.0,
             *both.median_cpu_ms / 2.0}};
}

}  // namespace

Result<std::vector<BenchResult>> bench_stereo(const CommonOptions& common, Executor& executor) {
    auto settings = load_settings(common);
    if (!settings) return settings.error();
    std::vector<BenchResult> results;
    for (Work work : {Work{"zed_vga", 64, {}}, Work{"zed_hd720", 128, {}}}) {
        if (auto status = see(common, *settings, false, executor, work); !status)
            return status.error();
        results.push_back(time_search(work, "search", executor));
        results.push_back(time_match(work, *settings, "match", executor));
        const std::size_t match = results.size() - 1;
        if (common.threads == 1) {
            hwy::SetSupportedTargetsForTest(HWY_AVX2 | HWY_SSE4 | HWY_SSSE3 | HWY_SCALAR);
            results.push_back(time_search(work, "search_avx2", executor));
            results.push_back(time_match(work, *settings, "match_avx2", executor));
            hwy::SetSupportedTargetsForTest(0);
        } else {
            Serial serial;
            results.push_back(time_match(work, *settings, "match_one_thread", serial));
            results.push_back(time_two_copies(work, *settings));
        }
        // OpenCV comes last, because its threads keep spinning for a while after their work.
        results[match].peer = opencv(work, *settings);
    }
    for (Work work : {Work{"zed_hd720", 0, {}}, Work{"zed_hd2k", 0, {}}}) {
        if (auto status = see(common, *settings, true, executor, work); !status)
            return status.error();
        results.push_back(time_match(work, *settings, "fine", executor));
        results.back().name = fmt::format("stereo/fine_region_of_{}", work.rig);
    }
    return results;
}

}  // namespace surefoot::app
