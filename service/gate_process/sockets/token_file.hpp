// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "service/gate_process/sockets/access.hpp"
#include "surefoot/core/result.hpp"

namespace surefoot::gate_process {

/// `$XDG_STATE_HOME/surefoot/tokens`, or `~/.local/state/surefoot/tokens`. Empty where neither
/// variable is set.
[[nodiscard]] std::string default_token_file();

struct TokenFile {
    Access access;
    bool is_new = false;  ///< made in this call: show the tokens once
};

/// Reads the tokens of a service (parse_tokens). Makes the file, with rights 0600 and three
/// random tokens, where it is missing. Errors name the file: it belongs to another user, others may
/// read or write it, it is no regular file, or it cannot be read or made.
[[nodiscard]] Result<TokenFile> read_or_make_tokens(const std::string& path);

/// Reads the tokens of a file that must be there.
[[nodiscard]] Result<Access> read_tokens(const std::string& path);

/// What is shown once, when the file was made.
[[nodiscard]] std::string words_of_new_tokens(const Access& access, const std::string& path);

struct LoadedAccess {
    Access access;
    std::string news;  ///< lines to show: new tokens, or why there are none; empty: nothing is new
};
/// What a service starts with. `token_file` empty: the default file, and where that cannot be used
/// the service goes on without tokens, so that nobody can attest or re-arm. `guests`: see
/// `guest_role`.
[[nodiscard]] Result<LoadedAccess> load_access(const std::string& token_file,
                                               const std::string& guests,
                                               const std::string& bind_address);

/// The role of a client without a token: as it was wished, or the rule of the service for an
/// address: a rider on loopback, nobody beyond.
[[nodiscard]] Role guest_role(const std::string& wished, const std::string& bind_address);

}  // namespace surefoot::gate_process
