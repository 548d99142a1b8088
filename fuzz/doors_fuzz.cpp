// SPDX-License-Identifier: Apache-2.0
// Access control with any bytes: the token file, the key file, the head of a request to the gate's
// socket, and the host names of the page. No input gives a role that the tokens do not grant.
// SUREFOOT_FUZZ_READER names the function under test.
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/must.hpp"
#include "service/gate_process/channel/keyed_checksum.hpp"
#include "service/gate_process/sockets/admission.hpp"

namespace {

using namespace surefoot;
using namespace surefoot::gate_process;

constexpr const char* kOperatorToken = "operator-0123456789";
constexpr const char* kRiderToken = "rider-0123456789ab";

std::string_view take_line(std::string_view& rest) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), line.size() + 1));
    return line;
}

/// Each accepted token is usable and gives its role. Writing and reading the tokens again returns
/// the same ones.
[[maybe_unused]] void fuzz_tokens(std::string_view bytes) {
    const auto access = parse_tokens(bytes, "f");
    must_explain(access);
    if (!access) return;
    must(!access->problem() && access->has_tokens());
    for (const Role role : {Role::observer, Role::rider, Role::operator_}) {
        const std::string& token = access->token_of(role);
        must(token.empty() || access->role_of(token) == role);
    }
    must(!access->role_of(""));
    const auto again = parse_tokens(format_tokens(*access), "again");
    must(again.ok() && *again == *access);
}

/// The input has three lines: target, Origin, Authorization (empty = no such header). Only the
/// whole operator token gives the role operator. A page of a foreign origin is never admitted.
[[maybe_unused]] void fuzz_admission(std::string_view bytes) {
    static const Access access{"", kRiderToken, kOperatorToken, Role::observer};
    static const std::vector<std::string> origins{"https://robot.example"};
    Knock knock;
    knock.target = take_line(bytes);
    if (const auto origin = take_line(bytes); !origin.empty()) knock.origin = origin;
    if (const auto word = take_line(bytes); !word.empty()) knock.authorization = word;
    const Entrance entrance = admit(access, origins, knock);
    if (entrance.admission != Admission::welcome) {
        must(entrance.role == Role::none);
        return must(!refusal_text(entrance, knock).empty());
    }
    const auto shown = [&](std::string_view token) {
        return knock.target.find(token) != knock.target.npos ||
               (knock.authorization && knock.authorization->find(token) != std::string_view::npos);
    };
    must(entrance.role != Role::operator_ || shown(kOperatorToken));
    must(entrance.role != Role::rider || shown(kRiderToken));
    must(!knock.origin || *knock.origin == origins[0] || is_loopback_origin(*knock.origin));
}

/// An accepted key has 32 digits, and the key contains all of them.
[[maybe_unused]] void fuzz_key_file(std::string_view bytes) {
    static const int file = ::memfd_create("key", 0);
    static const std::string path = "/proc/self/fd/" + std::to_string(file);
    must(::fchmod(file, 0600) == 0 && ::ftruncate(file, 0) == 0);
    must(::pwrite(file, bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()));
    const auto key = read_checksum_key(path);
    must_explain(key);
    if (!key) return;
    constexpr std::size_t kDigits = 32;
    must(bytes.size() >= kDigits);
    std::string digits;
    for (const std::uint64_t half : {key->high, key->low})
        for (int shift = 60; shift >= 0; shift -= 4)
            digits += "0123456789abcdef"[(half >> static_cast<unsigned>(shift)) & 15U];
    must(std::equal(digits.begin(), digits.end(), bytes.begin(), [](char lower, char c) {
        return lower == (c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c);
    }));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    SUREFOOT_FUZZ_READER({reinterpret_cast<const char*>(data), size});
    return 0;
}
