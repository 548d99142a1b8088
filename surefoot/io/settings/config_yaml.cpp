// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/settings/config_yaml.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "surefoot/core/nearest_names.hpp"
#include "surefoot/io/file.hpp"
#include "surefoot/io/settings/renamed_keys.hpp"
#include "surefoot/io/settings/yaml_tree.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

/// Keeps the path of groups while a config describes itself.
class PathVisitor : public ConfigVisitor {
  public:
    void begin_group(const char* name) override { groups_.emplace_back(name); }
    void end_group() override { groups_.pop_back(); }

  protected:
    [[nodiscard]] std::string path(const char* key) const {
        std::string text;
        for (const std::string& group : groups_) text += group + ".";
        return text + key;
    }
    [[nodiscard]] const std::vector<std::string>& groups() const noexcept { return groups_; }

  private:
    std::vector<std::string> groups_;
};

std::string joined(std::span<const char* const> names) {
    return fmt::format("{}", fmt::join(names.begin(), names.end(), " | "));
}

class ListVisitor final : public PathVisitor {
  public:
    std::vector<ConfigEntry> entries;

    void number(
        const char* key, double& value, double min, double max, const char* comment) override {
        add(key, format_double(value), fmt::format("{} .. {}", min, max), comment);
    }
    void integer(const char* key, int& value, int min, int max, const char* comment) override {
        add(key, std::to_string(value), fmt::format("{} .. {}", min, max), comment);
    }
    void boolean(const char* key, bool& value, const char* comment) override {
        add(key, value ? "true" : "false", "true | false", comment);
    }
    void choice(const char* key,
                int& value,
                std::span<const char* const> names,
                const char* comment) override {
        const auto position = static_cast<std::size_t>(value);  // in range: an int
        add(key, position < names.size() ? names[position] : "?", joined(names), comment);
    }

  private:
    void add(const char* key, std::string value, std::string range, const char* comment) {
        entries.push_back({path(key), std::move(value), std::move(range), comment});
    }
};

/// A value found in a file or on the command line.
struct Given {
    std::string text;
    std::string where;  ///< source: "file.yaml:12" or "--set"; empty = unknown
};

std::string begin_of_sentence(const std::string& where) {
    return where.empty() ? "" : where + ": ";
}

using GivenValues = std::map<std::string, Given, std::less<>>;

/// Checks all given values. Assigns the values only if `assign` is true.
class AssignVisitor final : public PathVisitor {
  public:
    AssignVisitor(const GivenValues& given, bool assign) : given_(given), assign_(assign) {}
    [[nodiscard]] const std::optional<Error>& error() const noexcept { return error_; }

    void number(const char* key, double& value, double min, double max, const char*) override {
        const Given* given = find(key);
        if (given == nullptr) return;
        const auto parsed = parse_double(given->text);
        if (!parsed) return fail(*given, key, "is not a number");
        if (!(*parsed >= min && *parsed <= max) || !std::isfinite(*parsed)) {
            return fail(*given, key, fmt::format("is outside {} .. {}", min, max));
        }
        if (assign_) value = *parsed;
    }
    void integer(const char* key, int& value, int min, int max, const char*) override {
        const Given* given = find(key);
        if (given == nullptr) return;
        const auto parsed = parse_int64(given->text);
        if (!parsed) return fail(*given, key, "is not a whole number");
        if (*parsed < min || *parsed > max) {
            return fail(*given, key, fmt::format("is outside {} .. {}", min, max));
        }
        if (assign_) value = static_cast<int>(*parsed);
    }
    void boolean(const char* key, bool& value, const char*) override {
        const Given* given = find(key);
        if (given == nullptr) return;
        if (given->text != "true" && given->text != "false") {
            return fail(*given, key, "is neither true nor false");
        }
        if (assign_) value = given->text == "true";
    }
    void choice(const char* key,
                int& value,
                std::span<const char* const> names,
                const char*) override {
        const Given* given = find(key);
        if (given == nullptr) return;
        for (std::size_t i = 0; i < names.size(); ++i) {
            if (given->text != names[i]) continue;
            if (assign_) value = static_cast<int>(i);
            return;
        }
        fail(*given, key, "is not one of " + joined(names));
    }

  private:
    [[nodiscard]] const Given* find(const char* key) const {
        const auto found = given_.find(path(key));
        return found == given_.end() ? nullptr : &found->second;
    }
    void fail(const Given& given, const char* key, const std::string& what) {
        if (error_) return;
        error_ = usage_error(fmt::format(
            "{}{}: {} {}", begin_of_sentence(given.where), path(key), quoted(given.text), what));
    }

    const GivenValues& given_;
    bool assign_;
    std::optional<Error> error_;
};

Error unknown_key(const std::string& where,
                  const std::string& key,
                  const std::vector<std::string>& keys) {
    return usage_error(fmt::format(
        "{}unknown key '{}'{}", begin_of_sentence(where), key, did_you_mean(key, keys)));
}

std::vector<std::string> keys_of(const DescribeConfig& describe) {
    std::vector<std::string> keys;
    for (ConfigEntry& entry : list_config(describe)) keys.push_back(std::move(entry.key));
    return keys;
}

Status assign(const GivenValues& given, const DescribeConfig& describe) {
    // Two passes, so that a file with an error changes nothing.
    for (const bool for_real : {false, true}) {
        AssignVisitor visitor(given, for_real);
        describe(visitor);
        if (visitor.error()) return *visitor.error();
    }
    return {};
}

