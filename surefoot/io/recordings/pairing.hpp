// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// Pairs the images of the left and the right camera.
namespace surefoot::io {

/// Index of the right image for each left image; no value without a partner.
using Partners = std::vector<std::optional<std::size_t>>;

/// Pairs stamps that differ by at most `tolerance_ns`, closest first; no image gets two partners.
[[nodiscard]] Partners pair_by_time(const std::vector<std::int64_t>& left_ns,
                                    const std::vector<std::int64_t>& right_ns,
                                    std::int64_t tolerance_ns);

/// Returns a fifth of the median time between frames; 0 for fewer than two stamps.
[[nodiscard]] std::int64_t fifth_of_frame_time_ns(std::vector<std::int64_t> times_ns);

/// Stamps from file names without extension. All names must hold a stamp of the same unit: seconds
/// with a point ("1311868164.363181"), or whole nanoseconds, microseconds or milliseconds since
/// 1970, at most kMaxStamp_ns.
struct NameStamps {
    std::vector<std::int64_t> times_ns;
    const char* unit = "";
};
[[nodiscard]] std::optional<NameStamps> stamps_of_names(const std::vector<std::string>& names);

}  // namespace surefoot::io
