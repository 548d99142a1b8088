// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace surefoot {

/// What the frames that come in say about the camera itself (hazards H1, H2, H4 and H6 of the
/// gate). Only `ok` lets the gate say OK. The values are those of the snapshot file.
enum class CameraState : std::uint8_t {
    unknown = 0,  ///< no image yet
    frozen = 1,   ///< the same images again and again
    corrupt = 2,  ///< torn or damaged images
    ok = 3,
    overexposed = 4,  ///< too much of the images is saturated
    dark = 5,         ///< most of the images is black
    moved = 6,        ///< no longer where it was on the machine; stays so
    leaning = 7,      ///< by what it sees, the machine is in mid-step, or it was knocked
};
[[nodiscard]] const char* to_string(CameraState state) noexcept;

}  // namespace surefoot
