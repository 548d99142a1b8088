// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/calibration/lenses/lens.hpp"

namespace surefoot::calibration {

/// How well a kind of lens explains boards that it was not fitted to.
struct LensTrial {
    LensKind kind = LensKind::pinhole5;
    /// Median over the views of their rms [px]; infinite where the lens shows less than half of
    /// them at all.
    double rms_px = 0.0;
};

/// Another kind of lens that explains the boards clearly better than the chosen one.
struct LensAdvice {
    LensTrial chosen;
    LensTrial better;
};

/// Fits a kind of lens to every second view and shows it the others, and the other way round; with
/// fewer than eight views it is fitted to those that it is shown. At most 16 views are used.
/// Nothing with fewer than three usable views.
[[nodiscard]] std::optional<LensTrial> try_lens(const Board& board,
                                                std::span<const BoardView> views,
                                                ImageSize size,
                                                LensKind kind);

/// Compares the chosen kind of lens with pinhole5, fisheye and rational. Another kind is named when
/// its rms is below 0.7 of the chosen one's and at least 0.02 px smaller; among those that explain
/// the boards about equally well (10 %) the first in this order.
[[nodiscard]] std::optional<LensAdvice> advise_lens(const Board& board,
                                                    std::span<const BoardView> views,
                                                    ImageSize size,
                                                    LensKind chosen);

/// "this lens looks like a fisheye (rms 0.21 px against 4.70 px with pinhole5): try --model
/// fisheye".
[[nodiscard]] std::string in_words(const LensAdvice& advice);

}  // namespace surefoot::calibration
