// SPDX-License-Identifier: Apache-2.0
#include "surefoot/stereo/finisher.hpp"

#include "surefoot/stereo/confidence.hpp"
#include "surefoot/stereo/consistency.hpp"

namespace surefoot::stereo {

void Finisher::finish(ImageView<const std::uint8_t> left,
                      ImageView<const std::uint8_t> right,
                      const Image<float>& found_px,
                      Filter filter,
                      Executor& executor,
                      DepthImage& depth) {
    mark_jumps(executor, found_px, kJump_px, jumps_);
    distance_to_marks(executor, jumps_, jump_distance_px_);
    smallest_nearby(executor, found_px, smallest_px_);
    count_unknown(executor, found_px, kNeighbourhoodRadius_px, unknown_);
    refiner_.refine(left,
                    right,
                    found_px,
                    filter,
                    jump_distance_px_,
                    executor,
                    depth.disparity_px,
                    [&](int v, const RefinedRow& refined) {
                        rate_matches(v, refined, jump_distance_px_, unknown_, smallest_px_, depth);
                    });
    isolated_.doubt(depth);
}

}  // namespace surefoot::stereo
