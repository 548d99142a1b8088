// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace surefoot {

/// State of the camera, derived from its frames (hazards H1 to H4 and H6 of the gate). Only `ok`
/// lets the gate say OK. The numeric values are part of the snapshot file format.
enum class CameraState : std::uint8_t {
    unknown = 0,  ///< no new, whole and well-exposed image yet
    frozen = 1,   ///< the camera repeats earlier images
    corrupt = 2,  ///< torn or damaged images
    ok = 3,
    overexposed = 4,  ///< too many image pixels are saturated
    dark = 5,         ///< most image pixels are black
    moved = 6,        ///< the mounting pose on the machine has changed; stays until a restart
    leaning = 7,      ///< base_link leans: the machine is in mid-step, or the camera was knocked
};
[[nodiscard]] const char* to_string(CameraState state) noexcept;

}  // namespace surefoot
