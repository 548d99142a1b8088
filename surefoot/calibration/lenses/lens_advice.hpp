// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "surefoot/calibration/boards/board.hpp"
#include "surefoot/calibration/lenses/lens.hpp"

namespace surefoot::calibration {

/// Error of a lens kind, from the cross-validation of try_lens.
struct LensTrial {
    LensKind kind = LensKind::pinhole5;
    /// Median of the rms values of the views [px]; infinite unless the lens can image more than
    /// half of the views.
    double rms_px = 0.0;
};

/// A lens kind that explains the boards clearly better than the chosen kind.
struct LensAdvice {
    LensTrial chosen;
    LensTrial better;
};

/// Cross-validation: fits the lens kind to every second view and tests it on the others, then vice
/// versa. With fewer than eight views, fits and tests on the same views. Uses at most 16 views.
/// Returns nullopt with fewer than three usable views.
[[nodiscard]] std::optional<LensTrial> try_lens(const Board& board,
                                                std::span<const BoardView> views,
                                                ImageSize size,
                                                LensKind kind);

/// Compares the chosen lens kind with pinhole5, fisheye and rational. Advises another kind if its
/// rms is below 0.7 times the rms of the chosen kind and at least 0.02 px smaller. If several kinds
/// are within 10 % of the best rms, advises the first of them in this order.
[[nodiscard]] std::optional<LensAdvice> advise_lens(const Board& board,
                                                    std::span<const BoardView> views,
                                                    ImageSize size,
                                                    LensKind chosen);

/// Advice text: "this lens looks like a fisheye (rms 0.21 px against 4.70 px with pinhole5): try
/// --model fisheye".
[[nodiscard]] std::string in_words(const LensAdvice& advice);

}  // namespace surefoot::calibration
