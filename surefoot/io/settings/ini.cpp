// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/settings/ini.hpp"

#include <fmt/format.h>

#include <cmath>

#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 20;

}  // namespace

const IniFile::Section* IniFile::find(std::string_view section) const {
    const auto found = sections.find(lowercase(section));
    return found == sections.end() ? nullptr : &found->second;
}

const IniFile::Value* IniFile::find(std::string_view section, std::string_view key) const {
    const Section* in = find(section);
    if (in == nullptr) return nullptr;
    const auto found = in->find(lowercase(key));
    return found == in->end() ? nullptr : &found->second;
}

Result<double> IniFile::number(std::string_view section, std::string_view key) const {
    const Value* value = find(section, key);
    if (value == nullptr) {
        return input_error(fmt::format("{}: [{}] has no '{}'", name, section, key));
    }
    const auto fail = [&](const char* what) {
        return input_error(fmt::format(
            "{}:{}: [{}] {}: {} {}", name, value->line, section, key, quoted(value->text), what));
    };
    if (value->text.find(',') != std::string::npos) {
        return fail("has a comma; numbers of this file need a '.'");
    }
    const auto number = parse_double(value->text);
    if (!number) return fail("is not a number");
    if (!std::isfinite(*number)) return fail("is not a finite number");
    return *number;
}

Result<IniFile> parse_ini(std::string_view text, const std::string& file) {
    if (text.size() > kMaxBytes) {
        return input_error(fmt::format(
            "{}: the file has {} bytes; at most {} are allowed", file, text.size(), kMaxBytes));
    }
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    IniFile ini;
    ini.name = file;
    IniFile::Section* section = nullptr;
    LineReader lines(text);
    while (const auto line = lines.next()) {
        const std::string_view content = trimmed(line->substr(0, line->find_first_of(";#")));
        if (content.empty()) continue;
        const auto fail = [&](const char* what) {
            return input_error(
                fmt::format("{}:{}: {} {}", file, lines.number(), quoted(content), what));
        };
        if (content.front() == '[' && content.back() == ']') {
            const std::string name = lowercase(trimmed(content.substr(1, content.size() - 2)));
            const auto [at, is_new] = ini.sections.try_emplace(name);
            if (!is_new) return fail("appears twice");
            section = &at->second;
            continue;
        }
        const std::size_t equals = content.find('=');
        if (equals == content.npos) return fail("is neither [section] nor key = value");
        if (section == nullptr) return fail("comes before the first [section]");
        const std::string key = lowercase(trimmed(content.substr(0, equals)));
        const std::string value(trimmed(content.substr(equals + 1)));
        if (!section->try_emplace(key, IniFile::Value{value, lines.number()}).second) {
            return fail("sets a key that this section already has; remove one of the two lines");
        }
    }
    return ini;
}

}  // namespace surefoot::io
