// SPDX-License-Identifier: Apache-2.0
#include "surefoot/io/settings/yaml_tree.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "surefoot/core/nearest_names.hpp"
#include "surefoot/io/text.hpp"

namespace surefoot::io {
namespace {

constexpr std::size_t kMaxYamlBytes = std::size_t{16} << 20;
constexpr int kMaxDepth = 64;
constexpr std::size_t kMaxKeys = 10'000;
constexpr int kMaxValues = 1'000'000;

struct Converter {
    const std::string& file;
    int values = 0;
    std::optional<Error> error;

    void fail(const YAML::Mark& mark, const std::string& what) {
        if (!error) error = input_error(fmt::format("{}:{}: {}", file, mark.line + 1, what));
    }

    YamlNode convert(const YAML::Node& in, int depth) {
        YamlNode out;
        out.line = std::max(in.Mark().line + 1, 1);
        if (depth > kMaxDepth)
            fail(in.Mark(),
                 fmt::format("the file is nested deeper than {} levels; reduce the nesting",
                             kMaxDepth));
        if (++values > kMaxValues)
            fail(in.Mark(),
                 fmt::format("the file has more than {} values, which is the limit", kMaxValues));
        if (error) return out;
        if (in.IsScalar()) {
            out.kind = YamlNode::Kind::scalar;
            out.scalar = in.Scalar();
        } else if (in.IsSequence()) {
            out.kind = YamlNode::Kind::sequence;
            for (const auto& item : in) {
                out.items.push_back(convert(item, depth + 1));
                if (error) return out;
            }
        } else if (in.IsMap()) {
            convert_mapping(in, depth, out);
        }
        return out;
    }

