// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "service/rex_link/rex_link.hpp"
#include "surefoot/core/result.hpp"

/// Questions and answers as texts of the rosbridge protocol, version 2.
namespace surefoot::rex_link {

inline constexpr const char* kStepService = "/surefoot/step";
inline constexpr std::size_t kLongestAnswer_bytes = 16384;

/// An answer and what it says to people.
struct ParsedAnswer {
    Answer answer;
    std::string primary;  ///< reason code
    std::string text;     ///< a sentence, printable
};

/// The call of the service. Its `id` carries nonce, sequence and command, and comes back in the
/// answer: so an answer names its question twice.
[[nodiscard]] std::string format_question(std::uint64_t nonce, const Question& question);

/// An answer is one JSON object with every field that it needs, each of its type and within its
/// range, none twice, and nothing that contradicts: `id` and values name the same question, verdict
/// and result code the same decision, and an OK has no reasons. All else is an error with a
/// sentence, which inhibits. Allocates no more than a small multiple of `bytes`, of which there may
/// be 16 kB.
[[nodiscard]] Result<ParsedAnswer> parse_answer(std::string_view bytes);

}  // namespace surefoot::rex_link
