// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "surefoot/io/settings/yaml_group.hpp"
#include "surefoot/io/settings/yaml_tree.hpp"

/// Limits of the gate for which the evidence of docs/evidence/safety.md was taken. A machine file
/// that allows more leaves that evidence, so that a person must sign for it, limit by limit
/// (docs/reference/machine_file.md).
namespace surefoot::io {

struct RatedLimit {
    const char* key;  ///< "limits.tilt_deg", in the unit of the file
    double rated;
    bool larger_allows_more;  ///< otherwise a smaller value does
    const char* reason;       ///< what a laxer value takes away
};
[[nodiscard]] std::span<const RatedLimit> rated_limits() noexcept;

/// One line of `deviations`: a limit beyond its rated value, for which a person answers.
struct Deviation {
    std::string key;
    double value = 0.0;
    double rated = 0.0;
    std::string reason;
    std::string signed_by;
    std::string date;  ///< YYYY-MM-DD, as written: the library reads no clock
};

/// "limits.tilt_deg is 11 (rated 6), signed by NAME on DATE: REASON".
[[nodiscard]] std::string text_of(const Deviation& deviation);

/// Reads `deviations` (which may be missing) and checks every limit of the document against its
/// rated value; what is wrong is reported to `reader`. A limit of a step class that is not enabled
/// is not judged. Fails for: a laxer limit without a line, a line for another value than the
/// file's, a line that is not needed, and two lines for one limit.
[[nodiscard]] std::vector<Deviation> read_deviations(YamlReader& reader, YamlGroup& root);

}  // namespace surefoot::io
