// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "service/gate_process/protocol/json_text.hpp"
#include "surefoot/gate/verdict.hpp"

/// The JSON form of a verdict. Services, topics, logs and tools all use it.
namespace surefoot::gate_process {

/// Returns the result of service `step` of the reference thesis (Lange 2016): 0 OK, 1
/// NOT_TRAVERSABLE, -1 ERROR. Never 0 if the verdict has a reason.
[[nodiscard]] int result_code(const gate::Verdict& verdict) noexcept;

/// Returns "OK", "NOT_TRAVERSABLE" or "ERROR". Never "OK" if the verdict has a reason.
[[nodiscard]] const char* verdict_name(const gate::Verdict& verdict) noexcept;
/// Returns the names of all reasons in order of precedence.
[[nodiscard]] Json reasons_array(gate::ReasonSet reasons);
/// Returns the numbers behind a verdict, lengths in m; unknown values are null.
[[nodiscard]] Json evidence_object(const gate::Verdict& verdict);
/// Returns {verdict, result_code, reasons, primary, text, evidence, command, sequence, connection,
/// map_version, config_hash, decided_ns, valid_until_ns, valid_for_ms}. Values that may exceed the
/// range of a JavaScript number are strings: the hash in hexadecimal, times in decimal digits.
[[nodiscard]] Json verdict_object(const gate::Verdict& verdict, const std::string& text);

}  // namespace surefoot::gate_process
