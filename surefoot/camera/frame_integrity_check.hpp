// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "surefoot/core/frame.hpp"

namespace surefoot::camera {

/// Detects repeated and torn frames: evidence for hazards H1 (frozen camera) and H2
/// (half-updated frame). Use one check per source and pass its frames in the order of arrival.
///
/// Hashes every image row and compares it with the rows of the last few frames. A ring of buffers
/// that is overwritten too early can repeat the frame of one round ago, not only the previous one.
/// * Repeated: every row of all images equals that of one earlier frame. At least one row has
///   structure, because black or saturated images are equal without being old.
/// * Torn, case 1: in one image the first or last rows equal those of an earlier frame, and all
///   other rows differ. Case 2: the image of one camera is old, that of the other camera is new.
/// Sensor noise makes two exposures differ in every row with structure, even in a still scene. Rows
/// without structure (saturated, black, or grey from a decoder) do not count in the tearing test.
/// Limit: video that is coded from frame to frame (H.264) copies still parts. If only a part of a
/// still scene moves in such a file, the check can report a torn frame by mistake. Frames without
/// images (modelled frames) are never repeated or torn.
///
/// Cost: one pass over the pixels. Not thread-safe.
class FrameIntegrityCheck {
  public:
    /// Returns the status of the frame with `repeated` and `torn` set. If the source already
    /// reports one of them, that status is returned unchanged and the frame is not compared.
    [[nodiscard]] FrameStatus check(const StereoFrame& frame);

    /// ASSUMPTION: a capture ring has at most kMemory buffers (V4L2 programs ask for 3 to 8).
    static constexpr std::size_t kMemory = 8;
    /// A tear needs at least this many old rows and as many new rows: the height of a JPEG block.
    static constexpr int kMinTornRows = 8;
    /// A row has structure if this many pixels differ from their left neighbour. With noise of one
    /// grey level, two readings of one pixel are equal with probability 0.28, of 16 pixels < 1e-8.
    static constexpr int kMinChanges = 16;

  private:
    struct Row {
        std::uint64_t hash = 0;
        bool structured = false;
    };
    using Rows = std::vector<Row>;
    struct Summary {
        std::array<Rows, 3> images;  ///< rows of the left, right and depth image
    };
    enum class Likeness : std::uint8_t { unknown, same, torn, different };

    template <typename Pixel>
    static void hash_rows(const Image<Pixel>& image, Rows& rows);
    [[nodiscard]] static bool shows_something(const Summary& seen);
    [[nodiscard]] static bool equal(const Summary& a, const Summary& b);
    [[nodiscard]] static Likeness compare(const Rows& now, const Rows& before);
    [[nodiscard]] static bool torn(const Summary& now, const Summary& before);

    std::array<Summary, kMemory> memory_;
    std::size_t seen_ = 0;  ///< count of frames with images; the next frame goes to seen_ % kMemory
    Summary now_;
    int repeated_ = 0;
};

}  // namespace surefoot::camera
