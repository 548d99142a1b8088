// SPDX-License-Identifier: Apache-2.0
#include "service/live/tone_player.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <filesystem>

namespace surefoot::app {

Result<TonePlayer> TonePlayer::open(const std::string& folder) {
    TonePlayer player(folder);
    for (int i = 0; !folder.empty() && i < rex_link::kToneCount; ++i) {
        const std::string file = player.file_of(static_cast<rex_link::Tone>(i));
        std::error_code ignored;
        if (!std::filesystem::is_regular_file(file, ignored))
            return usage_error(
                fmt::format("--tones: the file {} is missing; run tools/tones to create it", file));
    }
    return player;
}

std::string TonePlayer::file_of(rex_link::Tone tone) const {
    return folder_.empty() ? "" : fmt::format("{}/{}.wav", folder_, to_string(tone));
}

void TonePlayer::play(rex_link::Tone tone) {
    std::erase_if(playing_, [](pid_t pid) { return waitpid(pid, nullptr, WNOHANG) != 0; });
    std::string file = file_of(tone);
    if (file.empty()) return;
    std::string program = "aplay", quiet = "-q";
    const std::array<char*, 4> words{program.data(), quiet.data(), file.data(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
        posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
    pid_t pid = 0;
    // The call fails if `aplay` is not installed. The list of events then still contains the file
    // name.
    if (posix_spawnp(&pid, program.c_str(), &actions, nullptr, words.data(), environ) == 0)
        playing_.push_back(pid);
    posix_spawn_file_actions_destroy(&actions);
}

}  // namespace surefoot::app
