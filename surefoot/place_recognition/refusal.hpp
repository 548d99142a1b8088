// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace surefoot::place_recognition {

/// First reason why a view was not recognised as a stored place, in the order of the checks.
enum class Refusal : std::uint8_t {
    none,          ///< recognised
    few_features,  ///< the image has too little structure with depth
    no_candidate,  ///< no keyframe has similar descriptors
    few_matches,   ///< too few descriptors are each other's best match
    few_inliers,   ///< too few of the matches agree on one pose
    poor_spread,   ///< the inliers cover too little of the image
    imprecise,     ///< the inliers do not determine the pose well enough
    tilted,        ///< the up directions of the view and the keyframe differ
    contradicted,  ///< parts of the image show something other than the stored place
    floor_only,    ///< too few features off the floor agree; a printed floor may repeat
    ambiguous,     ///< another place explains the view more than half as well
    unconfirmed,   ///< accepted so far, but later views have not confirmed it yet
    inconsistent,  ///< contradicts odometry or earlier recognitions
};
inline constexpr int kRefusals = 13;
[[nodiscard]] const char* to_string(Refusal refusal) noexcept;

}  // namespace surefoot::place_recognition
