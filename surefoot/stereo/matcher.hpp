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
    census,  ///< ours: semi-global on census words
    sgbm,    ///< OpenCV's semi-global matcher
    bm,      ///< OpenCV's block matcher: fast, and lost where texture is weak
};
inline constexpr const char* kAlgorithmNames[] = {"census", "sgbm", "bm"};

/// Along how many paths OpenCV's semi-global matcher sums its costs.
enum class SgbmMode : std::uint8_t {
    three_way,  ///< from the left, from above, from the right
    hh4,        ///< four, along rows and columns
    hh,         ///< eight; holds the costs of the whole image
};
inline constexpr const char* kSgbmModeNames[] = {"three_way", "hh4", "hh"};

struct MatcherConfig {
    Algorithm algorithm = Algorithm::census;
    int disparities = 64;  ///< search range [px], a multiple of 16; KITTI-size images want 96-128
    int block_size = 3;    ///< odd; sgbm alone
    SgbmMode sgbm_mode = SgbmMode::three_way;
    /// Odd; bm alone. Its fast loops go up to 21, and to a prefilter of 31.
    int bm_block_size = 15;
    int bm_prefilter_cap = 31;
    int uniqueness_percent = 5;
    double left_right_tolerance_px = 1.0;
    void describe(ConfigVisitor& visitor);
    /// First reason why it cannot be used, with the value; or nothing.
    [[nodiscard]] std::optional<std::string> problem() const;
};

/// Dense matching of a rectified pair. An implementation is deterministic for every executor.
class Matcher {
  public:
    virtual ~Matcher() = default;
    /// Writes disparity, sigma and outlier probability for every pixel of `left` into `depth`.
    /// Both images must have the same size. Where there is no match, disparity and sigma are NaN
    /// and the outlier probability is 1.
    virtual void match(ImageView<const std::uint8_t> left,
                       ImageView<const std::uint8_t> right,
                       Executor& executor,
                       DepthImage& depth) = 0;
};

/// OpenCV's semi-global matcher with our left-right check, sub-pixel refinement, sigma and outlier
/// probability. `config` must have no problem().
[[nodiscard]] std::unique_ptr<Matcher> make_sgbm_matcher(const MatcherConfig& config);

/// The same behind OpenCV's block matcher.
[[nodiscard]] std::unique_ptr<Matcher> make_bm_matcher(const MatcherConfig& config);

/// SemiGlobalSearch, its winners settled, speckles removed, then as above.
[[nodiscard]] std::unique_ptr<Matcher> make_census_matcher(const MatcherConfig& config);

/// The one that `config.algorithm` names.
[[nodiscard]] std::unique_ptr<Matcher> make_matcher(const MatcherConfig& config);

}  // namespace surefoot::stereo
