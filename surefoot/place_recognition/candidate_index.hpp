// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/place_recognition/place.hpp"

namespace surefoot::place_recognition {

/// A keyframe that may show what a view shows.
struct Candidate {
    int keyframe = 0;
    std::int64_t votes = 0;  ///< more = more alike; comparable within one query only
};

/// Which keyframes have descriptors like those of a view, without comparing with all of them:
/// descriptors that agree in 16 chosen bits share a bucket, in eight tables (locality sensitive
/// hashing, Indyk and Motwani 1998). A vote counts less the more descriptors share the bucket;
/// crowded buckets (what every wall shows) are not asked. 3.1 MB, and at most 256 bytes a feature;
/// the more features, the fewer.
class CandidateIndex {
  public:
    CandidateIndex();
    /// `keyframe` is below kMostKeyframes.
    void add(int keyframe, std::span<const Feature> features);
    /// The keyframes below `end` by falling votes, of equal ones the older first.
    [[nodiscard]] std::vector<Candidate> find(std::span<const Feature> features, int end) const;

  private:
    /// Part of a bucket, half a cache line: entries one by one, all over the memory, were two
    /// thirds of a query's time.
    struct Chunk {
        std::array<std::uint16_t, 14> keyframes{};
        std::int32_t next = -1;  ///< a full one, -1 = none
    };
    static_assert(sizeof(Chunk) == 32);

    std::vector<std::int32_t> first_;   ///< chunk of each bucket, -1 = none; table by table
    std::vector<std::uint16_t> sizes_;  ///< of the buckets, at most kCrowded
    std::vector<Chunk> chunks_;
};

}  // namespace surefoot::place_recognition
