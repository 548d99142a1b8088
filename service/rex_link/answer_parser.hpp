// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "service/rex_link/rex_link.hpp"
#include "surefoot/core/result.hpp"

/// Formats questions and parses answers as texts of the rosbridge protocol, version 2.
namespace surefoot::rex_link {

inline constexpr const char* kStepService = "/surefoot/step";
inline constexpr std::size_t kLongestAnswer_bytes = 16384;

/// An answer, with its texts for the user.
struct ParsedAnswer {
    Answer answer;
    std::string primary;  ///< reason code
    std::string text;     ///< a sentence without control characters
};

/// Returns the rosbridge call of kStepService, as JSON. Its `id` holds nonce, sequence and command.
/// The gate returns the `id`, so an answer names its question twice: in the `id` and in its values.
[[nodiscard]] std::string format_question(std::uint64_t nonce, const Question& question);

/// Parses one answer. Any deviation from the format is an error with a sentence, and the caller
/// must then inhibit. A valid answer is one JSON object that has every required field, with the
/// right type and within its range. No name occurs twice. The fields agree: `id` and values name
/// the same question, verdict and result code name the same decision, and only an OK has no
/// reasons.
///
/// `bytes` may have at most kLongestAnswer_bytes. Allocates at most a small multiple of this size.
/// Thread-safe.
[[nodiscard]] Result<ParsedAnswer> parse_answer(std::string_view bytes);

}  // namespace surefoot::rex_link