bool is_key(const std::string& name, const std::vector<std::string>& keys) {
    return std::find(keys.begin(), keys.end(), name) != keys.end();
}

bool is_group(const std::string& name, const std::vector<std::string>& keys) {
    return std::any_of(keys.begin(), keys.end(), [&](const std::string& key) {
        return key.starts_with(name + ".");
    });
}

/// Returns today's name of a key or group. Returns `name` itself if it is a known name, or if its
/// newer name is not in `keys`.
std::string name_today(const std::string& name,
                       const std::string& where,
                       const std::vector<std::string>& keys,
                       Notes* notes) {
    if (is_key(name, keys) || is_group(name, keys)) return name;
    std::string now = current_key(name);
    if (!is_key(now, keys) && !is_group(now, keys)) return name;
    if (notes != nullptr) {
        notes->push_back(begin_of_sentence(where) + renamed_note(quoted(name), quoted(now)));
    }
    return now;
}

Status assign_one(const std::string& name,
                  const Given& given,
                  const DescribeConfig& describe,
                  Notes* notes) {
    const std::vector<std::string> keys = keys_of(describe);
    const std::string key = name_today(name, given.where, keys, notes);
    if (!is_key(key, keys)) return unknown_key(given.where, key, keys);
    return assign({{key, given}}, describe);
}

/// Flattens the tree into "group.key" -> text, and reports unknown keys.
Status collect(const YamlNode& node,
               const std::string& prefix,
               const std::string& file,
               const std::vector<std::string>& keys,
               GivenValues& out,
               Notes* notes) {
    for (const YamlNode& child : node.items) {
        const std::string where = fmt::format("{}:{}", file, child.line);
        const std::string key = name_today(prefix + child.key, where, keys, notes);
        const bool known = is_key(key, keys);
        if (!known && !is_group(key, keys)) {
            // Report a complete key. If a group is misspelled, report its first key.
            const bool inner = child.is_mapping() && !child.items.empty();
            return unknown_key(where, inner ? key + "." + child.items[0].key : key, keys);
        }
        if (known) {
            if (!child.is_scalar()) {
                return usage_error(fmt::format(
                    "{}: {}: expected a single value, found {}", where, key, child.kind_name()));
            }
            if (!out.emplace(key, Given{child.scalar, where}).second) {
                return usage_error(fmt::format("{}: key '{}' appears twice", where, key));
            }
        } else if (child.is_mapping()) {
            if (Status status = collect(child, key + ".", file, keys, out, notes); !status)
                return status;
        } else if (child.kind != YamlNode::Kind::null) {
            return usage_error(fmt::format(
                "{}: {}: expected a group of keys, found {}", where, key, child.kind_name()));
        }
    }
    return {};
}

/// Writes nested groups with two blanks of indentation per level.
std::string formatted(const std::vector<ConfigEntry>& entries) {
    std::string text;
    std::vector<std::string_view> open;
    for (const ConfigEntry& entry : entries) {
        std::vector<std::string_view> parts = split(entry.key, ".");
        const std::string_view name = parts.back();
        parts.pop_back();
        std::size_t common = 0;
        while (common < open.size() && common < parts.size() && open[common] == parts[common]) {
            ++common;
        }
        for (std::size_t i = common; i < parts.size(); ++i) {
            text += fmt::format("{:{}}{}:\n", "", 2 * i, parts[i]);
        }
        open = parts;
        const std::string left =
            fmt::format("{:{}}{}: {}", "", 2 * parts.size(), name, entry.value);
        text += fmt::format("{:<44}  # {} ({})\n", left, entry.comment, entry.range);
    }
    return text;
}

}  // namespace

std::vector<ConfigEntry> list_config(const DescribeConfig& describe) {
    ListVisitor visitor;
    describe(visitor);
    return std::move(visitor.entries);
}

std::string format_config(const DescribeConfig& describe) {
    return formatted(list_config(describe));
}

Status parse_config(std::string_view yaml,
                    const std::string& file,
                    const DescribeConfig& describe,
                    Notes* notes) {
    const Result<YamlNode> root = parse_yaml(yaml, file);
    if (!root) return usage_error(root.error().message);
    if (root->kind == YamlNode::Kind::null) return {};  // an empty file changes nothing
    if (!root->is_mapping()) {
        return usage_error(
            fmt::format("{}: expected 'key: value' lines, found {}", file, root->kind_name()));
    }
    GivenValues given;
    if (Status status = collect(*root, "", file, keys_of(describe), given, notes); !status)
        return status;
    return assign(given, describe);
}

Status override_config(std::string_view key_and_value,
                       const DescribeConfig& describe,
                       Notes* notes) {
    const std::size_t equals = key_and_value.find('=');
    if (equals == key_and_value.npos) {
        return usage_error(fmt::format("--set {}: expected key=value", quoted(key_and_value)));
    }
    const std::string key(trimmed(key_and_value.substr(0, equals)));
    const std::string value(trimmed(key_and_value.substr(equals + 1)));
    return assign_one(key, {value, "--set"}, describe, notes);
}

Status change_config(const std::string& key,
                     const std::string& value,
                     const DescribeConfig& describe) {
    return assign_one(key, {value, ""}, describe, nullptr);
}

Status read_config(const std::string& path, const DescribeConfig& describe, Notes* notes) {
    const Result<std::string> text = read_file(path, limits::kSettingsBytes);
    if (!text) return usage_error(text.error().message);
    return parse_config(*text, path, describe, notes);
}

Status write_config(const std::string& path, const DescribeConfig& describe) {
    return write_file(path, format_config(describe));
}

}  // namespace surefoot::io
