// SPDX-License-Identifier: Apache-2.0
#pragma once

// Tests run on all instruction sets that hwy::SupportedAndGeneratedTargets names. This macro adds
// AVX3_DL, which the kernels are built for but Highway omits by default.
#define HWY_WANT_AVX3_DL
#include <hwy/targets.h>  // IWYU pragma: export
