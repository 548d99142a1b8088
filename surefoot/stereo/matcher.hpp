// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "surefoot/core/config.hpp"
#include "surefoot/core/depth_image.hpp"
#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::stereo {

enum class Algorithm : std::uint8_t {
    census,  ///< our semi-global matcher on census words
    sgbm,    ///< OpenCV's semi-global matcher
    bm,      ///< OpenCV's block matcher: fast, but unreliable on weak texture
};
inline constexpr const char* kAlgorithmNames[] = {"census", "sgbm", "bm"};
/// Returns the longest search range of an algorithm [px].
[[nodiscard]] constexpr int longest_range_px(Algorithm algorithm) noexcept {
    return algorithm == Algorithm::census ? 256 : 512;
}

/// Number and directions of the paths along which OpenCV's semi-global matcher sums costs.
enum class SgbmMode : std::uint8_t {
    three_way,  ///< three paths: from the left, from above, from the right
    hh4,        ///< four paths, along rows and columns
    hh,         ///< eight paths; keeps the costs of the whole image in memory
};
inline constexpr const char* kSgbmModeNames[] = {"three_way", "hh4", "hh"};

struct MatcherConfig {
    Algorithm algorithm = Algorithm::census;
    int disparities = 64;  ///< search range [px], a multiple of 16; KITTI-size images need 96-128
    int block_size = 3;    ///< side of the matching window [px], odd; for sgbm only
    SgbmMode sgbm_mode = SgbmMode::three_way;
    /// Window side [px], odd; bm only. OpenCV is fast up to a side of 21 and a prefilter cap of 31.
    int bm_block_size = 15;
    int bm_prefilter_cap = 31;
    int uniqueness_percent = 5;
    double left_right_tolerance_px = 1.0;
    void describe(ConfigVisitor& visitor);
    /// Returns a text about the first invalid setting and its value, or nothing if all are valid.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// Matches all pixels of a rectified pair. Every executor gives the same result, byte for byte.
class Matcher {
  public:
    virtual ~Matcher() = default;
    /// Writes disparity, sigma and outlier probability of every pixel of `left` into `depth`. Both
    /// images must have the same size. A pixel without a match gets NaN as disparity and sigma, and
    /// an outlier probability of 1.
    virtual void match(ImageView<const std::uint8_t> left,
                       ImageView<const std::uint8_t> right,
                       Executor& executor,
                       DepthImage& depth) = 0;
};

/// Makes OpenCV's semi-global matcher with our left-right check, sub-pixel refinement, sigma and
/// outlier probability. `config` must have no problem().
[[nodiscard]] std::unique_ptr<Matcher> make_sgbm_matcher(const MatcherConfig& config);

/// Makes OpenCV's block matcher, followed by the same steps as make_sgbm_matcher.
[[nodiscard]] std::unique_ptr<Matcher> make_bm_matcher(const MatcherConfig& config);

/// Makes our semi-global matcher on census words; census_matcher.cpp shows its steps.
[[nodiscard]] std::unique_ptr<Matcher> make_census_matcher(const MatcherConfig& config);

/// Makes the matcher that `config.algorithm` names.
[[nodiscard]] std::unique_ptr<Matcher> make_matcher(const MatcherConfig& config);

}  // namespace surefoot::stereo
