// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/scene_builder.hpp"

#include <fmt/format.h>

#include <string_view>

#include "surefoot/sim/scenes/scene_file.hpp"

namespace surefoot::sim {
namespace {

constexpr std::uint64_t kSolidStream = 0x736f6c6964;
constexpr int kMaxPits = 16;

struct RepeatSpec {
    int count = 1;
    void describe(ConfigVisitor& visitor) {
        visitor.integer(
            "count", count, 0, kMaxPrimitives, "number of copies of the solids; 0 = none");
    }
};

}  // namespace

SceneBuilder::SceneBuilder(SceneReader& reader, std::uint64_t seed)
    : reader_(reader), rng_(mix_seed(seed, kSolidStream)) {}

void SceneBuilder::add_materials(const SceneNode& group) {
    for (const SceneNode& node : group.items) {
        if (!is_name(node.key)) {
            reader_.fail(node.line,
                         fmt::format("'{}' is not a valid name for a material; use letters, digits "
                                     "and _, with no digit at the start",
                                     node.key));
        }
        Material material;
        material.seed = scene_.materials().size();
        reader_.read(node, material);
        scene_.add_material(material);
        material_texts_.push_back(node.key);
    }
    for (const std::string& text : material_texts_) material_names_.push_back(text.c_str());
}

void SceneBuilder::add_lighting(const SceneNode& group) {
    Lighting lighting;
    reader_.read(group, lighting);
    scene_.light(lighting);
}

template <typename Spec>
void SceneBuilder::place_one(const SceneNode& node, const Spec& spec, const Place& place) {
    if (reader_.error()) return;
    if (const auto problem = spec.problem()) return reader_.fail(node, *problem);
    Site site{scene_, place, rng_};
    spec.add(site);
    ++solids_;
    lines_.resize(static_cast<std::size_t>(scene_.primitives()), node.line);
    if (scene_.primitives() > kMaxPrimitives) {
        reader_.fail(
            node,
            fmt::format(
                "brings the scene to {} primitives; a scene may have at most {}. Remove objects",
                scene_.primitives(),
                kMaxPrimitives));
    }
}

template <typename Spec>
void SceneBuilder::add_one(const SceneNode& node, const Place& place) {
    Spec spec;
    spec.materials = material_names_;
    reader_.read(node, spec);
    place_one(node, spec, place);
}

void SceneBuilder::add_floor(const SceneNode& node, const Place& place) {
    FloorSpec floor;
    floor.materials = material_names_;
    reader_.read(node, floor, {"pits"});
    if (place.yaw_rad != 0.0) reader_.fail(node, "cannot stand in a turned group; use a box");
    if (node.find("pits") != nullptr) {
        const SceneNode* pits = reader_.required(node, "pits", SceneNode::Kind::list);
        if (pits == nullptr) return;
        if (pits->items.size() > kMaxPits) {
            reader_.fail(
                *pits,
                fmt::format(
                    "has {} entries; at most {} are allowed", pits->items.size(), kMaxPits));
        }
        for (const SceneNode& item : pits->items) {
            PitSpec pit;
            reader_.read(item, pit);
            floor.pits.push_back(pit);
        }
    }
    place_one(node, floor, place);
}

void SceneBuilder::add_walls(const SceneNode& node, const Place& place) {
    if (place.yaw_rad != 0.0) reader_.fail(node, "cannot stand in a turned group; use boxes");
    add_one<WallsSpec>(node, place);
}

void SceneBuilder::add_group(const SceneNode& node, const Place& place) {
    GroupSpec group;
    reader_.read(node, group, {"solids"});
    const SceneNode* solids = reader_.required(node, "solids", SceneNode::Kind::list);
    if (reader_.error()) return;
    add_solids(*solids, place.then(group.x_m, group.y_m, group.z_m, group.heading_deg));
}

void SceneBuilder::add_repeat(const SceneNode& node, const Place& place) {
    RepeatSpec repeat;
    reader_.read(node, repeat, {"name", "parameters", "solids"});
    const SceneNode* name = reader_.required(node, "name", SceneNode::Kind::text);
    const SceneNode* solids = reader_.required(node, "solids", SceneNode::Kind::list);
    const SceneNode* parameters =
        node.find("parameters") == nullptr
            ? nullptr
            : reader_.required(node, "parameters", SceneNode::Kind::group);
    for (int k = 0; k < repeat.count && !reader_.error(); ++k) {
        reader_.define(*name, name->text, k);
        if (parameters != nullptr) {
            for (const SceneNode& parameter : parameters->items) reader_.define(parameter, rng_);
        }
        add_solids(*solids, place);
        if (parameters != nullptr) {
            for (const SceneNode& parameter : parameters->items) reader_.forget(parameter.key);
        }
        reader_.forget(name->text);
    }
}

void SceneBuilder::add_solid(const SceneNode& item, const Place& place) {
    if (item.kind != SceneNode::Kind::group || item.items.size() != 1) {
        return reader_.fail(item.line, "a solid is one group, for example '- box: {...}'");
    }
    const SceneNode& node = item.items.front();
    if (node.key == "group") return add_group(node, place);
    if (node.key == "repeat") return add_repeat(node, place);
    if (node.key == "floor") return add_floor(node, place);
    if (node.key == "walls") return add_walls(node, place);
    if (node.key == "box") return add_one<BoxSpec>(node, place);
    if (node.key == "ramp") return add_one<RampSpec>(node, place);
    if (node.key == "cylinder") return add_one<CylinderSpec>(node, place);
    if (node.key == "flight") return add_one<FlightSpec>(node, place);
    if (node.key == "spiral") return add_one<SpiralSpec>(node, place);
    if (node.key == "door") return add_one<DoorSpec>(node, place);
    if (node.key == "table") return add_one<TableSpec>(node, place);
    reader_.fail(
        node.line,
        fmt::format("'{}' is not a solid; known solids: box, ramp, cylinder, floor, walls, "
                    "flight, spiral, door, table, group, repeat",
                    node.key));
}

void SceneBuilder::add_solids(const SceneNode& list, const Place& place) {
    for (const SceneNode& item : list.items) {
        if (reader_.error()) return;
        add_solid(item, place);
    }
}

}  // namespace surefoot::sim
