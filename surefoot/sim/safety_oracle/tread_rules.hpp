// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/sim/safety_oracle/inspection.hpp"

/// The rules of the safety oracle for movements of class stair. The foot is longer than a tread, so
/// a part of it may hang over the nosing.
namespace surefoot::sim::rules {

/// A foot on the tread under its ankle.
struct FootOnTread {
    /// The ankle area has ground: a strip as wide as the foot and as long as a patch.
    bool known = false;
    double level_m = 0.0;  ///< median height of the ankle area, in the world
    /// The ground under the part of the foot that rests on the tread: from the ankle to both sides,
    /// until a row of samples across the foot has a sample that lies a drop below the level.
    FootGround carried;
    Rect carried_box;  ///< this part, in base_link; empty if it does not hold the ankle area
    double heel_over_m = 0.0;  ///< length that hangs over at the heel
    double toe_over_m = 0.0;
    /// The highest sample above the level under the whole foot, and its height above the level.
    Eigen::Vector2d highest_field_m = Eigen::Vector2d::Zero();
    double highest_m = 0.0;

    [[nodiscard]] double carried_m() const;  ///< length of the carried part
    [[nodiscard]] double over_m() const;     ///< the longer one of both overhangs
};
[[nodiscard]] FootOnTread foot_on_tread(const GroundField& field,
                                        const Rect& foot,
                                        const Figures& figures,
                                        const PlanarPose& T_field_body);

/// Finds the stance on treads: a level plane at the mean level of both ankles. `void_at_m` is set
/// for a foot of which too little rests on its tread.
[[nodiscard]] Stance stand_on_treads(const GroundField& field,
                                     const Figures& figures,
                                     const PlanarPose& T_field_body);

/// Tests the ground of a step from tread to tread. Requires a known stance.
void check_tread_step(Inspection& at);

}  // namespace surefoot::sim::rules
