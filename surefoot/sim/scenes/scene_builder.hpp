// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "surefoot/core/rng.hpp"
#include "surefoot/sim/scenes/scene.hpp"
#include "surefoot/sim/scenes/scene_node.hpp"
#include "surefoot/sim/scenes/scene_reader.hpp"
#include "surefoot/sim/scenes/solids.hpp"

namespace surefoot::sim {

/// Builds a scene from the lists of a scene file. The reader keeps the problems.
class SceneBuilder {
  public:
    SceneBuilder(SceneReader& reader, std::uint64_t seed);

    void add_materials(const SceneNode& group);
    void add_lighting(const SceneNode& group);
    /// Adds the solids of a list, in the frame of `place`.
    void add_solids(const SceneNode& list, const Place& place);

    [[nodiscard]] const Scene& scene() const noexcept { return scene_; }
    [[nodiscard]] Scene take_scene() { return std::move(scene_); }
    /// Boxes, tables, flights, ... that were added, each counted once.
    [[nodiscard]] int solids() const noexcept { return solids_; }
    /// Line of the file that a primitive comes from.
    [[nodiscard]] int line_of(int primitive) const {
        return lines_[static_cast<std::size_t>(primitive)];
    }

  private:
    void add_solid(const SceneNode& item, const Place& place);
    template <typename Spec>
    void add_one(const SceneNode& node, const Place& place);
    template <typename Spec>
    void place_one(const SceneNode& node, const Spec& spec, const Place& place);
    void add_floor(const SceneNode& node, const Place& place);
    void add_walls(const SceneNode& node, const Place& place);
    void add_group(const SceneNode& node, const Place& place);
    void add_repeat(const SceneNode& node, const Place& place);

    SceneReader& reader_;
    Rng rng_;
    Scene scene_;
    int solids_ = 0;
    std::vector<std::string> material_texts_;
    std::vector<const char*> material_names_;
    std::vector<int> lines_;
};

}  // namespace surefoot::sim
