// SPDX-License-Identifier: Apache-2.0
// Is the outlier probability of our matcher true, and does it throw away right matches? The
// coefficients are fitted to some images; all images are reported.
// Usage: trust DATA_DIR OUT_DIR FIRST_SEED [FIRST_FIT_SEED]
//   FIRST_SEED: first seed of the simulated images for the report. FIRST_FIT_SEED: first seed of
//   those of the fit, default 21.
//
// A simulated image and a Middlebury pair have a truth. In place of the truth of a real pair stands
// the match of OpenCV's HH4 where two of its settings agree within 1 px.
//
// Writes into OUT_DIR:
//   trust.csv        image,kind,use,matches,kept,wrong,wrong_trusted [%]: matches whose truth is
//                    known; share of the matches right within 1 px that are trusted; share of the
//                    matches, and of the trusted matches, that are wrong by more than 2 px
//   reliability.csv  kind,use,stated,wrong,matches: matches by stated outlier probability; mean
//                    stated probability and share that is wrong by more than 1 px [%]
// The fitted coefficients are printed to stdout.
#include <fmt/format.h>
#include <fmt/os.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "lab/stereo_pairs/match_evidence.hpp"
#include "lab/stereo_pairs/rival_matchers.hpp"
#include "lab/stereo_pairs/stereo_pairs.hpp"
#include "service/console/log.hpp"
#include "surefoot/camera/rectifier.hpp"
#include "surefoot/core/unknown.hpp"
#include "surefoot/io/calibration/rig_file.hpp"
#include "surefoot/io/images/image_file.hpp"
#include "surefoot/io/recordings/recording.hpp"

