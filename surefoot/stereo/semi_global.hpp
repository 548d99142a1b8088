// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::stereo {

/// Costs of the semi-global search. A path may carry at most kCensusBits + jump_penalty, and the
/// sum of three paths must stay below 255: everything is counted in bytes.
struct SemiGlobalConfig {
    int disparities = 64;       ///< 0 ... disparities - 1 are searched; at most 256
    int slope_penalty = 11;     ///< P1: disparity changes by one from pixel to pixel
    int jump_penalty = 54;      ///< P2: it changes by more, where the image is flat ...
    int contrast_shift = 0;     ///< ... less |grey step| / 2^shift ...
    int min_jump_penalty = 10;  ///< ... but at least this

    [[nodiscard]] std::optional<std::string> problem() const;
};

/// Bits of a census word: neighbours in a chequered 9 x 7 window that are darker than the pixel.
inline constexpr int kCensusBits = 30;

/// The paths come from the left, the right and above, not from below: on floor with the noise of
/// the ZED what is found is 0.14 px late. Two rows leave less than 0.01 px of it (docs/lab/
/// matching.md; lab/pixel_locking/main, floor and cross_fall, seeds 21-24).
inline constexpr int kSearchLag_rows = 2;

/// What the search says about every pixel of the left image: the disparity of least cost, the costs
/// there, beside it, and of the best disparity that is at least 2 away (255 = there is none).
struct Winners {
    Image<std::uint8_t> disparity;
    Image<std::uint8_t> cost;
    Image<std::uint8_t> cost_below;  ///< at disparity - 1
    Image<std::uint8_t> cost_above;  ///< at disparity + 1
    Image<std::uint8_t> second_cost;

    void resize(int width, int height);
    friend bool operator==(const Winners&, const Winners&) = default;
};

/// Semi-global matching (Hirschmueller 2008) with census costs (Zabih and Woodfill 1994), paths
/// from the left, from the right and from above, all in bytes. Left of the right image stands its
/// first column. Of equal costs the smallest disparity wins.
///
/// The plain version: slow, and the meaning of the fast one below.
void search_plainly(const SemiGlobalConfig& config,
                    ImageView<const std::uint8_t> left,
                    ImageView<const std::uint8_t> right,
                    Winners& out);

/// The same bytes, fast: 64 rows (for the paths along rows) or 64 columns side by side in a
/// register, so that no step needs its neighbour lane, and no cost volume but that of 64 x 64
/// pixels, which stays in the cache. Run time dispatch picks the widest instructions of the
/// processor; threads share strips of rows. Nothing is allocated after the first pair of a size.
class SemiGlobalSearch {
  public:
    /// `config` must have no problem().
    explicit SemiGlobalSearch(const SemiGlobalConfig& config);
    ~SemiGlobalSearch();
    SemiGlobalSearch(SemiGlobalSearch&&) noexcept;
    SemiGlobalSearch& operator=(SemiGlobalSearch&&) noexcept;

    /// Both images must have the same size and not be empty.
    void search(ImageView<const std::uint8_t> left,
                ImageView<const std::uint8_t> right,
                Executor& executor,
                Winners& out);

  private:
    struct Workspace;
    std::unique_ptr<Workspace> workspace_;
};

}  // namespace surefoot::stereo
