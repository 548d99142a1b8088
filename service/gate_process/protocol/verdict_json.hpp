// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "service/gate_process/protocol/json_text.hpp"
#include "surefoot/gate/verdict.hpp"

/// How a verdict is written as JSON: the one place for services, topics, logs and tools.
namespace surefoot::gate_process {

/// The answer of the thesis' service `step`: 0 OK, 1 NOT_TRAVERSABLE, -1 ERROR. Never 0 while a
/// reason stands against it.
[[nodiscard]] int result_code(const gate::Verdict& verdict) noexcept;

/// "OK", "NOT_TRAVERSABLE", "ERROR". An OK with a reason against it is none.
[[nodiscard]] const char* verdict_name(const gate::Verdict& verdict) noexcept;
/// The names of all reasons, in order of precedence.
[[nodiscard]] Json reasons_array(gate::ReasonSet reasons);
/// Numbers behind a verdict, lengths in m; what is not known is null.
[[nodiscard]] Json evidence_object(const gate::Verdict& verdict);
/// {verdict, result_code, reasons, primary, text, evidence, command, sequence, connection,
/// map_version, config_hash, decided_ns, valid_until_ns, valid_for_ms}. 64 bit values that no
/// JavaScript number holds are strings: the hash in hexadecimal digits, times in decimal ones.
[[nodiscard]] Json verdict_object(const gate::Verdict& verdict, const std::string& text);

}  // namespace surefoot::gate_process
