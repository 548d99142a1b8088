// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::stereo {

/// Costs of the semi-global search. A path costs at most kCensusBits + jump_penalty. The sum of
/// three paths must stay below 255, because costs are stored in bytes.
struct SemiGlobalConfig {
    int disparities = 64;       ///< searches 0 ... disparities - 1; at most 256
    int slope_penalty = 11;     ///< P1: cost of a disparity change of 1 from pixel to pixel
    int jump_penalty = 54;      ///< P2: cost of a larger disparity change where the image is flat
    int contrast_shift = 0;     ///< a grey step lowers P2 by |grey step| / 2^contrast_shift
    int min_jump_penalty = 10;  ///< lower limit of P2

    [[nodiscard]] std::optional<std::string> problem() const;
};

/// Bits of a census word. A bit tells if a neighbour in a chequered 9 x 7 window is darker.
inline constexpr int kCensusBits = 30;

/// Number of rows by which disparities lag behind, because no path comes from below. On floor with
/// the ZED's noise the lag causes an error of 0.15 px (seed 21); the correction by two rows leaves
/// 0.008 px. The number was chosen on floor and cross_fall, seeds 21-24 (docs/lab/matching.md).
inline constexpr int kSearchLag_rows = 2;

/// Result of the search for every pixel of the left image: the disparity of least cost, and the
/// costs there and beside it. `second_cost`: least cost at least 2 disparities away (255 = none).
struct Winners {
    Image<std::uint8_t> disparity;
    Image<std::uint8_t> cost;
    Image<std::uint8_t> cost_below;  ///< cost at disparity - 1
    Image<std::uint8_t> cost_above;  ///< cost at disparity + 1
    Image<std::uint8_t> second_cost;

    void resize(int width, int height);
    friend bool operator==(const Winners&, const Winners&) = default;
};

/// Semi-global matching (Hirschmueller 2008) with census costs (Zabih and Woodfill 1994) and paths
/// from the left, the right and above, all in bytes. Beyond the left border the right image repeats
/// its first column. Of equal costs the smallest disparity wins.
///
/// This slow, plain version defines the result of the fast SemiGlobalSearch.
void search_plainly(const SemiGlobalConfig& config,
                    ImageView<const std::uint8_t> left,
                    ImageView<const std::uint8_t> right,
                    Winners& out);

/// Fast version of search_plainly, with the same bytes. The lanes hold 64 rows (for paths along
/// rows) or 64 columns, so that no step needs a neighbouring lane. The cost volume covers only
/// 64 x 64 pixels and stays in the cache. Run-time dispatch picks the widest instructions of the
/// processor. Threads work on strips of rows. After the first pair of a size nothing is allocated.
class SemiGlobalSearch {
  public:
    /// `config` must have no problem().
    explicit SemiGlobalSearch(const SemiGlobalConfig& config);
    ~SemiGlobalSearch();
    SemiGlobalSearch(SemiGlobalSearch&&) noexcept;
    SemiGlobalSearch& operator=(SemiGlobalSearch&&) noexcept;

    /// Searches the disparities of a pair. Both images must have the same size and not be empty.
    void search(ImageView<const std::uint8_t> left,
                ImageView<const std::uint8_t> right,
                Executor& executor,
                Winners& out);

  private:
    struct Workspace;
    std::unique_ptr<Workspace> workspace_;
};

}  // namespace surefoot::stereo
