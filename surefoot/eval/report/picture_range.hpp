// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surefoot/eval/report/figure.hpp"
#include "surefoot/eval/report/picture.hpp"

namespace surefoot::eval {

/// True if at least one value is finite.
[[nodiscard]] bool any_known(const Image<float>& values);

/// Returns the colour bar of `values` in a style: range, clipped ends and words.
[[nodiscard]] ColorBar color_bar_of(const Image<float>& values, const LayerStyle& style);

}  // namespace surefoot::eval
