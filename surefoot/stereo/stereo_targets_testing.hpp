// SPDX-License-Identifier: Apache-2.0
#pragma once

// Tests go through the instruction sets that hwy::SupportedAndGeneratedTargets names. It leaves
// this one out, for which the kernels are built, unless it is asked for.
#define HWY_WANT_AVX3_DL
#include <hwy/targets.h>  // IWYU pragma: export
