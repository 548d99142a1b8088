// SPDX-License-Identifier: Apache-2.0
#include "service/gate_process/sockets/port_holder.hpp"

#include <charconv>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

namespace surefoot::gate_process {
namespace {

namespace fs = std::filesystem;

/// Parses the whole text as a number.
std::optional<int> number_of(std::string_view text, int base = 10) {
    int number = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, number, base);
    if (error != std::errc{} || stop != end) return std::nullopt;
    return number;
}

/// Adds the sockets that listen on the port, named like the links in /proc/PID/fd:
/// "socket:[12345]". Fields of /proc/net/tcp: 1 = address:port in hexadecimal, 3 = state, 9 =
/// inode.
void add_listeners(const char* table, std::uint16_t port, std::set<std::string>& sockets) {
    std::ifstream file(table);
    std::string line;
    std::getline(file, line);  // skip the field names
    while (std::getline(file, line)) {
        std::istringstream words(line);
        std::vector<std::string> fields;
        for (std::string word; words >> word;) fields.push_back(std::move(word));
        if (fields.size() < 10 || fields[3] != "0A") continue;
        const std::size_t colon = fields[1].rfind(':');
        if (number_of(std::string_view(fields[1]).substr(colon + 1), 16) == port)
            sockets.insert("socket:[" + fields[9] + "]");
    }
}

bool holds_one_of(const fs::path& process, const std::set<std::string>& sockets) {
    std::error_code error;
    for (fs::directory_iterator file(process / "fd", error), end; !error && file != end;
         file.increment(error)) {
        std::error_code gone;
        if (sockets.contains(fs::read_symlink(file->path(), gone).string())) return true;
    }
    return false;
}

PortHolder describe(int number, const fs::path& process) {
    PortHolder holder;
    holder.process = number;
    std::getline(std::ifstream(process / "comm"), holder.name);
    std::string stat;
    std::getline(std::ifstream(process / "stat"), stat);
    // The text is "1234 (name) S 1 ...". The name may contain any characters.
    std::istringstream rest(
        stat.substr(stat.rfind(')') == std::string::npos ? stat.size() : stat.rfind(')') + 1));
    std::string state;
    rest >> state >> holder.parent;
    return holder;
}

}  // namespace

std::optional<PortHolder> holder_of_port(std::uint16_t port) {
    std::set<std::string> sockets;
    add_listeners("/proc/net/tcp", port, sockets);
    add_listeners("/proc/net/tcp6", port, sockets);
    if (sockets.empty()) return std::nullopt;
    std::error_code error;
    for (fs::directory_iterator process("/proc", error), end; !error && process != end;
         process.increment(error)) {
        const auto number = number_of(process->path().filename().string());
        if (number && holds_one_of(process->path(), sockets))
            return describe(*number, process->path());
    }
    return std::nullopt;
}

std::string words_of(const PortHolder& holder) {
    return "process " + std::to_string(holder.process) + " (" + holder.name + ")";
}

}  // namespace surefoot::gate_process
