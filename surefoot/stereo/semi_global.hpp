// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "surefoot/core/executor.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::stereo {

/// Penalties of the semi-global search, in differing bits of a census word. They were chosen on
/// cones, cloth3 and simulated images with seeds 21-30 (docs/lab/matching.md).
struct SemiGlobalConfig {
    int disparities = 64;       ///< searches 0 ... disparities - 1; at most 256
    int slope_penalty = 11;     ///< P1: cost of a disparity change of 1 from pixel to pixel
    int jump_penalty = 50;      ///< P2: cost of a larger disparity change where the image is flat
    int contrast_shift = 0;     ///< a grey step lowers P2 by |grey step| / 2^contrast_shift
    int min_jump_penalty = 10;  ///< lower limit of P2

    [[nodiscard]] std::optional<std::string> problem() const;
};

/// A level is searched with the help of a level of half its size if half its width, rounded down,
/// is at least this [px].
inline constexpr int kLeastLevelWidth_px = 200;
/// Side [px] of the blocks that share one range of disparities.
inline constexpr int kBlockSide_px = 64;
/// A range begins at a multiple of this number. It ends at a multiple or at the last disparity.
inline constexpr int kRangeStep = 8;
/// A disparity of the smaller level is hopeless where its sum of costs lies at least this far above
/// the least sum of the pixel.
inline constexpr int kHopeless = 20;
/// Number of disparities by which a range extends beyond the hopeful disparities.
inline constexpr int kRangeMargin = 2;
/// The smaller level adds (sum of costs - least sum) / 2^kPriorShift to the matching cost.
inline constexpr int kPriorShift = 5;
/// The largest such prior. A disparity outside the range of the smaller level has this prior.
inline constexpr int kMaxPrior = 255 >> kPriorShift;

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
/// from the left, the right, above and below. Costs are bytes; sums end at 255. Beyond the left
/// border the right image repeats its first column. Of equal costs the smallest disparity wins.
///
/// The search goes from coarse to fine. Each level has half the size of the next (means of 2 x 2
/// pixels). The sums of a level enter the next level twice: as a prior, which is added to the
/// matching costs (so weak texture is matched by what a larger area shows), and as a range of
/// disparities for each block of kBlockSide_px. A range reaches from the smallest to the largest
/// disparity that is hopeful at one pixel or more of the block in the smaller level, plus
/// kRangeMargin. Disparities that the smaller level did not search are hopeless.
///
/// This slow, plain version defines the result of the fast SemiGlobalSearch.
void search_plainly(const SemiGlobalConfig& config,
                    ImageView<const std::uint8_t> left,
                    ImageView<const std::uint8_t> right,
                    Winners& out);

/// Means of 2 x 2 pixels, rounded; the last column and row repeat where the size is odd.
void halve(ImageView<const std::uint8_t> in, GreyImage& out);

/// Fast version of search_plainly, with the same bytes. The lanes hold 64 rows (for paths along
/// rows) or 64 columns, so that no step needs a neighbouring lane. The cost volume covers only
/// 64 x 64 pixels and stays in the cache; a smaller level also stores its priors, by rows and by
/// columns. Run-time dispatch picks the widest instructions of the
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
