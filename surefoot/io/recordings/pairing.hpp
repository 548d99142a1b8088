// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// Which image of one camera belongs to which of the other.
namespace surefoot::io {

/// Index of the partner of each left image, or nothing.
using Partners = std::vector<std::optional<std::size_t>>;

/// Pairs by stamps at most `tolerance_ns` apart, the closest first; each image is used once.
[[nodiscard]] Partners pair_by_time(const std::vector<std::int64_t>& left_ns,
                                    const std::vector<std::int64_t>& right_ns,
                                    std::int64_t tolerance_ns);

/// A fifth of the median time between frames; 0 with fewer than two stamps.
[[nodiscard]] std::int64_t fifth_of_frame_time_ns(std::vector<std::int64_t> times_ns);

/// The stamps that file names without extension hold, if all of them do: seconds with a point
/// ("1311868164.363181"), or whole nanoseconds, microseconds or milliseconds since 1970 and up to
/// kMaxStamp_ns.
struct NameStamps {
    std::vector<std::int64_t> times_ns;
    const char* unit = "";
};
[[nodiscard]] std::optional<NameStamps> stamps_of_names(const std::vector<std::string>& names);

}  // namespace surefoot::io
