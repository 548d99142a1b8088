// SPDX-License-Identifier: Apache-2.0
#include "surefoot/place_recognition/candidate_index.hpp"

#include <algorithm>
#include <array>
#include <numeric>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/rng.hpp"

namespace surefoot::place_recognition {
namespace {

constexpr std::size_t kTables = 8;
constexpr std::size_t kChunk = 14;
constexpr std::size_t kKeyBits = 16;
constexpr std::size_t kBuckets = std::size_t{1} << kKeyBits;
constexpr std::uint16_t kCrowded = 200;  ///< number of entries from which a bucket is ignored
/// A vote is this number divided by the size of the bucket.
constexpr std::int64_t kVoteScale = 50400;
constexpr std::uint64_t kBitSeed = 256;

using Key = std::array<std::uint8_t, kKeyBits>;  ///< indices of the chosen bits of a descriptor

/// Draws the bits of each table; a table has no bit twice. The seed is fixed, so every machine gets
/// the same bits.
std::array<Key, kTables> draw_keys() {
    std::array<Key, kTables> keys{};
    Rng rng(kBitSeed);
    std::array<std::uint8_t, 256> bits{};
    std::iota(bits.begin(), bits.end(), std::uint8_t{0});
    for (Key& key : keys) {
        for (std::size_t i = 0; i < kKeyBits; ++i) {
            std::swap(bits[i], bits[i + rng.below(bits.size() - i)]);
            key[i] = bits[i];
        }
    }
    return keys;
}

/// Returns the bucket number of a descriptor, counted through all tables.
std::size_t bucket_of(std::size_t table, const Descriptor& descriptor) {
    static const std::array<Key, kTables> keys = draw_keys();
    std::size_t bucket = 0;
    for (const std::uint8_t bit : keys[table])
        bucket = bucket << 1U | (descriptor.bits[bit / 64U] >> (bit % 64U) & 1U);
    return table * kBuckets + bucket;
}

}  // namespace

CandidateIndex::CandidateIndex() : first_(kTables * kBuckets, -1), sizes_(kTables * kBuckets, 0) {}

void CandidateIndex::add(int keyframe, std::span<const Feature> features) {
    SUREFOOT_ASSERT(keyframe >= 0 && keyframe < kMostKeyframes);
    for (const Feature& feature : features) {
        for (std::size_t table = 0; table < kTables; ++table) {
            const std::size_t bucket = bucket_of(table, feature.descriptor);
            if (sizes_[bucket] == kCrowded) continue;
            const std::size_t at = sizes_[bucket]++ % kChunk;
            if (at == 0) {
                chunks_.push_back({{}, first_[bucket]});
                first_[bucket] = static_cast<std::int32_t>(chunks_.size()) - 1;
            }
            chunks_[static_cast<std::size_t>(first_[bucket])].keyframes[at] =
                static_cast<std::uint16_t>(keyframe);
        }
    }
}

std::vector<Candidate> CandidateIndex::find(std::span<const Feature> features, int end) const {
    std::array<std::int64_t, kMostKeyframes> votes{};
    for (const Feature& feature : features) {
        for (std::size_t table = 0; table < kTables; ++table) {
            const std::size_t bucket = bucket_of(table, feature.descriptor);
            if (sizes_[bucket] == 0 || sizes_[bucket] == kCrowded) continue;
            const std::int64_t vote = kVoteScale / sizes_[bucket];
            std::size_t held = (sizes_[bucket] - 1U) % kChunk + 1;  // entries in the first chunk
            for (std::int32_t at = first_[bucket]; at >= 0;) {
                const Chunk& chunk = chunks_[static_cast<std::size_t>(at)];
                for (std::size_t i = 0; i < held; ++i) votes[chunk.keyframes[i]] += vote;
                at = chunk.next;
                held = kChunk;
            }
        }
    }
    std::vector<Candidate> candidates;
    for (int keyframe = 0; keyframe < std::min(end, kMostKeyframes); ++keyframe)
        if (const std::int64_t all = votes[static_cast<std::size_t>(keyframe)]; all > 0)
            candidates.push_back({keyframe, all});
    std::stable_sort(candidates.begin(),
                     candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.votes > b.votes; });
    return candidates;
}

}  // namespace surefoot::place_recognition
