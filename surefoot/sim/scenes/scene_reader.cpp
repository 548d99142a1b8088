// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/scene_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace surefoot::sim {
namespace {

/// Reads the keys that a config describes out of one group of a file.
class GroupReader final : public ConfigVisitor {
  public:
    GroupReader(SceneReader& reader, const SceneNode& group) : reader_(reader) {
        levels_.push_back({&group, {}});
        lines_.push_back(group.line);
    }

    void begin_group(const char* name) override {
        const SceneNode* node = take(name);
        if (node != nullptr && node->kind != SceneNode::Kind::group) {
            reader_.fail(*node,
                         fmt::format("needs a group of keys, not {}", to_string(node->kind)));
        }
        lines_.push_back(node != nullptr ? node->line : lines_.back());
        levels_.push_back({node, {}});
    }
    void end_group() override {
        refuse_unknown_keys({});
        levels_.pop_back();
        lines_.pop_back();
    }
    void number(
        const char* key, double& value, double min, double max, const char* /*comment*/) override {
        if (const SceneNode* node = take(key)) {
            value = in_range(*node, min, max);
        } else if (std::isnan(value)) {
            missing(key);
        }
    }
    void integer(const char* key, int& value, int min, int max, const char* /*comment*/) override {
        const SceneNode* node = take(key);
        if (node == nullptr) return;
        const double read = in_range(*node, min, max);
        if (reader_.error()) return;
        if (read != std::round(read)) {
            return reader_.fail(*node, fmt::format("needs a whole number, not {}", read));
        }
        // in range: in_range() has checked it against min and max, and NaN is not whole
        value = static_cast<int>(read);
    }
    void boolean(const char* key, bool& value, const char* /*comment*/) override {
        const SceneNode* node = take(key);
        if (node == nullptr) return;
        const std::string word = reader_.word(*node);
        if (word != "true" && word != "false") {
            return reader_.fail(*node, fmt::format("needs true or false, not '{}'", word));
        }
        value = word == "true";
    }
    void choice(const char* key,
                int& value,
                std::span<const char* const> names,
                const char* /*comment*/) override {
        const SceneNode* node = take(key);
        if (node == nullptr) {
            if (value == kRequiredChoice) missing(key);
            return;
        }
        const std::string word = reader_.word(*node);
        const auto found = std::find(names.begin(), names.end(), word);
        if (found == names.end()) {
            return reader_.fail(
                *node, fmt::format("is '{}'; it must be one of {}", word, fmt::join(names, ", ")));
        }
        value = static_cast<int>(found - names.begin());
    }

    /// Refuses keys of the current group that neither the config nor the caller reads.
    void refuse_unknown_keys(const std::vector<std::string_view>& other_keys) {
        if (levels_.back().group == nullptr) return;
        std::vector<std::string_view> known = levels_.back().asked;
        known.insert(known.end(), other_keys.begin(), other_keys.end());
        reader_.only_keys(*levels_.back().group, known);
    }

  private:
    struct Level {
        const SceneNode* group = nullptr;  ///< nullptr if the file leaves the group out
        std::vector<std::string_view> asked;
    };

    const SceneNode* take(const char* key) {
        levels_.back().asked.emplace_back(key);
        const SceneNode* group = levels_.back().group;
        return group != nullptr ? group->find(key) : nullptr;
    }
    void missing(const char* key) {
        reader_.fail(lines_.back(), fmt::format("key '{}' is missing", key));
    }
    double in_range(const SceneNode& node, double min, double max) {
        const double value = reader_.number(node);
        if (reader_.error() || (value >= min && value <= max)) return value;
        reader_.fail(node, fmt::format("is {}; it must be {} to {}", value, min, max));
        return value;
    }

    SceneReader& reader_;
    std::vector<Level> levels_;
    std::vector<int> lines_;
};

/// Returns true if the text is a word, not an expression.
bool looks_like_a_word(const std::string& text, const NamedNumbers& numbers) {
    return is_name(text) && numbers.find(text) == numbers.end();
}

}  // namespace

void SceneReader::fail(int line, const std::string& what) {
    if (!error_) error_ = input_error(fmt::format("{}:{}: {}", file_, line, what));
}

void SceneReader::fail(const SceneNode& node, const std::string& what) {
    fail(node.line, node.key.empty() ? what : fmt::format("'{}' {}", node.key, what));
}

