// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/camera/remap.hpp"

namespace surefoot::camera {

/// Does the work of RemapTable::remap on `count` pixels, with the best instruction set of the
/// processor.
void remap_pixels(const RemapTable::View& table,
                  const std::uint8_t* source,
                  int stride,
                  std::uint8_t* out,
                  std::size_t count);

}  // namespace surefoot::camera
