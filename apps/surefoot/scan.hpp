// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "surefoot/core/result.hpp"

namespace surefoot::app {

/// What a scan is expected to write.
struct ScanSize {
    double points = 0.0;
    double bytes = 0.0;
};

/// Refuses a scan that the disk has no room for.
[[nodiscard]] Status check_room(const std::string& file, const ScanSize& size, double free_bytes);

/// How far scanning a scene got, and why it ended early.
struct Scanned {
    std::string file;
    int stations = 0;  ///< that were begun
    std::int64_t points = 0;
    std::optional<Error> error;
};

}  // namespace surefoot::app
