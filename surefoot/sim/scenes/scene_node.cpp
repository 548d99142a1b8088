// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/scene_node.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <exception>
#include <optional>

namespace surefoot::sim {
namespace {

constexpr std::size_t kMaxBytes = 1'000'000;
constexpr int kMaxDepth = 32;
constexpr int kMaxValues = 100'000;
constexpr std::size_t kMaxKeys = 10'000;

/// Converts yaml-cpp's nodes to SceneNode and keeps the first problem.
class Copier {
  public:
    explicit Copier(const std::string& file) : file_(file) {}

    SceneNode copy(const YAML::Node& in, int depth) {
        SceneNode out;
        out.line = line_of(in);
        if (depth > kMaxDepth)
            fail(out.line,
                 fmt::format("nested deeper than {} levels; use fewer nested groups and lists",
                             kMaxDepth));
        if (++values_ > kMaxValues) {
            fail(out.line,
                 fmt::format("more than {} values; make the scene file smaller", kMaxValues));
        }
        if (error_) return out;
        if (in.IsScalar()) {
            out.kind = SceneNode::Kind::text;
            out.text = in.Scalar();
        } else if (in.IsSequence()) {
            out.kind = SceneNode::Kind::list;
            for (const auto& item : in) out.items.push_back(copy(item, depth + 1));
        } else if (in.IsMap()) {
            out.kind = SceneNode::Kind::group;
            for (const auto& entry : in) add(out, entry.first, entry.second, depth);
        }
        return out;
    }
    [[nodiscard]] const std::optional<Error>& error() const noexcept { return error_; }

  private:
    static int line_of(const YAML::Node& node) { return std::max(node.Mark().line + 1, 1); }

    void fail(int line, const std::string& what) {
        if (!error_) error_ = input_error(fmt::format("{}:{}: {}", file_, line, what));
    }

    void add(SceneNode& out, const YAML::Node& key, const YAML::Node& value, int depth) {
        if (error_) return;
        const int line = line_of(key);
        if (!key.IsScalar()) return fail(line, "a key must be plain text");
        if (out.items.size() >= kMaxKeys) {  // the search for repeated keys below is linear
            return fail(line,
                        fmt::format("more than {} keys in a group; use fewer keys", kMaxKeys));
        }
        if (out.find(key.Scalar()) != nullptr) {
            return fail(line,
                        fmt::format("key '{}' appears twice; remove one of the two", key.Scalar()));
        }
        SceneNode item = copy(value, depth + 1);
        item.key = key.Scalar();
        item.line = line;
        out.items.push_back(std::move(item));
    }

    const std::string& file_;
    int values_ = 0;
    std::optional<Error> error_;
};

}  // namespace

const SceneNode* SceneNode::find(std::string_view name) const noexcept {
    if (kind != Kind::group) return nullptr;
    for (const SceneNode& item : items) {
        if (item.key == name) return &item;
    }
    return nullptr;
}

const char* to_string(SceneNode::Kind kind) noexcept {
    switch (kind) {
        case SceneNode::Kind::nothing: return "nothing";
        case SceneNode::Kind::text: return "a single value";
        case SceneNode::Kind::list: return "a list";
        case SceneNode::Kind::group: return "a group of keys";
    }
    return "nothing";
}

Result<SceneNode> parse_scene_node(std::string_view text, const std::string& file) {
    if (text.size() > kMaxBytes) {
        return input_error(fmt::format(
            "{}: {} bytes; a scene file may have at most {}", file, text.size(), kMaxBytes));
    }
    // yaml-cpp throws exceptions; this function catches all of them.
    try {
        Copier copier(file);
        SceneNode root = copier.copy(YAML::Load(std::string(text)), 0);
        if (copier.error()) return *copier.error();
        return root;
    } catch (const YAML::Exception& problem) {
        const int line = problem.mark.is_null() ? 1 : problem.mark.line + 1;
        return input_error(fmt::format("{}:{}: not valid YAML: {}", file, line, problem.msg));
    } catch (const std::exception& problem) {
        return input_error(fmt::format("{}:1: not valid YAML: {}", file, problem.what()));
    }
}

}  // namespace surefoot::sim
