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

/// What goes wrong between a camera and its reader.
enum class ImageFault : std::uint8_t {
    dropped,   ///< the frame never arrives
    repeated,  ///< the images delivered before, under a new stamp
    torn,      ///< top rows of this frame, the rest of the frame exposed before it
    frozen,    ///< the images delivered before, for many frames
};
inline constexpr const char* kImageFaultNames[] = {"dropped", "repeated", "torn", "frozen"};

/// One fault. Frames are counted as they are exposed, from 0, also those that are dropped; frame 0
/// always arrives whole.
struct InjectedFault {
    int frame = 0;
    ImageFault kind = ImageFault::dropped;
    int tear_row = 0;  ///< torn: first row of the older image; 0 = drawn by the seed

    friend bool operator==(const InjectedFault&, const InjectedFault&) = default;
};

/// Chances for each frame; a frame has at most one fault. Frames of `planned` get just that one.
struct ImageFaultConfig {
    double drop_probability = 0.0;
    double repeat_probability = 0.0;
    double tear_probability = 0.0;
    double freeze_probability = 0.0;  ///< that a freeze begins
    int freeze_frames = 10;           ///< length of one
    std::vector<InjectedFault> planned;

    void describe(ConfigVisitor& visitor);
    /// First planned fault that cannot be, in words; or nothing.
    [[nodiscard]] std::optional<std::string> problem(int frames, int height) const;
};

/// The faults of a whole recording, in the order of frames; the same for the same seed.
[[nodiscard]] std::vector<InjectedFault> plan_faults(const ImageFaultConfig& config,
                                                     int frames,
                                                     int height,
                                                     std::uint64_t seed);

/// Replaces the rows from `tear_row` down by those of the older image.
template <typename Pixel>
void tear(const Image<Pixel>& older, int tear_row, Image<Pixel>& image) {
    for (int v = tear_row; v < image.height(); ++v) {
        std::copy_n(older.row(v), image.width(), image.row(v));
    }
}

}  // namespace surefoot::sim
