// SPDX-License-Identifier: Apache-2.0
#include "apps/surefoot/suite_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "io/file.hpp"
#include "io/text.hpp"

namespace surefoot::app {
namespace {

constexpr std::size_t kCaseColumns = 4;

std::string head_of(std::uint64_t settings_hash) {
    std::string head =
        fmt::format("# surefoot {} eval suite, settings {:016x}\nscene,seed,noise,max_frames",
                    SUREFOOT_VERSION,
                    settings_hash);
    for (const SuiteFigure& figure : suite_figures()) head += fmt::format(",{}", figure.name);
    return head + "\n";
}

std::string line_of(const SuiteResult& result) {
    const SuiteCase& c = result.which;
    std::string line = fmt::format("{},{},{},{}", c.scene, c.seed, c.noise, c.max_frames);
    for (const double figure : result.figures)
        line += fmt::format(",{}", figure);  // reads back to the same bits
    return line + "\n";
}

/// Nothing for a line that is not whole.
std::optional<SuiteResult> parse_line(std::string_view line) {
    const auto words = io::split(line, ",");
    if (words.size() != kCaseColumns + suite_figures().size()) return std::nullopt;
    const auto seed = io::parse_int64(words[1]);
    const auto noise = io::parse_double(words[2]);
    const auto frames = io::parse_int64(words[3]);
    if (!seed || !noise || !frames) return std::nullopt;
    SuiteResult result;
    result.which = {std::string(words[0]),
                    static_cast<std::uint64_t>(*seed),
                    *noise,
                    static_cast<int>(*frames)};
    for (std::size_t i = kCaseColumns; i < words.size(); ++i) {
        const auto figure =
            words[i] == "nan" ? std::optional<double>(std::nan("")) : io::parse_double(words[i]);
        if (!figure) return std::nullopt;
        result.figures.push_back(*figure);
    }
    return result;
}

}  // namespace

Result<SuiteTable> SuiteTable::open(const std::string& path, std::uint64_t settings_hash) {
    SuiteTable table;
    table.path_ = path;
    table.head_ = head_of(settings_hash);
    if (!io::is_file(path)) return table;
    const auto text = io::read_file(path);
    if (!text) return text.error();
    if (!text->starts_with(table.head_)) {
        return usage_error(fmt::format(
            "{}: was made with other settings or by another version; give a new --out folder, or "
            "remove it to start over",
            path));
    }
    // A line counts when its end was written.
    const std::string_view whole = std::string_view(*text).substr(
        table.head_.size(), text->rfind('\n') + 1 - table.head_.size());
    for (const std::string_view line : io::split(whole, "\n")) {
        if (auto result = parse_line(line)) table.results_.push_back(std::move(*result));
    }
    return table;
}

bool SuiteTable::holds(const SuiteCase& which) const {
    return std::any_of(results_.begin(), results_.end(), [&](const SuiteResult& result) {
        return result.which.name() == which.name() && result.which.max_frames == which.max_frames;
    });
}

Status SuiteTable::add(const SuiteResult& result) {
    results_.push_back(result);
    std::string text = head_;
    for (const SuiteResult& r : results_) text += line_of(r);
    return io::write_file(path_, text);
}

}  // namespace surefoot::app
