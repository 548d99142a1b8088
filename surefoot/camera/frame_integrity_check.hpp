// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "surefoot/core/frame.hpp"

namespace surefoot::camera {

/// Finds out whether a frame shows something new: the evidence for hazards H1 (frozen camera) and
/// H2 (half-updated frame). One watch per source; frames in the order in which they came.
///
/// Every image row is hashed and compared with the rows of the last few frames, because a ring of
/// buffers that is overwritten too early shows the frame of one round ago, not the previous one.
/// * Repeated: every row of every image of the frame equals that of one earlier frame, and one of
///   them shows something: black or saturated images are alike without being old.
/// * Torn: in one image the first or last rows equal those of an earlier frame and all others do
///   not; or one eye is an earlier one and the other eye new.
/// Sensor noise makes two exposures differ in every row that has any structure, even when nothing
/// moves. Rows without structure (saturated, black, painted grey by a decoder) say nothing about
/// tearing and are left out there. Video that is coded from frame to frame (H.264) copies what
/// stands still: from such files a torn frame may be reported where only a part of a still scene
/// moved. Modelled frames without images are never repeated or torn.
///
/// Cost: one pass over the pixels. Not thread-safe.
class FrameIntegrityCheck {
  public:
    /// The frame's arrival with `repeated` and `torn` filled. Where the source says one of them
    /// already, it is believed and nothing is compared.
    [[nodiscard]] FrameStatus look(const StereoFrame& frame);

    /// ASSUMPTION: capture rings have no more buffers than this (V4L2 programs ask for 3 to 8).
    static constexpr std::size_t kMemory = 8;
    /// Fewer equal or fewer new rows than this are not called a tear: one block of JPEG.
    static constexpr int kMinTornRows = 8;
    /// A row has structure when this many neighbouring pixels differ. With noise of one grey level
    /// two readings of a pixel agree in 28 % of cases: 0.28^16 < 1e-8 for the row.
    static constexpr int kMinChanges = 16;

  private:
    struct Row {
        std::uint64_t hash = 0;
        bool structured = false;
    };
    using Rows = std::vector<Row>;
    struct Summary {
        std::array<Rows, 3> images;  ///< left, right, depth
    };
    enum class Likeness : std::uint8_t { unknown, same, torn, different };

    template <typename Pixel>
    static void hash_rows(const Image<Pixel>& image, Rows& rows);
    [[nodiscard]] static bool shows_something(const Summary& seen);
    [[nodiscard]] static bool equal(const Summary& a, const Summary& b);
    [[nodiscard]] static Likeness compare(const Rows& now, const Rows& before);
    [[nodiscard]] static bool torn(const Summary& now, const Summary& before);

    std::array<Summary, kMemory> memory_;
    std::size_t seen_ = 0;  ///< frames with images so far; the next goes to seen_ % kMemory
    Summary now_;
    int repeated_ = 0;
};

}  // namespace surefoot::camera
