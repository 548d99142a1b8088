// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/write_at.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace surefoot::io {

Error cannot_write(const std::string& path, int error) {
    return output_error(
        fmt::format("{}: cannot write: {}", path, std::generic_category().message(error)));
}

Status write_at(int descriptor,
                std::int64_t offset,
                std::string_view bytes,
                const std::string& path) {
    while (!bytes.empty()) {
        const ssize_t written =
            ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return cannot_write(path, errno);
        bytes.remove_prefix(static_cast<std::size_t>(written));
        offset += written;
    }
    return {};
}

}  // namespace surefoot::io
