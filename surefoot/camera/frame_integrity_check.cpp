// SPDX-License-Identifier: Apache-2.0
#include "surefoot/camera/frame_integrity_check.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace surefoot::camera {
namespace {

/// Hashes eight bytes at a time with the multiply and rotate of xxHash's rounds (Collet, XXH64).
/// Zeros complete the last eight bytes. This is unambiguous, because all rows of an image have the
/// same length.
std::uint64_t hash_of(const char* bytes, std::size_t size) noexcept {
    std::uint64_t hash = 0x27d4eb2f165667c5U ^ size;
    for (std::size_t at = 0; at < size; at += sizeof(std::uint64_t)) {
        std::uint64_t word = 0;
        std::memcpy(&word, bytes + at, std::min(sizeof(word), size - at));
        hash = std::rotl(hash ^ (word * 0xc2b2ae3d27d4eb4fU), 31) * 0x9e3779b185ebca87U;
    }
    return hash ^ (hash >> 29);
}

template <typename Pixel>
bool has_structure(const Pixel* row, int width) noexcept {
    int changes = 0;
    for (int u = 1; u < width && changes < FrameIntegrityCheck::kMinChanges; ++u)
        changes += row[u] != row[u - 1] ? 1 : 0;
    return changes >= FrameIntegrityCheck::kMinChanges;
}

}  // namespace

template <typename Pixel>
void FrameIntegrityCheck::hash_rows(const Image<Pixel>& image, Rows& rows) {
    rows.resize(static_cast<std::size_t>(image.height()));
    for (int v = 0; v < image.height(); ++v) {
        const Pixel* row = image.row(v);
        const std::size_t size = sizeof(Pixel) * static_cast<std::size_t>(image.width());
        rows[static_cast<std::size_t>(v)] = {hash_of(reinterpret_cast<const char*>(row), size),
                                             has_structure(row, image.width())};
    }
}

bool FrameIntegrityCheck::equal(const Summary& a, const Summary& b) {
    for (std::size_t i = 0; i < a.images.size(); ++i) {
        const auto same_hash = [](const Row& x, const Row& y) { return x.hash == y.hash; };
        if (!std::equal(a.images[i].begin(),
                        a.images[i].end(),
                        b.images[i].begin(),
                        b.images[i].end(),
                        same_hash)) {
            return false;
        }
    }
    return true;
}

bool FrameIntegrityCheck::shows_something(const Summary& seen) {
    return std::any_of(seen.images.begin(), seen.images.end(), [](const Rows& rows) {
        return std::any_of(rows.begin(), rows.end(), [](const Row& row) { return row.structured; });
    });
}

FrameIntegrityCheck::Likeness FrameIntegrityCheck::compare(const Rows& now, const Rows& before) {
    if (now.size() != before.size()) return Likeness::different;
    int same = 0;
    int structured = 0;
    int switches = 0;  // number of changes between equal and new rows, from top to bottom
    bool last_same = false;
    for (std::size_t v = 0; v < now.size(); ++v) {
        if (!now[v].structured) continue;
        const bool is_same = now[v].hash == before[v].hash;
        if (structured > 0 && is_same != last_same) ++switches;
        last_same = is_same;
        ++structured;
        same += is_same ? 1 : 0;
    }
    if (structured < kMinTornRows) return Likeness::unknown;
    if (same == structured) return Likeness::same;
    const bool enough = same >= kMinTornRows && structured - same >= kMinTornRows;
    return enough && switches == 1 ? Likeness::torn : Likeness::different;
}

bool FrameIntegrityCheck::torn(const Summary& now, const Summary& before) {
    // The depth image of an RGB-D camera has holes and steps of its own, which the grey image does
    // not have. So the tearing test ignores the depth image.
    const Likeness left = compare(now.images[0], before.images[0]);
    const Likeness right = compare(now.images[1], before.images[1]);
    if (left == Likeness::torn || right == Likeness::torn) return true;
    return (left == Likeness::same && right == Likeness::different) ||
           (left == Likeness::different && right == Likeness::same);
}

FrameStatus FrameIntegrityCheck::check(const StereoFrame& frame) {
    FrameStatus frame_status = frame.frame_status;
    if (!frame_status.is_new_and_whole() || (frame.left.empty() && frame.right.empty()))
        return frame_status;
    hash_rows(frame.left, now_.images[0]);
    hash_rows(frame.right, now_.images[1]);
    hash_rows(frame.depth_m, now_.images[2]);
    const auto end = memory_.begin() + static_cast<std::ptrdiff_t>(std::min(seen_, kMemory));
    const bool repeated =
        shows_something(now_) && std::any_of(memory_.begin(), end, [&](const Summary& before) {
            return equal(now_, before);
        });
    repeated_ = repeated ? repeated_ + 1 : 0;
    frame_status.repeated = repeated_;
    if (repeated) return frame_status;  // memory_ already holds this frame
    frame_status.torn = std::any_of(
        memory_.begin(), end, [&](const Summary& before) { return torn(now_, before); });
    std::swap(memory_[seen_ % kMemory], now_);
    ++seen_;
    return frame_status;
}

}  // namespace surefoot::camera
