// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <cstdlib>

namespace surefoot {

/// Reports a finding and aborts if `holds` is false. `what` names the violated property; the head
/// comment of each target lists its properties.
inline void must(bool holds, const char* what = "a property in the head comment does not hold") {
    if (holds) return;
    std::fprintf(stderr, "finding: %s\n", what);
    std::abort();
}

/// Requires that a failed result has an error message.
template <typename Outcome>
void must_explain(const Outcome& outcome) {
    must(outcome.ok() || !outcome.error().message.empty(), "an error without a message");
}

}  // namespace surefoot