namespace surefoot::experiments {
namespace {

constexpr int kTakenEvery = 7;  ///< neighbouring matches have correlated errors
/// Weight of a real image in the fit; a simulated image weighs 1.
constexpr double kWeightOfReal = 3.0;
constexpr std::array<double, 9> kBins = {0.0, 0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 1.01};

using Terms = Eigen::Matrix<double, 5, 1>;  ///< 1, near jump, log noise, shift, unknown

struct Match {
    stereo::MatchEvidence evidence;
    double error_px = 0.0;
    float probability = 0.0F;  ///< stated outlier probability
    bool isolated = false;     ///< see stereo::IsolatedMatches
};

struct Seen {
    std::string name;
    std::string kind;
    bool fits = false;  ///< the coefficients are fitted to this image
    std::vector<Match> matches;
};

Terms terms_of(const stereo::MatchEvidence& e) {
    const double near =
        std::max(0.0, 1.0 - e.jump_distance_px / static_cast<double>(stereo::kJumpReach_px));
    const double most = static_cast<double>(stereo::kMaxNoisePerPixel_px);
    const double residual = static_cast<double>(e.residual_grey);
    const double gradient = static_cast<double>(e.gradient_grey_px);
    const double noise = gradient > residual / most ? residual / gradient : most;
    return {1.0,
            near,
            std::log(noise),
            std::abs(static_cast<double>(e.shift_px)),
            static_cast<double>(e.unknown_share)};
}

/// True if these terms and the coefficients of the library give the library's probability.
bool is_the_library(const stereo::MatchEvidence& evidence) {
    if (evidence.nearer_by_px > stereo::kNearSideStep_px) return true;  // rated by a policy
    const Terms c(static_cast<double>(stereo::kScoreConstant),
                  static_cast<double>(stereo::kScoreNearJump),
                  static_cast<double>(stereo::kScoreNoise),
                  static_cast<double>(stereo::kScoreShift),
                  static_cast<double>(stereo::kScoreUnknown));
    const double p = 1.0 / (1.0 + std::exp(-c.dot(terms_of(evidence))));
    return std::abs(p - static_cast<double>(stereo::outlier_probability(evidence))) < 1e-5;
}

Result<Seen> see(const TruePair& pair, std::string kind, bool fits) {
    const PairEvidence evidence(pair);
    const Image<float> probability = evidence.outlier_probability();
    Seen seen{pair.name, std::move(kind), fits, {}};
    int count = 0;
    for (int v = 0; v < pair.truth_px.height(); ++v) {
        for (int u = 0; u < pair.truth_px.width(); ++u) {
            const float error_px = evidence.disparity_px.at(u, v) - pair.truth_px.at(u, v);
            if (std::isnan(error_px) || ++count % kTakenEvery != 0) continue;
            if (!is_the_library(evidence.at(u, v)))
                return input_error(
                    "outlier_probability has changed; update terms_of in lab/trust/main.cpp");
            const float alone = stereo::outlier_probability(evidence.at(u, v));
            seen.matches.push_back({evidence.at(u, v),
                                    std::abs(static_cast<double>(error_px)),
                                    probability.at(u, v),
                                    probability.at(u, v) > alone});
        }
    }
    return seen;
}

/// Replaces the missing truth of a pair by OpenCV's match where two of its settings agree.
void take_agreement(TruePair& pair) {
    const Image<float> fine = opencv_sgbm({.mode = cv::StereoSGBM::MODE_HH4})(pair);
    const Image<float> smooth = opencv_sgbm({.mode = cv::StereoSGBM::MODE_HH4,
                                             .block = 7,
                                             .slope = 24.0,
                                             .jump = 96.0,
                                             .prefilter_cap = 15})(pair);
    pair.truth_px = fine;
    for (std::size_t i = 0; i < fine.size(); ++i) {
        if (!(std::abs(fine.data()[i] - smooth.data()[i]) <= 1.0F)) pair.truth_px.data()[i] = kNanF;
    }
}

/// Reads a rectified pair without truth.
Result<TruePair> real_pair(const std::string& name,
                           const std::string& left,
                           const std::string& right,
                           int disparities) {
    auto left_image = io::read_grey_image(left);
    if (!left_image) return left_image.error();
    auto right_image = io::read_grey_image(right);
    if (!right_image) return right_image.error();
    TruePair pair;
    pair.name = name;
    pair.left = std::move(*left_image);
    pair.right = std::move(*right_image);
    pair.disparities = disparities;
    take_agreement(pair);
    return pair;
}

/// Reads a side-by-side frame and rectifies it.
Result<TruePair> side_by_side(const std::string& name,
                              const std::string& path,
                              const camera::StereoRig& rig) {
    const auto both = io::read_grey_image(path);
    if (!both) return both.error();
    StereoFrame frame;
    if (auto split = io::split_side_by_side(*both, rig, path, frame); !split) return split.error();
    const auto rectifier = camera::Rectifier::make(rig);
    if (!rectifier) return rectifier.error();
    camera::RectifiedPair rectified;
    rectifier->rectify(frame, rectified);
    TruePair pair;
    pair.name = name;
    pair.left = rectified.left;
    pair.right = rectified.right;
    take_agreement(pair);
    return pair;
}

/// Collects images; the first error is kept.
class Album {
  public:
    void add(Result<TruePair> pair, const char* kind, bool fits) {
        if (!pair) {
            if (status_) status_ = pair.error();
            return;
        }
        fmt::print(stderr, "{}\n", pair->name);
        auto seen = see(*pair, kind, fits);
        if (seen)
            seen_.push_back(std::move(*seen));
        else if (status_)
            status_ = seen.error();
    }
    [[nodiscard]] const Status& status() const { return status_; }
    [[nodiscard]] const std::vector<Seen>& seen() const { return seen_; }

