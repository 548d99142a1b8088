// SPDX-License-Identifier: Apache-2.0
#include "studies/lange2016/thesis_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "surefoot/io/file.hpp"

namespace surefoot::app {
namespace {

constexpr std::string_view kHead = "# surefoot thesis figures 1 ";

std::string file_of(const std::string& folder) {
    return folder + "/figures.csv";
}

std::optional<double> number_of(std::string_view text) {
    if (text == "nan") return std::nan("");
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return value;
}

/// Removes the first line of a text and returns it.
std::string_view next_line(std::string_view& text) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return line;
}

}  // namespace

double ThesisFigures::get(std::string_view name) const {
    const auto at = std::find_if(
        all_.begin(), all_.end(), [&](const auto& figure) { return figure.first == name; });
    return at == all_.end() ? std::nan("") : at->second;
}

Status write_figures(const std::string& folder,
                     std::uint64_t conditions,
                     const ThesisFigures& figures) {
    std::string text = fmt::format("{}{:016x}\nname,value\n", kHead, conditions);
    for (const auto& [name, value] : figures.all()) {
        text +=
            std::isnan(value) ? fmt::format("{},nan\n", name) : fmt::format("{},{}\n", name, value);
    }
    return io::write_file(file_of(folder), text);
}

Result<std::optional<ThesisFigures>> read_figures(const std::string& folder,
                                                  std::uint64_t conditions) {
    using Found = std::optional<ThesisFigures>;
    if (!io::is_file(file_of(folder))) return Found();
    const auto text = io::read_file(file_of(folder));
    if (!text) return text.error();
    std::string_view rest = *text;
    const std::string_view head = next_line(rest);
    const auto broken = [&](std::string_view line) {
        return input_error(
            fmt::format("{}: '{}' is not a line of a figures file; remove the file and run again "
                        "to compute this part",
                        file_of(folder),
                        line));
    };
    if (!head.starts_with(kHead)) return broken(head);
    if (head.substr(kHead.size()) != fmt::format("{:016x}", conditions)) return Found();
    next_line(rest);  // skips the column names
    ThesisFigures figures;
    while (!rest.empty()) {
        const std::string_view line = next_line(rest);
        const std::size_t comma = line.find(',');
        if (comma == std::string_view::npos) return broken(line);
        const auto value = number_of(line.substr(comma + 1));
        if (!value) return broken(line);
        figures.set(std::string(line.substr(0, comma)), *value);
    }
    return Found(std::move(figures));
}

}  // namespace surefoot::app
