// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "surefoot/core/result.hpp"

namespace surefoot::sim {

/// A scene file as a text tree in which every value knows its line. Keys of a group are unique and
/// keep the order of the file.
struct SceneNode {
    enum class Kind : std::uint8_t { nothing, text, list, group };

    Kind kind = Kind::nothing;
    int line = 1;                  ///< first line = 1; a value of a group has the line of its key
    std::string key;               ///< key of a value in a group
    std::string text;              ///< text of a single value
    std::vector<SceneNode> items;  ///< items of a list or a group

    /// The value of a key of this group, or nullptr.
    [[nodiscard]] const SceneNode* find(std::string_view name) const noexcept;
};

/// Names the kind in a message, for example "a list" or "a group of keys".
[[nodiscard]] const char* to_string(SceneNode::Kind kind) noexcept;

/// Reads YAML; `file` is its name in messages. Refuses more than 1 MB, 32 levels, 10 000 keys in a
/// group or 100 000 values (aliases count each time).
[[nodiscard]] Result<SceneNode> parse_scene_node(std::string_view text, const std::string& file);

}  // namespace surefoot::sim