  private:
    Status status_;
    std::vector<Seen> seen_;
};

void add_simulated(Album& album, std::uint64_t seed, bool fits) {
    sim::SceneOptions options;
    options.profile = sim::CameraProfile::zed;
    options.seed = seed;
    for (const double noise : {1.0, 2.0}) {
        options.noise = noise;
        for (const char* scene : kScenes) {
            options.scene = scene;
            auto pair = simulated_pair(options);
            if (pair) forget_hidden(*pair);
            album.add(std::move(pair), noise < 1.5 ? "zed x 1" : "zed x 2", fits);
            ++options.seed;
        }
    }
}

Result<std::vector<Seen>> see_all(const std::string& data,
                                  std::uint64_t first_seed,
                                  std::uint64_t first_fit_seed) {
    Album album;
    auto pairs = middlebury_pairs(data + "/stereo");
    if (!pairs) return pairs.error();
    for (TruePair& pair : *pairs) {
        const bool fits = pair.name == "cones" || pair.name == "cloth3";
        for (std::size_t i = 0; i < pair.truth_px.size(); ++i)
            pair.truth_px.data()[i] += static_cast<float>(pair.truth_offset_px);
        album.add(std::move(pair), "Middlebury", fits);
    }
    const std::string bumblebee = data + "/real/bumblebee_pairs/";
    for (const char* name :
         {"chair01", "stones01", "wall01", "garden01", "lantern01", "sundial01"}) {
        const std::string scene = name;
        album.add(real_pair(name, bumblebee + scene + "_l.png", bumblebee + scene + "_r.png", 128),
                  "Bumblebee",
                  scene == "chair01" || scene == "stones01" || scene == "wall01");
    }
    const std::string walk = data + "/real/garden_walk/";
    const auto walk_rig = io::read_rig(walk + "rig.yaml");
    if (!walk_rig) return walk_rig.error();
    for (int frame = 5; frame <= 120; frame += 11)
        album.add(side_by_side(fmt::format("garden_walk {}", frame),
                               fmt::format("{}frame{:04}.png", walk, frame),
                               *walk_rig),
                  "garden_walk",
                  frame <= 60);
    const std::string office = data + "/sequences/zed_office/";
    const auto office_rig = io::read_rig(office + "rig.yaml");
    if (!office_rig) return office_rig.error();
    for (const int frame : {1, 5})
        album.add(side_by_side(fmt::format("zed_office {}", frame),
                               fmt::format("{}ZED_image{}.png", office, frame),
                               *office_rig),
                  "zed_office",
                  false);
    const std::string city = data + "/sequences/kitti_city/";
    for (const int frame : {0, 25, 50})
        album.add(real_pair(fmt::format("kitti_city {}", frame),
                            fmt::format("{}image_0/{:06}.png", city, frame),
                            fmt::format("{}image_1/{:06}.png", city, frame),
                            128),
                  "kitti_city",
                  false);
    add_simulated(album, first_fit_seed, true);
    add_simulated(album, first_seed, false);
    if (!album.status()) return album.status().error();
    return album.seen();
}

/// Fits the logistic function by Newton's method (iteratively reweighted least squares). Matches on
/// the near side of a jump and isolated matches take no part: a policy rates them.
Terms fitted(const std::vector<Seen>& all) {
    Terms c = Terms::Zero();
    for (int round = 0; round < 30; ++round) {
        Terms slope = Terms::Zero();
        Eigen::Matrix<double, 5, 5> curvature = 1e-9 * Eigen::Matrix<double, 5, 5>::Identity();
        for (const Seen& seen : all) {
            if (!seen.fits) continue;
            const bool simulated = seen.kind.starts_with("zed x");
            const double weight =
                (simulated ? 1.0 : kWeightOfReal) /
                static_cast<double>(std::max<std::size_t>(seen.matches.size(), 1));
            for (const Match& match : seen.matches) {
                if (match.evidence.nearer_by_px > stereo::kNearSideStep_px || match.isolated)
                    continue;
                const Terms x = terms_of(match.evidence);
                const double p = 1.0 / (1.0 + std::exp(-c.dot(x)));
                slope += weight * ((match.error_px > 1.0 ? 1.0 : 0.0) - p) * x;
                curvature += weight * p * (1.0 - p) * x * x.transpose();
            }
        }
        c += curvature.ldlt().solve(slope);
    }
    return c;
}

void report(const std::string& folder, const std::vector<Seen>& all) {
    auto out = fmt::output_file(folder + "/trust.csv");
    out.print("image,kind,use,matches,kept,wrong,wrong_trusted\n");
    for (const Seen& seen : all) {
        double right = 0.0, kept = 0.0, wrong = 0.0, trusted = 0.0, wrong_trusted = 0.0;
        for (const Match& match : seen.matches) {
            const bool trusts = match.probability <= kTrustedOutlierProbability;
            right += match.error_px <= 1.0 ? 1.0 : 0.0;
            kept += match.error_px <= 1.0 && trusts ? 1.0 : 0.0;
            wrong += match.error_px > 2.0 ? 1.0 : 0.0;
            trusted += trusts ? 1.0 : 0.0;
            wrong_trusted += match.error_px > 2.0 && trusts ? 1.0 : 0.0;
        }
        out.print(
            "{},{},{},{},{:.1f},{:.2f},{:.2f}\n",
            seen.name,
            seen.kind,
            seen.fits ? "fit" : "report",
            seen.matches.size(),
            100.0 * kept / std::max(right, 1.0),
            100.0 * wrong / static_cast<double>(std::max<std::size_t>(seen.matches.size(), 1)),
            100.0 * wrong_trusted / std::max(trusted, 1.0));
    }
}

void report_reliability(const std::string& folder, const std::vector<Seen>& all) {
    struct Bin {
        double stated = 0.0;
        double wrong = 0.0;
        double matches = 0.0;
    };
    auto out = fmt::output_file(folder + "/reliability.csv");
    out.print("kind,use,stated,wrong,matches\n");
    std::vector<std::pair<std::string, bool>> groups;
    for (const Seen& seen : all) {
        const std::pair group(seen.kind, seen.fits);
        if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
    }
    for (const auto& [kind, fits] : groups) {
        std::array<Bin, kBins.size() - 1> bins{};
        for (const Seen& seen : all) {
            if (seen.kind != kind || seen.fits != fits) continue;
            for (const Match& match : seen.matches) {
                const auto p = static_cast<double>(match.probability);
                const auto above = std::upper_bound(kBins.begin() + 1, kBins.end() - 1, p);
                Bin& bin = bins[static_cast<std::size_t>(above - kBins.begin() - 1)];
                bin.stated += p;
                bin.wrong += match.error_px > 1.0 ? 1.0 : 0.0;
                bin.matches += 1.0;
            }
        }
        for (const Bin& bin : bins) {
            if (bin.matches < 100.0) continue;  // too few for a share
            out.print("{},{},{:.2f},{:.2f},{:.0f}\n",
                      kind,
                      fits ? "fit" : "report",
                      100.0 * bin.stated / bin.matches,
                      100.0 * bin.wrong / bin.matches,
                      bin.matches);
        }
    }
}

Status run(const std::string& data,
           const std::string& folder,
           std::uint64_t first_seed,
           std::uint64_t first_fit_seed) {
    const auto all = see_all(data, first_seed, first_fit_seed);
    if (!all) return all.error();
    fmt::print("fitted: {:.2f}\n", fmt::join(fitted(*all), " "));
    report(folder, *all);
    report_reliability(folder, *all);
    return {};
}

}  // namespace
}  // namespace surefoot::experiments

// An uncaught exception ends the experiment and prints its message. This is intended.
int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape)
    using namespace surefoot;
    if (argc < 4) {
        fmt::print(stderr, "usage: trust DATA_DIR OUT_DIR FIRST_SEED [FIRST_FIT_SEED]\n");
        return 2;
    }
    cv::setNumThreads(1);
    const auto seed = [&](int i) { return std::strtoull(argv[i], nullptr, 10); };
    const auto done = experiments::run(argv[1], argv[2], seed(3), argc > 4 ? seed(4) : 21);
    return done ? 0 : app::report(done.error());
}
