// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/matcher.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "surefoot/core/executors_testing.hpp"
#include "surefoot/stereo/confidence.hpp"
#include "surefoot/stereo/scene_testing.hpp"

namespace surefoot::stereo {
namespace {

DepthImage match(const GreyImage& left, const GreyImage& right, const MatcherConfig& config = {}) {
    Serial serial;
    DepthImage depth;
    make_matcher(config)->match(left.view(), right.view(), serial, depth);
    return depth;
}

/// Steps of 0.18 m, a kerb and a table on a floor, seen from a walking machine.
const test::SyntheticPair& scene() {
    static const test::SyntheticPair pair = [] {
        test::SceneConfig config;
        config.seed = 77;
        config.contrast_grey = 4.0;
        config.boxes = {{{1.0, -0.5, 0.0}, {1.4, 0.1, 0.18}},
                        {{1.4, -0.5, 0.0}, {1.8, 0.1, 0.36}},
                        {{1.5, 0.3, 0.0}, {2.1, 0.9, 0.10}}};
        return test::Scene(config).render();
    }();
    return pair;
}

/// Rotates an image by 180 degrees.
template <typename T>
void flip(Image<T>& image) {
    for (int v = 0; v < image.height() / 2; ++v)
        std::swap_ranges(
            image.row(v), image.row(v) + image.width(), image.row(image.height() - 1 - v));
}

struct Score {
    double density = 0.0;
    double bad_1 = 0.0;
    double bad_2 = 0.0;
    double rms_px = 0.0;   ///< rms of errors below 1 px
    double mean_px = 0.0;  ///< mean of errors below 1 px
    double within_3_sigma = 0.0;
};

/// Uses pixels with known truth (hidden ones have none) that `use`, if given, accepts.
template <typename Use>
Score score(const Image<float>& disparity_px,
            const Image<float>* sigma_px,
            const Image<float>& truth_px,
            Use use) {
    Score s;
    double all = 0, known = 0, good = 0, sum = 0, sum_sq = 0;
    for (int v = 0; v < truth_px.height(); ++v) {
        for (int u = 0; u < truth_px.width(); ++u) {
            if (std::isnan(truth_px.at(u, v)) || !use(u, v)) continue;
            ++all;
            const double error = static_cast<double>(disparity_px.at(u, v) - truth_px.at(u, v));
            if (std::isnan(error)) continue;
            ++known;
            s.bad_1 += std::abs(error) > 1.0;
            s.bad_2 += std::abs(error) > 2.0;
            if (sigma_px != nullptr) {
                s.within_3_sigma +=
                    std::abs(error) <= 3.0 * static_cast<double>(sigma_px->at(u, v));
            }
            if (std::abs(error) > 1.0) continue;
            ++good;
            sum += error;
            sum_sq += error * error;
        }
    }
    s.density = known / all;
    s.bad_1 /= known;
    s.bad_2 /= known;
    s.within_3_sigma /= known;
    s.mean_px = sum / good;
    s.rms_px = std::sqrt(sum_sq / good);
    return s;
}

/// OpenCV's result with the same settings, without our steps.
Image<float> plain_sgbm(const GreyImage& left, const GreyImage& right, int disparities) {
    const auto padded = [&](const GreyImage& image) {
        const cv::Mat m(
            image.height(), image.width(), CV_8UC1, const_cast<std::uint8_t*>(image.data()));
        cv::Mat out;
        cv::copyMakeBorder(m, out, 0, 0, disparities, 0, cv::BORDER_REPLICATE);
        return out;
    };
    cv::Mat steps;
    cv::StereoSGBM::create(
        0, disparities, 3, 72, 288, 1, 63, 10, 100, 2, cv::StereoSGBM::MODE_SGBM_3WAY)
        ->compute(padded(left), padded(right), steps);
    Image<float> disparity_px(left.width(), left.height(), std::numeric_limits<float>::quiet_NaN());
    for (int v = 0; v < left.height(); ++v) {
        for (int u = 0; u < left.width(); ++u) {
            const float d = static_cast<float>(steps.at<std::int16_t>(v, u + disparities)) / 16.0F;
            if (d > 0.0F && d <= static_cast<float>(u)) disparity_px.at(u, v) = d;
        }
    }
    return disparity_px;
}

bool same(const Image<float>& a, const Image<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

double cpu_ms() {
    return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

TEST(MatcherConfig, SaysWhatIsWrong) {
    const auto with = [](auto change) {
        MatcherConfig config;
        change(config);
        return config;
    };
    EXPECT_EQ(MatcherConfig{}.problem(), std::nullopt);
    EXPECT_EQ(with([](MatcherConfig& c) { c.disparities = 60; }).problem().value_or(""),
              "stereo.disparities = 60 must be a multiple of 16 from 16 to 512");
    EXPECT_EQ(with([](MatcherConfig& c) { c.block_size = 4; }).problem().value_or(""),
              "stereo.block_size = 4 must be odd, from 1 to 11");
    EXPECT_EQ(with([](MatcherConfig& c) { c.bm_block_size = 14; }).problem().value_or(""),
              "stereo.bm_block_size = 14 must be odd, from 5 to 51");
    EXPECT_EQ(with([](MatcherConfig& c) { c.bm_prefilter_cap = 64; }).problem().value_or(""),
              "stereo.bm_prefilter_cap = 64 must be from 1 to 63");
    EXPECT_EQ(with([](MatcherConfig& c) { c.left_right_tolerance_px = std::nan(""); })
                  .problem()
                  .value_or(""),
              "stereo.left_right_tolerance_px = nan must be from 0 to 16");
    EXPECT_EQ(with([](MatcherConfig& c) { c.disparities = 512; }).problem().value_or(""),
              "stereo.disparities = 512 must be at most 256 with stereo.algorithm = census");
}

class EveryMatcher : public testing::TestWithParam<Algorithm> {
  protected:
    [[nodiscard]] static MatcherConfig config() {
        MatcherConfig config;
        config.algorithm = GetParam();
        if (config.algorithm == Algorithm::sgbm) config.uniqueness_percent = 10;  // see plain_sgbm
        return config;
    }
    [[nodiscard]] static const char* name() {
        return kAlgorithmNames[static_cast<std::size_t>(GetParam())];
    }
};
INSTANTIATE_TEST_SUITE_P(Algorithms,
                         EveryMatcher,
                         testing::Values(Algorithm::census, Algorithm::sgbm, Algorithm::bm),
                         [](const auto& parameter) {
                             return kAlgorithmNames[static_cast<std::size_t>(parameter.param)];
                         });

TEST_P(EveryMatcher, AGreyWallGivesNoTrustedDepth) {
    const GreyImage grey(160, 120, 128);
    const DepthImage depth = match(grey, grey, config());
    for (std::size_t i = 0; i < depth.disparity_px.size(); ++i) {
        const bool unknown = std::isnan(depth.disparity_px.data()[i]);
        EXPECT_TRUE(unknown || depth.sigma_px.data()[i] == kMaxSigma_px);
        if (unknown) {
            EXPECT_EQ(depth.outlier_probability.data()[i], 1.0F);
        }
    }
}

TEST_P(EveryMatcher, ImagesNarrowerThanTheSearchWork) {
    const GreyImage grey(20, 10, 128);
    const DepthImage depth = match(grey, grey, config());
    EXPECT_EQ(depth.disparity_px.width(), 20);
    EXPECT_EQ(depth.disparity_px.height(), 10);
}

TEST(BlockMatcher, WindowsLargerThanTheImageWork) {
    MatcherConfig config;
    config.algorithm = Algorithm::bm;
    config.bm_block_size = 51;
    config.bm_prefilter_cap = 63;
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 60}, {60, 1}, {40, 30}}) {
        const GreyImage grey(width, height, 128);
        const DepthImage depth = match(grey, grey, config);
        EXPECT_EQ(depth.disparity_px.width(), width);
        EXPECT_EQ(depth.disparity_px.height(), height);
    }
}

TEST(SgbmMatcher, ModesDiffer) {
    const test::SyntheticPair& pair = scene();
    std::vector<DepthImage> found;
    for (const SgbmMode mode : {SgbmMode::three_way, SgbmMode::hh4, SgbmMode::hh}) {
        MatcherConfig config;
        config.algorithm = Algorithm::sgbm;
        config.sgbm_mode = mode;
        const DepthImage depth = match(pair.left, pair.right, config);
        const Score s =
            score(depth.disparity_px, &depth.sigma_px, pair.disparity_px, [&](int u, int v) {
                return pair.near_edge.at(u, v) == 0;
            });
        const char* const name = kSgbmModeNames[static_cast<std::size_t>(mode)];
        std::printf("%s: rms %.3f px, density %.1f %%\n", name, s.rms_px, 100 * s.density);
        EXPECT_LT(s.rms_px, 0.13) << name;
        EXPECT_GT(s.density, 0.99) << name;
        for (const DepthImage& other : found)
            EXPECT_FALSE(same(depth.disparity_px, other.disparity_px)) << name;
        found.push_back(depth);
    }
}

TEST_P(EveryMatcher, FloorIsExactToATenthOfAPixel) {
    const test::SyntheticPair& pair = scene();
    const double start_ms = cpu_ms();
    const DepthImage depth = match(pair.left, pair.right, config());
    const double ours_ms = cpu_ms() - start_ms;
    const auto away_from_edges = [&](int u, int v) { return pair.near_edge.at(u, v) == 0; };
    const Score ours =
        score(depth.disparity_px, &depth.sigma_px, pair.disparity_px, away_from_edges);
    const Score plain =
        score(plain_sgbm(pair.left, pair.right, 64), nullptr, pair.disparity_px, away_from_edges);
    std::printf(
        "%s, rendered steps: rms %.3f px (plain %.3f), mean %+.3f (plain %+.3f), bad-1 %.2f %%, "
        "density %.1f %%, "
        "3 sigma %.2f %%, first call %.0f ms of processor time\n",
        name(),
        ours.rms_px,
        plain.rms_px,
        ours.mean_px,
        plain.mean_px,
        100 * ours.bad_1,
        100 * ours.density,
        100 * ours.within_3_sigma,
        ours_ms);
    // 5 mm of height at 1.2 m are 0.14 px of this camera.
    EXPECT_LT(ours.rms_px, 0.13);
    EXPECT_LT(ours.rms_px, 0.65 * plain.rms_px);
    EXPECT_LT(std::abs(ours.mean_px), 0.02);
    EXPECT_LT(ours.bad_1, 0.002);
    EXPECT_GT(ours.density, 0.99);
}

TEST(CensusMatcher, IsNotLateOnWeakFloor) {
    // Paths come from all four sides. So upright and upside down the floor has the same height.
    double mean_px[2] = {};
    for (const bool upside_down : {false, true}) {
        double sum_px = 0.0;
        for (const std::uint64_t seed : {5U, 6U, 7U}) {
            test::SceneConfig config;
            config.seed = seed;
            config.noise_grey = 3.0;
            config.contrast_grey = 2.0;
            test::SyntheticPair pair = test::Scene(config).render();
            if (upside_down) {
                flip(pair.left);
                flip(pair.right);
                flip(pair.disparity_px);
            }
            const DepthImage depth = match(pair.left, pair.right, MatcherConfig{});
            sum_px += score(depth.disparity_px, nullptr, pair.disparity_px, [](int, int) {
                          return true;
                      }).mean_px;
        }
        mean_px[upside_down ? 1 : 0] = sum_px / 3.0;
    }
    std::printf("weak floor: mean %+.3f px, upside down %+.3f px\n", mean_px[0], mean_px[1]);
    EXPECT_LT(std::abs(mean_px[0] - mean_px[1]), 0.05);
}

TEST_P(EveryMatcher, ThreeSigmaCoverTheErrors) {
    const test::SyntheticPair& pair = scene();
    const DepthImage depth = match(pair.left, pair.right, config());
    const Score all = score(
        depth.disparity_px, &depth.sigma_px, pair.disparity_px, [](int, int) { return true; });
    const Score trusted =
        score(depth.disparity_px, &depth.sigma_px, pair.disparity_px, [&](int u, int v) {
            return depth.outlier_probability.at(u, v) <= kTrustedOutlierProbability;
        });
    std::printf("3 sigma cover %.2f %% of all pixels, %.2f %% of the trusted\n",
                100 * all.within_3_sigma,
                100 * trusted.within_3_sigma);
    EXPECT_GE(all.within_3_sigma, 0.97);
    EXPECT_GE(trusted.within_3_sigma, 0.99);
}

TEST_P(EveryMatcher, RightMatchesAreTrustedAndTrustedOnesAreRight) {
    const test::SyntheticPair& pair = scene();
    const DepthImage depth = match(pair.left, pair.right, config());
    int right = 0, kept = 0, trusted = 0, trusted_wrong = 0;
    double expected_wrong = 0.0;
    for (int v = 0; v < pair.left.height(); ++v) {
        for (int u = 0; u < pair.left.width(); ++u) {
            const float error = depth.disparity_px.at(u, v) - pair.disparity_px.at(u, v);
            if (std::isnan(error)) continue;
            const float probability = depth.outlier_probability.at(u, v);
            ASSERT_GE(probability, 0.0F);
            ASSERT_LE(probability, 1.0F);
            const bool bad = std::abs(error) > 1.0F;
            right += !bad;
            if (probability > kTrustedOutlierProbability) continue;
            kept += !bad;
            ++trusted;
            trusted_wrong += bad;
            expected_wrong += static_cast<double>(probability);
        }
    }
    std::printf("%d right, %d of them trusted; %d trusted, %d of them wrong (%.0f expected)\n",
                right,
                kept,
                trusted,
                trusted_wrong,
                expected_wrong);
    EXPECT_GT(kept, 0.98 * right);
    EXPECT_LT(trusted_wrong, 1e-3 * trusted);
    EXPECT_LT(trusted_wrong, expected_wrong);
}

TEST_P(EveryMatcher, SameBytesForEveryExecutorThreadCountAndCall) {
    const test::SyntheticPair& pair = scene();
    const int threads = cv::getNumThreads();
    Serial serial;
    Threads two(2);
    DepthImage a, b;
    const auto matcher = make_matcher(config());
    cv::setNumThreads(1);
    matcher->match(pair.left.view(), pair.right.view(), serial, a);
    cv::setNumThreads(2);
    matcher->match(pair.right.view(), pair.left.view(), two, b);  // leaves other contents in b
    matcher->match(pair.left.view(), pair.right.view(), two, b);
    cv::setNumThreads(threads);
    EXPECT_TRUE(same(a.disparity_px, b.disparity_px));
    EXPECT_TRUE(same(a.sigma_px, b.sigma_px));
    EXPECT_TRUE(same(a.outlier_probability, b.outlier_probability));
}

// ---- real images --------------------------------------------------------------------------------

struct RealPair {
    const char* name;
    const char* truth;
    const char* other_truth;  ///< of the right camera, to find hidden pixels; or
    const char* mask;         ///< above 200 where both cameras see the point
    double truth_scale;
    int disparities;
    double max_bad_2;     ///< of an earlier matcher, plus 10 %
    double max_bad_2_bm;  ///< limit for block matching, which is worse than SGBM
};

GreyImage load(const std::string& file) {
    const cv::Mat m = cv::imread(file, cv::IMREAD_GRAYSCALE);
    GreyImage image(m.cols, m.rows);
    if (!m.empty()) m.copyTo(cv::Mat(m.rows, m.cols, CV_8UC1, image.data()));
    return image;
}

Image<float> load_truth(const std::string& base, const RealPair& pair) {
    const GreyImage grey = load(base + pair.truth);
    const GreyImage other =
        pair.other_truth != nullptr ? load(base + pair.other_truth) : GreyImage();
    const GreyImage mask = pair.mask != nullptr ? load(base + pair.mask) : GreyImage();
    Image<float> truth_px(grey.width(), grey.height(), std::numeric_limits<float>::quiet_NaN());
    for (int v = 0; v < grey.height(); ++v) {
        for (int u = 0; u < grey.width(); ++u) {
            const double d = grey.at(u, v) / pair.truth_scale;
            if (grey.at(u, v) == 0 || (!mask.empty() && mask.at(u, v) <= 200)) continue;
            if (!other.empty()) {
                const int x = static_cast<int>(std::lround(u - d));
                if (!other.contains(x, v) || other.at(x, v) == 0) continue;
                if (std::abs(other.at(x, v) / pair.truth_scale - d) > 1.0) continue;
            }
            truth_px.at(u, v) = static_cast<float>(d);
        }
    }
    return truth_px;
}

TEST_P(EveryMatcher, MiddleburyBesidePlainSgbm) {
    // The truth of adirondack is rounded to whole pixels, so only bad-2 is meaningful there.
    const RealPair pairs[] = {
        {"cones", "disp_left_x4.png", "disp_right_x4.png", nullptr, 4.0, 64, 0.024, 0.041},
        {"teddy", "disp_left_x4.png", "disp_right_x4.png", nullptr, 4.0, 64, 0.028, 0.066},
        {"cloth3", "disp_left.png", "disp_right.png", nullptr, 2.0, 96, 0.010, 0.0112},
        {"adirondack", "gt.png", nullptr, "mask.png", 1.0, 80, 0.039, 0.062},
    };
    const char* folder = std::getenv("SUREFOOT_DATA_DIR");
    const std::string root =
        std::string(folder != nullptr ? folder : SUREFOOT_DEFAULT_DATA_DIR) + "/stereo/";
    int skipped = 0;
    for (const RealPair& pair : pairs) {
        const std::string base = root + pair.name + "/";
        const GreyImage left = load(base + "left.png");
        const GreyImage right = load(base + "right.png");
        if (left.empty() || right.empty()) {
            ++skipped;
            continue;
        }
        const Image<float> truth_px = load_truth(base, pair);
        const auto everywhere = [](int, int) { return true; };
        MatcherConfig wide = config();
        wide.disparities = pair.disparities;
        const DepthImage depth = match(left, right, wide);
        const Score ours = score(depth.disparity_px, &depth.sigma_px, truth_px, everywhere);
        const Score plain =
            score(plain_sgbm(left, right, pair.disparities), nullptr, truth_px, everywhere);
        std::printf(
            "%-10s bad-1 %5.2f %% (plain %5.2f), bad-2 %4.2f %% (%4.2f), density %.1f %% (%.1f), "
            "rms %.3f px "
            "(%.3f), 3 sigma %.1f %%\n",
            pair.name,
            100 * ours.bad_1,
            100 * plain.bad_1,
            100 * ours.bad_2,
            100 * plain.bad_2,
            100 * ours.density,
            100 * plain.density,
            ours.rms_px,
            plain.rms_px,
            100 * ours.within_3_sigma);
        if (GetParam() == Algorithm::bm) {
            EXPECT_LT(ours.bad_2, pair.max_bad_2_bm) << pair.name;
            // Areas without texture stay empty: adirondack loses 11.3 %.
            EXPECT_GT(ours.density, plain.density - 0.12) << pair.name;
            continue;
        }
        EXPECT_LT(ours.bad_2, pair.max_bad_2) << pair.name;
        EXPECT_LE(ours.bad_2, plain.bad_2) << pair.name;
        // Fewer pixels, with fewer wrong ones: adirondack loses 1.8 % to the left-right check.
        EXPECT_GT(ours.density, plain.density - 0.02) << pair.name;
    }
    if (skipped > 0)
        std::printf("skipped 1 check: %d of 4 pairs have no images in %s\n", skipped, root.c_str());
}

}  // namespace
}  // namespace surefoot::stereo
