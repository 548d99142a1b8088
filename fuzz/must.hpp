// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <cstdlib>

namespace surefoot {

/// Ends a fuzz target with a finding where what it says at its head does not hold; `what` says
/// which of its sentences that is.
inline void must(bool holds, const char* what = "what the target says at its head does not hold") {
    if (holds) return;
    std::fprintf(stderr, "finding: %s\n", what);
    std::abort();
}

/// A result that failed says why.
template <typename Outcome>
void must_explain(const Outcome& outcome) {
    must(outcome.ok() || !outcome.error().message.empty(), "an error without a sentence");
}

}  // namespace surefoot
