// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/camera/remap.hpp"

namespace surefoot::camera {

/// The work of RemapTable::remap on `count` pixels, by the best instructions that the processor
/// has.
void remap_pixels(const RemapTable::View& table,
                  const std::uint8_t* source,
                  int stride,
                  std::uint8_t* out,
                  std::size_t count);

}  // namespace surefoot::camera
