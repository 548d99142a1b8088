// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "surefoot/io/settings/yaml_group.hpp"
#include "surefoot/io/settings/yaml_tree.hpp"

/// Limits of the gate that the evidence of docs/evidence/safety.md covers. A machine file that
/// allows more is outside this evidence. A person must then sign for each such limit (see
/// docs/reference/machine_file.md).
namespace surefoot::io {

struct RatedLimit {
    const char* key;  ///< key in the file, for example "limits.tilt_deg"
    double rated;
    bool larger_allows_more;  ///< if false, a smaller value allows more
    const char* reason;       ///< why the evidence does not cover a laxer value
};
[[nodiscard]] std::span<const RatedLimit> rated_limits() noexcept;

/// One entry of `deviations`: a limit beyond its rated value, with the person who is responsible.
struct Deviation {
    std::string key;
    double value = 0.0;
    double rated = 0.0;
    std::string reason;
    std::string signed_by;
    std::string date;  ///< YYYY-MM-DD as written; the library reads no clock
};

/// Formats "limits.tilt_deg is 11 (rated 6), signed by NAME on DATE: REASON".
[[nodiscard]] std::string text_of(const Deviation& deviation);

/// Reads `deviations` (optional) and checks every limit of the document against its rated value;
/// problems go to `reader`. Limits of a disabled step class are not checked. Fails for: a laxer
/// limit without an entry, an entry whose value differs from the file, an unnecessary entry, and
/// two entries for one limit.
[[nodiscard]] std::vector<Deviation> read_deviations(YamlReader& reader, YamlGroup& root);

}  // namespace surefoot::io
