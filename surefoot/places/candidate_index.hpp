// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/places/place.hpp"

namespace surefoot::places {

/// A keyframe that may show what a view shows.
struct Candidate {
    int keyframe = 0;
    std::int64_t votes = 0;  ///< more = more alike; comparable within one query only
};

/// Which keyframes have descriptors like those of a view, without comparing with all of them:
/// descriptors that agree in 16 chosen bits share a bucket, in eight tables (locality sensitive
/// hashing, Indyk and Motwani 1998). A vote counts less the more descriptors share the bucket;
/// crowded buckets (what every wall shows) are not asked. 2.1 MB, and 64 bytes a feature.
class CandidateIndex {
  public:
    CandidateIndex();
    void add(int keyframe, std::span<const Feature> features);
    /// The keyframes below `end` by falling votes, of equal ones the older first.
    [[nodiscard]] std::vector<Candidate> find(std::span<const Feature> features, int end) const;

  private:
    struct Entry {
        std::int32_t keyframe = 0;
        std::int32_t next = -1;
    };
    std::vector<std::int32_t> first_;   ///< entry of each bucket, -1 = none; table by table
    std::vector<std::uint16_t> sizes_;  ///< of the buckets, at most kCrowded
    std::vector<Entry> entries_;
};

}  // namespace surefoot::places
