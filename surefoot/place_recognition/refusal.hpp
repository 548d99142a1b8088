// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace surefoot::place_recognition {

/// Why a view was not taken for a place that is remembered; the first that applies.
enum class Refusal : std::uint8_t {
    none,          ///< recognised
    few_features,  ///< too little structure with depth in the image
    no_candidate,  ///< no keyframe has descriptors like these
    few_matches,   ///< too few descriptors are each other's best
    few_inliers,   ///< too few of them agree on one pose
    poor_spread,   ///< those that agree cover too little of the image
    imprecise,     ///< they leave the pose open
    tilted,        ///< gravity would point elsewhere
    contradicted,  ///< parts of the image show something else than the place does
    floor_only,    ///< what agrees is one level surface; a printed floor lies elsewhere too
    ambiguous,     ///< another place explains the view nearly as well
    unconfirmed,   ///< right so far, but the views after it have not said so yet
    inconsistent,  ///< does not fit what odometry and the places before it say
};
inline constexpr int kRefusals = 13;
[[nodiscard]] const char* to_string(Refusal refusal) noexcept;

}  // namespace surefoot::place_recognition
