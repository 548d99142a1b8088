// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "service/gate_process/sockets/access.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::gate_process {

/// Returns `$XDG_STATE_HOME/surefoot/tokens` or `~/.local/state/surefoot/tokens`. Empty if neither
/// XDG_STATE_HOME nor HOME is an absolute path.
[[nodiscard]] std::string default_token_file();

struct TokenFile {
    Access access;
    bool is_new = false;  ///< true: this call created the file; show the tokens once
};

/// Reads the tokens of a service (parse_tokens). If the file is missing, creates it with rights
/// 0600 and three random tokens. Errors name the file and the cause: another owner, readable or
/// writable by others, not a regular file, not readable, or not creatable.
[[nodiscard]] Result<TokenFile> read_or_make_tokens(const std::string& path);

/// Reads the tokens of an existing file.
[[nodiscard]] Result<Access> read_tokens(const std::string& path);

/// Returns the message that is shown once, after the file was created.
[[nodiscard]] std::string words_of_new_tokens(const Access& access, const std::string& path);

struct LoadedAccess {
    Access access;
    std::string news;  ///< lines to show: new tokens, or the cause of missing tokens; may be empty
};
/// Returns the access settings at the start of a service. Empty `token_file`: the default file. If
/// the default file is unusable, the service runs without tokens, and nobody can attest or re-arm.
/// `guests`: see `guest_role`.
[[nodiscard]] Result<LoadedAccess> load_access(const std::string& token_file,
                                               const std::string& guests,
                                               const std::string& bind_address);

/// Returns the role of a client without a token: `wished`, or the default of the address (rider on
/// loopback, none on any other address).
[[nodiscard]] Role guest_role(const std::string& wished, const std::string& bind_address);

}  // namespace surefoot::gate_process
