// SPDX-License-Identifier: Apache-2.0
// How right is the matcher, and does it know? Beside OpenCV's, on Middlebury pairs and on the
// simulated ZED.
// Usage: matcher_accuracy STEREO_DATA_DIR OUT_DIR [FIRST_SEED]
//
// pairs.csv    set,pair,matcher,bad_1,bad_2,density,cpu_ms: share of the pixels that both eyes see
//              which are wrong by more than 1 or 2 px, unknown ones filled from the smaller
//              horizontal neighbour, all rounded to 1/16 px. Sets: "defaults", and "tuned": the
//              same number of settings was tried for every matcher on cones and cloth3, the best
//              (mean of bad-1 and twice bad-2) is shown on all pairs; teddy, adirondack and
//              adirondack with a differently exposed right eye took no part in the choice
// sigma.csv    source,count,within_1,within_2,within_3,density,auc_sigma,auc_peak: trusted matches
//              that are right within 1 px; the order of sigma and, instead, that of the cost of the
//              second best over the best, judged by eval::sparsification over all matches
#include <fmt/format.h>
#include <fmt/os.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "apps/surefoot/log.hpp"
#include "eval/sparsification.hpp"
#include "sim/rigs.hpp"
#include "sim/scene_source.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/stereo/matcher.hpp"
#include "surefoot/stereo/settle.hpp"
#include "surefoot/stereo/speckles.hpp"

namespace surefoot {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Pair {
    std::string name;
    GreyImage left;
    GreyImage right;
    Image<float> truth_px;  ///< NaN = unknown, or hidden from one eye
    int disparities = 64;
    double step_px = 0.0;  ///< to which the truth was rounded
    bool tunes = false;
};

GreyImage load(const std::string& path) {
    const cv::Mat read = cv::imread(path, cv::IMREAD_GRAYSCALE);
    GreyImage image(read.cols, read.rows);
    if (!read.empty()) read.copyTo(cv::Mat(read.rows, read.cols, CV_8UC1, image.data()));
    return image;
}

struct PairFiles {
    const char* folder;
    const char* right;
    const char* truth;
    const char* right_truth;  ///< or nothing, then `mask`
    const char* mask;
    double scale;
    int disparities;
    bool tunes;
};
constexpr PairFiles kPairs[] = {
    {"cones", "right.png", "disp_left_x4.png", "disp_right_x4.png", nullptr, 4.0, 64, true},
    {"teddy", "right.png", "disp_left_x4.png", "disp_right_x4.png", nullptr, 4.0, 64, false},
    {"cloth3", "right.png", "disp_left.png", "disp_right.png", nullptr, 2.0, 96, true},
    {"adirondack", "right.png", "gt.png", nullptr, "mask.png", 1.0, 96, false},
    {"adirondack", "rightE.png", "gt.png", nullptr, "mask.png", 1.0, 96, false},
};

Pair load_pair(const std::string& root, const PairFiles& files) {
    const std::string folder = fmt::format("{}/{}/", root, files.folder);
    Pair pair;
    const bool other_exposure = std::string(files.right) == "rightE.png";
    pair.name = std::string(files.folder) + (other_exposure ? " (exposure)" : "");
    pair.left = load(folder + "left.png");
    pair.right = load(folder + files.right);
    pair.disparities = files.disparities;
    pair.step_px = 1.0 / files.scale;
    pair.tunes = files.tunes;
    const GreyImage truth = load(folder + files.truth);
    const GreyImage other =
        files.right_truth != nullptr ? load(folder + files.right_truth) : GreyImage();
    const GreyImage mask = files.mask != nullptr ? load(folder + files.mask) : GreyImage();
    pair.truth_px = Image<float>(truth.width(), truth.height(), kNan);
    for (int v = 0; v < truth.height(); ++v) {
        for (int u = 0; u < truth.width(); ++u) {
            const double d = truth.at(u, v) / files.scale;
            if (truth.at(u, v) == 0 || (!mask.empty() && mask.at(u, v) <= 200)) continue;
            if (!other.empty()) {
                const int x = static_cast<int>(std::lround(u - d));
                if (!other.contains(x, v) || other.at(x, v) == 0 ||
                    std::abs(other.at(x, v) / files.scale - d) > 1.0)
                    continue;
            }
            pair.truth_px.at(u, v) = static_cast<float>(d);
        }
    }
    return pair;
}

/// Unknown pixels take the smaller one of their nearest known neighbours along the row.
Image<float> filled(const Image<float>& disparity_px) {
    Image<float> result = disparity_px;
    for (int v = 0; v < result.height(); ++v) {
        std::vector<float> from_left(static_cast<std::size_t>(result.width()), kNan);
        float last = kNan;
        for (int u = 0; u < result.width(); ++u) {
            if (!std::isnan(disparity_px.at(u, v))) last = disparity_px.at(u, v);
            from_left[static_cast<std::size_t>(u)] = last;
        }
        last = kNan;
        for (int u = result.width() - 1; u >= 0; --u) {
            if (!std::isnan(disparity_px.at(u, v))) last = disparity_px.at(u, v);
            result.at(u, v) = std::fmin(from_left[static_cast<std::size_t>(u)], last);
        }
    }
    return result;
}

/// Disparities are judged in OpenCV's steps: against truth in whole pixels half a step decides.
constexpr float kStepsPerPixel = 16.0F;

struct Score {
    double bad_1 = 0.0;
    double bad_2 = 0.0;
    double density = 0.0;
};

Score score(const Pair& pair, const Image<float>& disparity_px) {
    const Image<float> all = filled(disparity_px);
    double count = 0.0;
    Score sum;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const float truth_px = pair.truth_px.data()[i];
        if (std::isnan(truth_px)) continue;
        const float steps = std::round(all.data()[i] * kStepsPerPixel);
        const float error_px = std::abs(steps / kStepsPerPixel - truth_px);
        ++count;
        sum.bad_1 += error_px <= 1.0F ? 0.0 : 1.0;
        sum.bad_2 += error_px <= 2.0F ? 0.0 : 1.0;
        sum.density += std::isnan(disparity_px.data()[i]) ? 0.0 : 1.0;
    }
    return {100.0 * sum.bad_1 / count, 100.0 * sum.bad_2 / count, 100.0 * sum.density / count};
}

