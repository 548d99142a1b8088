// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace surefoot {

/// What the frames that come in say about the camera itself (hazards H1 and H2 of the gate). Only
/// `ok` lets the gate say OK. The values are those of the snapshot file.
enum class CameraState : std::uint8_t {
    unknown = 0,  ///< no image yet
    frozen = 1,   ///< the same images again and again
    corrupt = 2,  ///< torn or damaged images
    ok = 3,
};
[[nodiscard]] const char* to_string(CameraState state) noexcept;

}  // namespace surefoot