    void convert_mapping(const YAML::Node& in, int depth, YamlNode& out) {
        out.kind = YamlNode::Kind::mapping;
        for (const auto& entry : in) {
            if (!entry.first.IsScalar())
                return fail(entry.first.Mark(), "a key must be plain text");
            const std::string& key = entry.first.Scalar();
            if (out.items.size() >= kMaxKeys) {  // limit: the search for repeated keys is linear
                return fail(
                    entry.first.Mark(),
                    fmt::format("this group has more than {} keys, which is the limit", kMaxKeys));
            }
            if (out.find(key) != nullptr) {
                return fail(entry.first.Mark(), fmt::format("key {} appears twice", quoted(key)));
            }
            out.items.push_back(convert(entry.second, depth + 1));
            out.items.back().key = key;
            // Errors must name the line of the key.
            out.items.back().line = std::max(entry.first.Mark().line + 1, 1);
            if (error) return;
        }
    }
};

/// Changes OpenCV's YAML to valid YAML and keeps line numbers. OpenCV starts its files with
/// "%YAML:1.0", which is not a valid YAML directive. OpenCV also accepts "data:[1, 2]" without the
/// blank that YAML needs (as in ORB-SLAM2's examples).
std::string without_directives(std::string_view text) {
    std::string copy(text);
    if (copy.starts_with("\xef\xbb\xbf")) copy.erase(0, 3);
    if (!copy.starts_with("%YAML")) return copy;
    copy[0] = '#';
    constexpr std::string_view kTight = "data:[";
    for (std::size_t at = copy.find(kTight); at != copy.npos; at = copy.find(kTight, at + 1)) {
        const char before = copy[at - 1];  // at > 0, because the directive comes first
        if (before == ' ' || before == '\t' || before == '\n')
            copy.insert(at + kTight.size() - 1, " ");
    }
    return copy;
}

}  // namespace

const YamlNode* YamlNode::find(std::string_view name) const noexcept {
    if (kind != Kind::mapping) return nullptr;
    for (const YamlNode& item : items) {
        if (item.key == name) return &item;
    }
    return nullptr;
}

const char* YamlNode::kind_name() const noexcept {
    switch (kind) {
        case Kind::null: return "nothing";
        case Kind::scalar: return "a single value";
        case Kind::sequence: return "a list";
        case Kind::mapping: return "a group of keys";
    }
    return "nothing";
}

Result<YamlNode> parse_yaml(std::string_view text, const std::string& file) {
    if (text.size() > kMaxYamlBytes) {
        return input_error(fmt::format("{}: the file has {} bytes; a YAML file may have at most {}",
                                       file,
                                       text.size(),
                                       kMaxYamlBytes));
    }
    if (text.find('\0') != text.npos) {
        return input_error(fmt::format("{}: not a YAML file (it holds binary data)", file));
    }
    try {
        const YAML::Node document = YAML::Load(without_directives(text));
        Converter converter{file, 0, std::nullopt};
        YamlNode root = converter.convert(document, 0);
        if (converter.error) return *converter.error;
        return root;
    } catch (const YAML::Exception& problem) {
        const int line = problem.mark.is_null() ? 1 : problem.mark.line + 1;
        return input_error(fmt::format("{}:{}: not valid YAML: {}", file, line, problem.msg));
    } catch (const std::exception& problem) {
        return input_error(fmt::format("{}: not valid YAML: {}", file, problem.what()));
    }
}

void YamlReader::fail(const YamlNode& node, std::string_view key, const std::string& what) {
    if (!error_) error_ = input_error(fmt::format("{}:{}: {}: {}", file_, node.line, key, what));
}

const YamlNode* YamlReader::required(const YamlNode& mapping, std::string_view key) {
    const YamlNode* node = mapping.find(key);
    if (node == nullptr && !error_) {
        error_ = input_error(fmt::format("{}:{}: key '{}' is missing", file_, mapping.line, key));
    }
    return node;
}

double YamlReader::number(const YamlNode& node, std::string_view key, double min, double max) {
    const auto value = node.is_scalar() ? parse_double(node.scalar) : std::nullopt;
    if (!value) {
        fail(node,
             key,
             fmt::format("{} is not a number",
                         node.is_scalar() ? quoted(node.scalar) : node.kind_name()));
        return min;
    }
    if (!(*value >= min && *value <= max)) {  // NaN also fails here
        fail(node, key, fmt::format("{} is outside {} .. {}", *value, min, max));
        return min;
    }
    return *value;
}

int YamlReader::integer(const YamlNode& node, std::string_view key, int min, int max) {
    const auto value = node.is_scalar() ? parse_int64(node.scalar) : std::nullopt;
    if (!value) {
        fail(node,
             key,
             fmt::format("{} is not a whole number",
                         node.is_scalar() ? quoted(node.scalar) : node.kind_name()));
        return min;
    }
    if (*value < min || *value > max) {
        fail(node, key, fmt::format("{} is outside {} .. {}", *value, min, max));
        return min;
    }
    return static_cast<int>(*value);
}

bool YamlReader::boolean(const YamlNode& node, std::string_view key) {
    if (node.is_scalar() && (node.scalar == "true" || node.scalar == "false")) {
        return node.scalar == "true";
    }
    fail(node,
         key,
         fmt::format("{} is neither true nor false",
                     node.is_scalar() ? quoted(node.scalar) : node.kind_name()));
    return false;
}

std::string YamlReader::text(const YamlNode& node, std::string_view key) {
    if (!node.is_scalar())
        fail(node, key, fmt::format("expected text, found {}", node.kind_name()));
    return node.scalar;
}

std::vector<double> YamlReader::any_numbers(const YamlNode& node,
                                            std::string_view key,
                                            std::size_t max_count) {
    std::vector<double> values;
    if (node.kind != YamlNode::Kind::sequence) {
        fail(node, key, fmt::format("expected a list of numbers, found {}", node.kind_name()));
        return values;
    }
    constexpr double kLargest = std::numeric_limits<double>::max();
    for (const YamlNode& item : node.items) {
        if (item.kind == YamlNode::Kind::sequence) {
            for (const YamlNode& inner : item.items) {
                values.push_back(number(inner, key, -kLargest, kLargest));
            }
        } else {
            values.push_back(number(item, key, -kLargest, kLargest));
        }
    }
    if (values.size() > max_count) {
        fail(node,
             key,
             fmt::format("found {} numbers; at most {} are allowed", values.size(), max_count));
    }
    return values;
}

std::vector<double> YamlReader::numbers(const YamlNode& node,
                                        std::string_view key,
                                        std::size_t count) {
    std::vector<double> values = any_numbers(node, key, kMaxValues);
    if (values.size() != count) {
        fail(node,
             key,
             fmt::format("found {} numbers; exactly {} are needed", values.size(), count));
    }
    values.resize(count, 0.0);
    return values;
}

void YamlReader::only_keys(const YamlNode& mapping,
                           std::string_view prefix,
                           const std::vector<std::string>& names) {
    for (const YamlNode& node : mapping.items) {
        if (std::find(names.begin(), names.end(), node.key) != names.end() || error_) continue;
        std::string hint = did_you_mean(node.key, names);
        if (hint.empty()) hint = fmt::format("; known keys: {}", fmt::join(names, ", "));
        error_ = input_error(
            fmt::format("{}:{}: unknown key '{}{}'{}", file_, node.line, prefix, node.key, hint));
    }
}

}  // namespace surefoot::io