/// A way to match with one setting of it.
using Match = std::function<Image<float>(const Pair&)>;

Match chain() {
    return [](const Pair& pair) {
        stereo::MatcherConfig config;
        config.disparities = pair.disparities;
        Serial serial;
        DepthImage depth;
        stereo::make_matcher(config)->match(pair.left.view(), pair.right.view(), serial, depth);
        return depth.disparity_px;
    };
}

Match census(const stereo::SemiGlobalConfig& penalties) {
    return [=](const Pair& pair) {
        stereo::SemiGlobalConfig config = penalties;
        config.disparities = pair.disparities;
        Serial serial;
        stereo::Winners winners;
        stereo::SemiGlobalSearch(config).search(
            pair.left.view(), pair.right.view(), serial, winners);
        Image<float> settled_px;
        Image<float> disparity_px;
        stereo::settle({}, winners, serial, settled_px);
        stereo::SpeckleFilter().remove(
            stereo::kSpeckleSize_px, stereo::kSpeckleRange_px, settled_px);
        disparity_px.resize(settled_px.width(), settled_px.height());
        std::vector<float> scratch;
        for (int v = 0; v < settled_px.height(); ++v)
            stereo::median_of_row(settled_px, v, scratch, disparity_px.row(v));
        return disparity_px;
    };
}

/// OpenCV's, padded on the left so that no column is lost.
Match opencv(int mode, double slope, double jump, int cap) {
    return [=](const Pair& pair) {
        constexpr int kBlock = 3;
        const auto padded = [&](const GreyImage& image) {
            const cv::Mat in(
                image.height(), image.width(), CV_8UC1, const_cast<std::uint8_t*>(image.data()));
            cv::Mat out;
            cv::copyMakeBorder(in, out, 0, 0, pair.disparities, 0, cv::BORDER_REPLICATE);
            return out;
        };
        const auto matcher = cv::StereoSGBM::create(0,
                                                    pair.disparities,
                                                    kBlock,
                                                    static_cast<int>(slope * kBlock * kBlock),
                                                    static_cast<int>(jump * kBlock * kBlock),
                                                    1,
                                                    cap,
                                                    10,
                                                    100,
                                                    2,
                                                    mode);
        cv::Mat steps;
        matcher->compute(padded(pair.left), padded(pair.right), steps);
        Image<float> disparity_px(pair.left.width(), pair.left.height(), kNan);
        for (int v = 0; v < disparity_px.height(); ++v) {
            const auto* const row = steps.ptr<std::int16_t>(v) + pair.disparities;
            for (int u = 0; u < disparity_px.width(); ++u) {
                if (row[u] > 0) disparity_px.at(u, v) = static_cast<float>(row[u]) / 16.0F;
            }
        }
        return disparity_px;
    };
}

