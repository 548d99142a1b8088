// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "surefoot/core/config.hpp"
#include "surefoot/core/views.hpp"

namespace surefoot::sim {

/// Faults between a camera and its reader.
enum class ImageFault : std::uint8_t {
    dropped,   ///< the frame never arrives
    repeated,  ///< the previously delivered images arrive again, under a new stamp
    torn,      ///< top rows are from this frame, the other rows from the previous exposure
    frozen,    ///< the previously delivered images arrive again, for many frames
};
inline constexpr const char* kImageFaultNames[] = {"dropped", "repeated", "torn", "frozen"};

/// One fault. Frames are counted from 0 as they are exposed, dropped frames included; frame 0
/// always arrives intact.
struct InjectedFault {
    int frame = 0;
    ImageFault kind = ImageFault::dropped;
    int tear_row = 0;  ///< torn: first row of the older image; 0 = drawn by the seed

    friend bool operator==(const InjectedFault&, const InjectedFault&) = default;
};

/// Fault probabilities per frame. No frame has two faults; frames in `planned` get only that fault.
struct ImageFaultConfig {
    double drop_probability = 0.0;
    double repeat_probability = 0.0;
    double tear_probability = 0.0;
    double freeze_probability = 0.0;  ///< probability that a freeze begins at this frame
    int freeze_frames = 10;           ///< number of frames in one freeze
    std::vector<InjectedFault> planned;

    void describe(ConfigVisitor& visitor);
    /// Describes the first impossible planned fault; no value if all are possible.
    [[nodiscard]] std::optional<std::string> problem(int frames, int height) const;
};

/// Draws the faults of a whole recording, in frame order; deterministic for a given seed.
[[nodiscard]] std::vector<InjectedFault> plan_faults(const ImageFaultConfig& config,
                                                     int frames,
                                                     int height,
                                                     std::uint64_t seed);

/// Replaces the rows from `tear_row` to the bottom by those of the older image.
template <typename Pixel>
void tear(const Image<Pixel>& older, int tear_row, Image<Pixel>& image) {
    for (int v = tear_row; v < image.height(); ++v) {
        std::copy_n(older.row(v), image.width(), image.row(v));
    }
}

}  // namespace surefoot::sim
