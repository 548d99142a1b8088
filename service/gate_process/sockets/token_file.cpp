// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/token_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "service/gate_process/sockets/server_config.hpp"

namespace surefoot::gate_process {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBytes = 4096;

/// Owns a file descriptor and closes it.
class Descriptor {
  public:
    Descriptor(const std::string& path, int flags)
        : number_(::open(path.c_str(), flags | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0600)) {}
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    ~Descriptor() {
        if (number_ >= 0) ::close(number_);
    }
    [[nodiscard]] int number() const noexcept { return number_; }

  private:
    int number_;
};

std::string system_says() {
    return std::generic_category().message(errno);
}

/// Returns 128 random bits as hexadecimal digits; empty if the system has no random numbers.
std::string new_token() {
    std::array<std::uint8_t, 16> bytes{};
    if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) return {};
    std::string token;
    for (const std::uint8_t byte : bytes) token += fmt::format("{:02x}", byte);
    return token;
}

Status check_owner(int file, const std::string& path) {
    struct stat about {};
    if (::fstat(file, &about) != 0) return usage_error(path + ": " + system_says());
    if (!S_ISREG(about.st_mode))
        return usage_error(path + ": the token file is not a regular file; name a regular file");
    if (about.st_uid != ::geteuid())
        return usage_error(path + ": this token file belongs to another user; name your own file");
    if ((about.st_mode & (S_IRWXG | S_IRWXO)) != 0)
        return usage_error(fmt::format(
            "{}: other users may reach this token file (rights {:04o}); run chmod 600 {}, or "
            "delete the file, so that the next start makes new tokens",
            path,
            about.st_mode & 07777U,
            path));
    return {};
}

Result<Access> read_open_file(int file, const std::string& path) {
    if (auto status = check_owner(file, path); !status) return status.error();
    std::string text(kMaxBytes + 1, '\0');
    const ssize_t bytes = ::read(file, text.data(), text.size());
    if (bytes < 0) return usage_error(path + ": " + system_says());
    if (bytes > static_cast<ssize_t>(kMaxBytes))
        return usage_error(
            fmt::format("{}: larger than {} bytes, so it is not a token file", path, kMaxBytes));
    text.resize(static_cast<std::size_t>(bytes));
    return parse_tokens(text, path);
}

Result<TokenFile> make_tokens(int file, const std::string& path) {
    TokenFile made{{new_token(), new_token(), new_token(), Role::rider}, true};
    const std::string text = format_tokens(made.access);
    const bool random = !made.access.observer.empty() && !made.access.rider.empty() &&
                        !made.access.operator_.empty();
    if (random && ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
        ::fsync(file) == 0)
        return made;
    const std::string why = system_says();
    ::unlink(path.c_str());
    return input_error(path + ": new tokens cannot be written: " + why);
}

Status make_folder_of(const std::string& path) {
    const fs::path folder = fs::path(path).parent_path();
    std::error_code error;
    if (!folder.empty()) fs::create_directories(folder, error);
    if (error)
        return input_error(folder.string() +
                           ": the folder of the token file cannot be created: " + error.message());
    return {};
}

}  // namespace

std::string default_token_file() {
    constexpr const char* kName = "surefoot/tokens";
    const char* const state = std::getenv("XDG_STATE_HOME");
    if (state != nullptr && *state == '/') return fs::path(state) / kName;
    const char* const home = std::getenv("HOME");
    if (home == nullptr || *home != '/') return {};
    return fs::path(home) / ".local/state" / kName;
}

Result<Access> read_tokens(const std::string& path) {
    const Descriptor file(path, O_RDONLY);
    if (file.number() < 0)
        return usage_error(path + ": the token file cannot be read: " + system_says());
    return read_open_file(file.number(), path);
}

Result<TokenFile> read_or_make_tokens(const std::string& path) {
    const bool is_there = ::access(path.c_str(), F_OK) == 0;
    if (!is_there) {
        if (auto made = make_folder_of(path); !made) return made.error();
        const Descriptor file(path, O_WRONLY | O_CREAT | O_EXCL);
        if (file.number() >= 0) return make_tokens(file.number(), path);
        if (errno != EEXIST)  // another process may have created it meanwhile
            return input_error(path + ": the token file cannot be created: " + system_says());
    }
    auto access = read_tokens(path);
    if (!access) return access.error();
    return TokenFile{std::move(access).value(), false};
}

std::string words_of_new_tokens(const Access& access, const std::string& path) {
    return fmt::format(
        "new tokens were written to {} (rights 0600); the gate shows them only now:\n"
        "  observer  {}  (reads)\n"
        "  rider     {}  (asks for steps; slots are reserved for it)\n"
        "  operator  {}  (attests the ground, re-arms)\n",
        path,
        access.observer,
        access.rider,
        access.operator_);
}

Result<LoadedAccess> load_access(const std::string& token_file,
                                 const std::string& guests,
                                 const std::string& bind_address) {
    LoadedAccess loaded;
    const std::string path = token_file.empty() ? default_token_file() : token_file;
    auto tokens =
        path.empty()
            ? Result<TokenFile>(usage_error("neither XDG_STATE_HOME nor HOME is an absolute path, "
                                            "so there is no default token file"))
            : read_or_make_tokens(path);
    if (!tokens && !token_file.empty()) return tokens.error();
    if (tokens) {
        loaded.access = tokens->access;
        if (tokens->is_new) loaded.news = words_of_new_tokens(tokens->access, path);
    } else {
        loaded.news =
            "warning: " + tokens.error().message +
            ". Without tokens nobody can attest the ground or re-arm the gate: name a file "
            "with --token-file\n";
    }
    loaded.access.guest = guest_role(guests, bind_address);
    return loaded;
}

Role guest_role(const std::string& wished, const std::string& bind_address) {
    if (const auto role = role_named(wished)) return *role;
    return is_loopback_address(bind_address) ? Role::rider : Role::none;
}

}  // namespace surefoot::gate_process