void report(fmt::ostream& out,
            const char* set,
            const std::string& name,
            const Match& match,
            const std::vector<Pair>& pairs) {
    for (const Pair& pair : pairs) {
        const std::clock_t start = std::clock();
        const Image<float> disparity_px = match(pair);
        const double cpu_ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
        const Score s = score(pair, disparity_px);
        out.print("{},{},{},{:.3f},{:.3f},{:.2f},{:.1f}\n",
                  set,
                  pair.name,
                  name,
                  s.bad_1,
                  s.bad_2,
                  s.density,
                  cpu_ms);
    }
}

/// The best of its settings on the pairs that are for tuning.
struct Candidate {
    std::string name;
    std::vector<Match> settings;
};
const Match& tuned(const Candidate& candidate, const std::vector<Pair>& pairs) {
    double least = std::numeric_limits<double>::infinity();
    std::size_t best = 0;
    for (std::size_t i = 0; i < candidate.settings.size(); ++i) {
        double sum = 0.0;
        for (const Pair& pair : pairs) {
            if (!pair.tunes) continue;
            const Score s = score(pair, candidate.settings[i](pair));
            sum += s.bad_1 + 2.0 * s.bad_2;
        }
        if (sum < least) {
            least = sum;
            best = i;
        }
    }
    return candidate.settings[best];
}

std::vector<Candidate> candidates() {
    Candidate ours{"our search alone", {}};
    for (const int slope : {3, 5, 8, 11})
        for (const int jump : {30, 42, 54})
            for (const int least : {6, 12, 20})
                ours.settings.push_back(census(
                    {.slope_penalty = slope, .jump_penalty = jump, .min_jump_penalty = least}));
    std::vector<Candidate> all = {ours};
    for (const auto& [name, mode] :
         {std::pair{"OpenCV SGBM 3-way", static_cast<int>(cv::StereoSGBM::MODE_SGBM_3WAY)},
          std::pair{"OpenCV SGBM HH4", static_cast<int>(cv::StereoSGBM::MODE_HH4)}}) {
        Candidate theirs{name, {}};
        for (const double slope : {2.0, 4.0, 8.0, 14.0})
            for (const double jump : {20.0, 32.0, 60.0})
                for (const int cap : {15, 31, 63})
                    theirs.settings.push_back(opencv(mode, slope, jump, cap));
        all.push_back(theirs);
    }
    return all;
}

/// Cost of the second best over that of the best, upside down: large = unsure.
Image<float> peak_doubt(const Pair& pair) {
    stereo::SemiGlobalConfig config;
    config.disparities = pair.disparities;
    Serial serial;
    stereo::Winners winners;
    stereo::SemiGlobalSearch(config).search(pair.left.view(), pair.right.view(), serial, winners);
    Image<float> doubt(pair.left.width(), pair.left.height());
    for (std::size_t i = 0; i < doubt.size(); ++i) {
        doubt.data()[i] = static_cast<float>(winners.cost.data()[i] + 1) /
                          static_cast<float>(winners.second_cost.data()[i] + 1);
    }
    return doubt;
}

void report_sigma(fmt::ostream& out, const Pair& pair) {
    stereo::MatcherConfig config;
    config.disparities = pair.disparities;
    Serial serial;
    DepthImage depth;
    stereo::make_matcher(config)->match(pair.left.view(), pair.right.view(), serial, depth);
    const Image<float> doubt = peak_doubt(pair);
    std::vector<float> errors_px;
    std::vector<float> sigmas_px;
    std::vector<float> doubts;
    std::array<double, 3> within{};
    double judged = 0.0;
    double all = 0.0;
    for (std::size_t i = 0; i < doubt.size(); ++i) {
        if (std::isnan(pair.truth_px.data()[i])) continue;
        ++all;
        const float error_px = depth.disparity_px.data()[i] - pair.truth_px.data()[i];
        if (std::isnan(error_px)) continue;
        errors_px.push_back(error_px);
        // One number for both kinds of doubt: what is likely wrong counts as wrong by pixels.
        const float p = depth.outlier_probability.data()[i];
        sigmas_px.push_back(depth.sigma_px.data()[i] + 4.0F * p);
        doubts.push_back(doubt.data()[i]);
        if (p > 0.5F || std::abs(error_px) > 1.0F) continue;
        const double sigma_px = std::hypot(static_cast<double>(depth.sigma_px.data()[i]),
                                           pair.step_px / std::sqrt(12.0));
        ++judged;
        for (std::size_t k = 0; k < within.size(); ++k) {
            within[k] +=
                std::abs(static_cast<double>(error_px)) <= static_cast<double>(k + 1) * sigma_px
                    ? 100.0
                    : 0.0;
        }
    }
    out.print("{},{},{:.1f},{:.1f},{:.1f},{:.1f},{:.4f},{:.4f}\n",
              pair.name,
              judged,
              within[0] / judged,
              within[1] / judged,
              within[2] / judged,
              100.0 * static_cast<double>(errors_px.size()) / all,
              eval::sparsification(errors_px, sigmas_px).auc,
              eval::sparsification(errors_px, doubts).auc);
}

