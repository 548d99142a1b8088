// SPDX-License-Identifier: Apache-2.0
#include "service/live/map_channel.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "service/console/log.hpp"

namespace surefoot::app {
namespace {

constexpr const char* kSharedMemory = "/dev/shm";
constexpr std::string_view kChannelEnd = ".channel";

std::string channel_begin() {
    return fmt::format("surefoot-{}-", ::getuid());
}

/// Removes the channel files of killed services of this user. No process has the process id in the
/// name of such a file.
void remove_orphaned_channels() {
    const std::string begin = channel_begin();
    std::error_code error;
    for (const auto& file : std::filesystem::directory_iterator(kSharedMemory, error)) {
        const std::string name = file.path().filename().string();
        if (!name.starts_with(begin) || !name.ends_with(kChannelEnd)) continue;
        const std::string_view process = std::string_view(name).substr(
            begin.size(), name.size() - begin.size() - kChannelEnd.size());
        ::pid_t number = 0;
        const auto [end, wrong] =
            std::from_chars(process.data(), process.data() + process.size(), number);
        if (wrong != std::errc{} || end != process.data() + process.size() || number <= 0) continue;
        if (::kill(number, 0) != 0 && errno == ESRCH) ::unlink(file.path().c_str());
    }
}

}  // namespace

void MapChannel::look_after(std::int64_t now_ns) {
    if (now_ns < next_ns_) return;
    next_ns_ = now_ns + kMendEvery_ns;
    const auto mended = writer.mend();
    if (mended && *mended)
        log_warning(fmt::format("the file of the map channel was damaged ({}); serve repaired it",
                                **mended));
    if (!mended && mended.error().message != logged_) log_error(mended.error().message);
    logged_ = mended ? "" : mended.error().message;
}

std::string channel_path(const std::string& wanted) {
    if (!wanted.empty()) return wanted;
    remove_orphaned_channels();
    return fmt::format("{}/{}{}{}", kSharedMemory, channel_begin(), ::getpid(), kChannelEnd);
}

}  // namespace surefoot::app