double SceneReader::number(const SceneNode& node) {
    if (error_) return kRequired;
    if (node.kind != SceneNode::Kind::text) {
        fail(node, fmt::format("needs a number, not {}", to_string(node.kind)));
        return kRequired;
    }
    const auto value = evaluate(node.text, numbers_);
    if (!value) {
        fail(node, fmt::format("needs a number: {}", value.error().message));
        return kRequired;
    }
    return *value;
}

std::string SceneReader::word(const SceneNode& node) {
    if (node.kind != SceneNode::Kind::text) {
        fail(node, fmt::format("needs a word, not {}", to_string(node.kind)));
        return {};
    }
    const auto stands_for = words_.find(node.text);
    return stands_for != words_.end() ? stands_for->second : node.text;
}

const SceneNode* SceneReader::required(const SceneNode& group,
                                       std::string_view key,
                                       SceneNode::Kind kind) {
    const SceneNode* node = group.find(key);
    if (node == nullptr) {
        fail(group.line, fmt::format("key '{}' is missing", key));
        return nullptr;
    }
    if (node->kind == kind) return node;
    fail(*node, fmt::format("needs {}, not {}", to_string(kind), to_string(node->kind)));
    return nullptr;
}

void SceneReader::only_keys(const SceneNode& group, const std::vector<std::string_view>& keys) {
    if (group.kind != SceneNode::Kind::group) {
        return fail(group, fmt::format("needs a group of keys, not {}", to_string(group.kind)));
    }
    for (const SceneNode& item : group.items) {
        if (std::find(keys.begin(), keys.end(), item.key) != keys.end()) continue;
        return fail(
            item.line,
            fmt::format("unknown key '{}'; known keys: {}", item.key, fmt::join(keys, ", ")));
    }
}

void SceneReader::read_keys(const SceneNode& group,
                            const std::function<void(ConfigVisitor&)>& describe,
                            const std::vector<std::string_view>& other_keys) {
    if (error_) return;
    if (group.kind != SceneNode::Kind::group) {
        return fail(group, fmt::format("needs a group of keys, not {}", to_string(group.kind)));
    }
    GroupReader visitor(*this, group);
    describe(visitor);
    visitor.refuse_unknown_keys(other_keys);
}

void SceneReader::define(const SceneNode& origin, const std::string& name, double value) {
    if (!is_name(name)) {
        return fail(origin.line,
                    fmt::format("'{}' is not a valid name for a parameter; use letters, digits and "
                                "_, with no digit at the start",
                                name));
    }
    if (numbers_.contains(name) || words_.contains(name)) {
        return fail(origin.line,
                    fmt::format("parameter '{}' is defined twice; remove one definition", name));
    }
    numbers_[name] = value;
}

void SceneReader::define_value(const SceneNode& name, const SceneNode& value) {
    if (value.kind == SceneNode::Kind::text && looks_like_a_word(value.text, numbers_)) {
        const std::string meant = word(value);
        define(name, name.key, 0.0);  // fails if the name is invalid or already used
        forget(name.key);
        words_[name.key] = meant;
        return;
    }
    const double drawn = number(value);
    if (!error_) define(name, name.key, drawn);
}

void SceneReader::define(const SceneNode& parameter, Rng& rng) {
    if (error_) return;
    if (parameter.kind == SceneNode::Kind::group) return define_drawn(parameter, rng);
    define_value(parameter, parameter);
}

void SceneReader::define_drawn(const SceneNode& parameter, Rng& rng) {
    only_keys(parameter, {"uniform", "choice"});
    if (!error_ && parameter.items.size() != 1) {
        fail(parameter, "needs either 'uniform' or 'choice'");
    }
    if (error_) return;
    const SceneNode& how = parameter.items.front();
    const bool uniform = how.key == "uniform";
    if (how.kind != SceneNode::Kind::list || how.items.empty() ||
        (uniform && how.items.size() != 2)) {
        return fail(parameter,
                    uniform ? "needs uniform: [low, high]" : "needs choice: [a, b, ...]");
    }
    if (!uniform) return define_value(parameter, how.items[rng.below(how.items.size())]);
    const double low = number(how.items[0]);
    const double high = number(how.items[1]);
    if (!error_ && low > high) {
        fail(parameter,
             fmt::format("has its low end {} above its high end {}; give the smaller number first",
                         low,
                         high));
    }
    const double drawn = rng.uniform(low, high);
    if (!error_) define(parameter, parameter.key, drawn);
}

}  // namespace surefoot::sim
