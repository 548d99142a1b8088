// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Includes all headers that a program needs to pass frames to Surefoot and to read the rated
/// ground. To use a single module, include the header of that module instead (docs/index.md).
#include "surefoot/elevation/elevation_map.hpp"
#include "surefoot/gate/gate.hpp"
#include "surefoot/perception.hpp"
#include "surefoot/stairs/feature_finder.hpp"
#include "surefoot/traversability/traversability.hpp"
