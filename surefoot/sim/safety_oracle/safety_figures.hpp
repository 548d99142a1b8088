// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "surefoot/core/machine.hpp"
#include "surefoot/sim/motion/planar.hpp"
#include "surefoot/sim/scenes/primitives.hpp"

namespace surefoot::sim::rules {

/// The machine's dimensions and limits for one movement, in metres and radians.
struct Figures {
    std::array<Rect, 2> feet;  ///< rectangles of the feet, in base_link
    /// A part of the body: its box in base_link, without sway, and its heights above the soles.
    struct Part {
        Rect box;
        double low_m = 0.0;
        double high_m = 0.0;
    };
    std::vector<Part> body;
    double sway_m = 0.0;
    double lower_edge_m = 0.0;  ///< lower edge of the whole body, above the soles
    double height_m = 0.0;      ///< height of the whole body, above the soles
    double hips_m = 0.0;        ///< height of base_link above the soles
    double up_m = 0.0;
    double down_m = 0.0;
    double tilt_rad = 0.0;
    double patch_side_m = 0.0;
    double residual_m = 0.0;
    double clearance_m = 0.0;  ///< highest object that a swinging foot passes over
    double swing_m = 0.0;      ///< the same, above the higher one of two treads
    double foot_margin_m = 0.0;
    double drop_m = 0.0;
    double band_m = 0.0;
    /// A foot on a tread, for movements of class stair.
    struct Treads {
        double ankle_from_heel_m = 0.0;
        double share = 1.0;       ///< smallest share of a foot's length that its tread carries
        double overhang_m = 0.0;  ///< largest length of a foot beyond one end of its tread
    };
    std::optional<Treads> treads;
    PlanarPose T_start_target;

    /// Surfaces up to this height above the stance count as ground. On stairs these are two more
    /// treads.
    [[nodiscard]] double reach_m() const { return treads ? 2.5 * up_m + swing_m : lower_edge_m; }
};
/// Returns nullptr if the machine has no such movement, or if the class of the movement is
/// disabled.
[[nodiscard]] const Movement* movement_of(const Machine& machine, int command);
[[nodiscard]] Figures figures_of(const Machine& machine, const Movement& movement);

/// Multiplies limits by 1 - share: stricter for share > 0, looser for share < 0. Required distances
/// (band, margin, sway) grow where limits shrink. The user becomes taller by `taller_m`.
[[nodiscard]] Figures stricter(const Figures& figures, double share, double taller_m);

/// Region that the rules read for base_link at the origin of the field, plus `slack_m`.
[[nodiscard]] Rect region_of(const Figures& figures, double slack_m);

}  // namespace surefoot::sim::rules
