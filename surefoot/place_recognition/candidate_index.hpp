// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "surefoot/place_recognition/place.hpp"

namespace surefoot::place_recognition {

/// A keyframe that may show the same place as a view.
struct Candidate {
    int keyframe = 0;
    std::int64_t votes = 0;  ///< more votes = more similar; comparable within one query only
};

/// Finds the keyframes whose descriptors resemble those of a view, without comparing all of them.
/// Descriptors that agree in 16 chosen bits share a bucket, in eight tables (locality sensitive
/// hashing, Indyk and Motwani 1998). The more descriptors share a bucket, the less one vote counts;
/// crowded buckets (texture of any wall) are ignored. Memory: 3.1 MB plus at most 256 bytes per
/// feature; the bytes per feature fall with the number of features.
class CandidateIndex {
  public:
    CandidateIndex();
    /// Adds a keyframe; its number must be below kMostKeyframes.
    void add(int keyframe, std::span<const Feature> features);
    /// Returns the keyframes below `end` with votes, most votes first. Equal votes: older first.
    [[nodiscard]] std::vector<Candidate> find(std::span<const Feature> features, int end) const;

  private:
    /// Part of a bucket, half a cache line long. Single entries spread over the memory would take
    /// two thirds of a query's time to read.
    struct Chunk {
        std::array<std::uint16_t, 14> keyframes{};
        std::int32_t next = -1;  ///< number of the next full chunk, -1 = none
    };
    static_assert(sizeof(Chunk) == 32);

    std::vector<std::int32_t> first_;   ///< first chunk of each bucket, -1 = none; table by table
    std::vector<std::uint16_t> sizes_;  ///< sizes of the buckets, at most kCrowded
    std::vector<Chunk> chunks_;
};

}  // namespace surefoot::place_recognition