Result<Pair> simulated(const std::string& scene,
                       sim::CameraProfile profile,
                       double noise,
                       std::uint64_t seed) {
    sim::SceneOptions options;
    options.scene = scene;
    options.profile = profile;
    options.noise = noise;
    options.seed = seed;
    options.frames = 1;
    auto source = sim::open_scene(options);
    if (!source) return source.error();
    const auto frame = (*source)->next();
    if (!frame) return frame.error();
    const auto rectifier = camera::Rectifier::make((*source)->rig());
    if (!rectifier) return rectifier.error();
    Pair pair;
    pair.name = fmt::format("{} ({} x {:g})",
                            scene,
                            sim::kCameraProfileNames[static_cast<std::size_t>(profile)],
                            noise);
    pair.left = (*frame)->left;
    pair.right = (*frame)->right;
    const double fb_px_m = rectifier->rig().depth_to_disparity_px_m();
    const Image<float>& depth_m = (*source)->last_depth_m();
    pair.truth_px = Image<float>(depth_m.width(), depth_m.height(), kNan);
    for (std::size_t i = 0; i < depth_m.size(); ++i) {
        if (depth_m.data()[i] > 0.0F)
            pair.truth_px.data()[i] =
                static_cast<float>(fb_px_m / static_cast<double>(depth_m.data()[i]));
    }
    return pair;
}

}  // namespace
}  // namespace surefoot

// An exception ends an experiment with its message, as it should.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    using namespace surefoot;
    if (argc < 3) {
        fmt::print(stderr, "usage: matcher_accuracy STEREO_DATA_DIR OUT_DIR [FIRST_SEED]\n");
        return 2;
    }
    cv::setNumThreads(1);
    const std::string folder = argv[2];
    const int first_seed = argc > 3 ? std::atoi(argv[3]) : 1;
    std::vector<Pair> pairs;
    for (const PairFiles& files : kPairs) {
        pairs.push_back(load_pair(argv[1], files));
        if (pairs.back().left.empty() || pairs.back().right.empty()) {
            fmt::print(stderr, "no images of {} in {}\n", pairs.back().name, argv[1]);
            return 1;
        }
    }
    auto scores = fmt::output_file(folder + "/pairs.csv");
    scores.print("set,pair,matcher,bad_1,bad_2,density,cpu_ms\n");
    constexpr int k3Way = cv::StereoSGBM::MODE_SGBM_3WAY;
    constexpr int kHh4 = cv::StereoSGBM::MODE_HH4;
    report(scores, "defaults", "our whole matcher", chain(), pairs);
    report(scores, "defaults", "our search alone", census({}), pairs);
    report(scores, "defaults", "OpenCV SGBM 3-way", opencv(k3Way, 8.0, 32.0, 63), pairs);
    report(scores, "defaults", "OpenCV SGBM HH4", opencv(kHh4, 8.0, 32.0, 63), pairs);
    for (const Candidate& candidate : candidates()) {
        report(scores, "tuned", candidate.name, tuned(candidate, pairs), pairs);
        fmt::print(stderr, "{} tuned\n", candidate.name);
    }
    auto sigmas = fmt::output_file(folder + "/sigma.csv");
    sigmas.print("source,count,within_1,within_2,within_3,density,auc_sigma,auc_peak\n");
    for (const Pair& pair : pairs) {
        if (pair.step_px < 1.0) report_sigma(sigmas, pair);  // truth in whole pixels says nothing
    }
    for (const sim::CameraProfile profile : {sim::CameraProfile::zed, sim::CameraProfile::ideal}) {
        for (const double noise : {1.0, 2.0}) {
            int seed = first_seed;
            for (const char* scene : {"demo_stairs",
                                      "floor",
                                      "sill_13",
                                      "stairs_up_ada",
                                      "kerb_down_150",
                                      "table",
                                      "glass_door",
                                      "stripes_window"}) {
                const auto pair =
                    simulated(scene, profile, noise, static_cast<std::uint64_t>(seed++));
                if (!pair) return app::report(pair.error());
                report_sigma(sigmas, *pair);
            }
        }
    }
    return 0;
}
