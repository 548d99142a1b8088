// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// How far scanning a scene got, and why it ended early.
struct Scanned {
    std::string file;
    int stations = 0;  ///< that were begun
    std::int64_t points = 0;
    std::optional<Error> error;
};

}  // namespace surefoot::app
