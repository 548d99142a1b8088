// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/scene_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <utility>

#include "surefoot/core/fnv1a.hpp"
#include "surefoot/core/nearest_names.hpp"
#include "surefoot/sim/scenes/scene_builder.hpp"
#include "surefoot/sim/scenes/scene_motion.hpp"
#include "surefoot/sim/scenes/scene_node.hpp"
#include "surefoot/sim/scenes/scene_reader.hpp"
#include "surefoot/sim/scenes/scene_stations.hpp"

namespace surefoot::sim {
namespace {

constexpr std::uint64_t kParameterStream = 0x706172616d;

/// One scene of a file.
struct Entry {
    SceneInfo info;
    /// Group of the variant; nullptr if the file has no variants.
    const SceneNode* figures = nullptr;
    int line = 1;
};

void check_info(SceneReader& reader, const Entry& entry) {
    if (!is_name(entry.info.name)) {
        reader.fail(entry.line,
                    fmt::format("'{}' is not a valid name for a scene; use letters, digits and _, "
                                "with no digit at the start",
                                entry.info.name));
    }
    const std::string& text = entry.info.description;
    if (text.empty() || text.find('\n') != std::string::npos) {
        reader.fail(entry.line, "'description' must be one line of text");
    }
}

std::vector<Entry> find_entries(SceneReader& reader, const SceneNode& root) {
    std::vector<Entry> entries;
    const auto text_of = [&](const SceneNode& group, const char* key) {
        const SceneNode* node = reader.required(group, key, SceneNode::Kind::text);
        return node != nullptr ? node->text : std::string();
    };
    if (root.find("variants") == nullptr) {
        const std::string name = text_of(root, "name");
        entries.push_back({{name, text_of(root, "description")}, nullptr, root.line});
    } else if (const auto* variants = reader.required(root, "variants", SceneNode::Kind::group)) {
        if (root.find("name") != nullptr)
            reader.fail(root, "the file has both 'name' and 'variants'; remove one of them");
        for (const SceneNode& node : variants->items) {
            entries.push_back({{node.key, text_of(node, "description")}, &node, node.line});
        }
        if (entries.empty()) reader.fail(*variants, "names no scene; add at least one");
    }
    for (const Entry& entry : entries) {
        if (!reader.error()) check_info(reader, entry);
    }
    return entries;
}

/// Defines the parameters. The figures of a variant come first. A figure replaces the parameter of
/// the same name, whose value is the default of the other variants.
void define_parameters(SceneReader& reader,
                       const SceneNode& root,
                       const Entry& entry,
                       std::uint64_t seed) {
    Rng rng(mix_seed(seed, kParameterStream));
    if (entry.figures != nullptr) {
        for (const SceneNode& figure : entry.figures->items) {
            if (figure.key != "description" && figure.key != "motion") reader.define(figure, rng);
        }
    }
    if (root.find("parameters") == nullptr) return;
    const auto* parameters = reader.required(root, "parameters", SceneNode::Kind::group);
    if (parameters == nullptr) return;
    for (const SceneNode& parameter : parameters->items) {
        const bool given =
            entry.figures != nullptr && entry.figures->find(parameter.key) != nullptr;
        if (!given) reader.define(parameter, rng);
    }
}

std::vector<SceneParameter> drawn(const SceneReader& reader) {
    std::vector<SceneParameter> parameters;
    for (const auto& [name, value] : reader.numbers()) {
        parameters.push_back({name, fmt::format("{}", value)});
    }
    for (const auto& [name, value] : reader.words()) parameters.push_back({name, value});
    return parameters;
}

ScriptedScene build(SceneReader& reader,
                    const SceneNode& root,
                    const Entry& entry,
                    std::uint64_t seed,
                    std::optional<MotionModel> motion_model) {
    ScriptedScene out;
    out.info = entry.info;
    reader.only_keys(root,
                     {"name",
                      "description",
                      "variants",
                      "parameters",
                      "lighting",
                      "materials",
                      "solids",
                      "scan",
                      "motion"});
    define_parameters(reader, root, entry, seed);
    out.parameters = drawn(reader);
    SceneBuilder builder(reader, seed);
    if (const SceneNode* lighting = root.find("lighting")) builder.add_lighting(*lighting);
    const auto* materials = reader.required(root, "materials", SceneNode::Kind::group);
    const auto* solids = reader.required(root, "solids", SceneNode::Kind::list);
    const auto* motion = reader.required(
        entry.figures != nullptr && entry.figures->find("motion") != nullptr ? *entry.figures
                                                                             : root,
        "motion",
        SceneNode::Kind::group);
    if (reader.error()) return out;
    builder.add_materials(*materials);
    builder.add_solids(*solids, {});
    if (const SceneNode* scan = root.find("scan"))
        out.stations_m = read_stations(reader, *scan, builder.scene());
    out.script = read_motion(reader, *motion);
    if (reader.error()) return out;
    if (motion_model && *motion_model != out.script.motion_model) {
        out.script.motion_model = *motion_model;
        out.script.speed_m_s = 0.0;  // default speed of the other motion model
        out.script.height_m = 0.0;
    }
    auto made = make_motion(out.script, seed, ground_of(builder.scene()));
    if (!made) {
        reader.fail(*motion, fmt::format("cannot be followed: {}", made.error().message));
        return out;
    }
    check_way(reader, *motion, builder, *made);
    out.motion = std::move(made->motion);
    out.steps = std::move(made->steps);
    out.stops = std::move(made->stops);
    out.solids = builder.solids();
    out.scene = builder.take_scene();
    return out;
}

/// Returns the entry of that name. An empty name selects the only entry of a file.
const Entry* choose(SceneReader& reader,
                    const std::vector<Entry>& entries,
                    const std::string& name) {
    if (name.empty() && entries.size() == 1) return &entries.front();
    std::vector<std::string> names;
    for (const Entry& entry : entries) {
        if (entry.info.name == name) return &entry;
        names.push_back(entry.info.name);
    }
    reader.fail(1,
                name.empty() ? fmt::format("the file holds {} scenes; add '#NAME' to the file "
                                           "name, with one of these names: {}",
                                           names.size(),
                                           fmt::join(names, ", "))
                             : fmt::format("no scene is named '{}'{}; there are: {}",
                                           name,
                                           did_you_mean(name, names),
                                           fmt::join(names, ", ")));
    return nullptr;
}

}  // namespace

Result<std::vector<SceneInfo>> read_scene_infos(const SceneFile& file) {
    const auto root = parse_scene_node(file.text, file.file);
    if (!root) return root.error();
    SceneReader reader(file.file);
    const std::vector<Entry> entries = find_entries(reader, *root);
    if (reader.error()) return *reader.error();
    std::vector<SceneInfo> infos;
    infos.reserve(entries.size());
    for (const Entry& entry : entries) infos.push_back(entry.info);
    return infos;
}

Result<ScriptedScene> read_scene(const SceneFile& file,
                                 const std::string& name,
                                 std::uint64_t seed,
                                 std::optional<MotionModel> motion_model) {
    const auto root = parse_scene_node(file.text, file.file);
    if (!root) return root.error();
    SceneReader reader(file.file);
    const std::vector<Entry> entries = find_entries(reader, *root);
    if (reader.error()) return *reader.error();
    const Entry* entry = choose(reader, entries, name);
    if (entry == nullptr) return *reader.error();
    // Without the name, the same seed would draw the same light and distance in every scene.
    const std::uint64_t scene_seed = mix_seed(seed, fnv1a(entry->info.name));
    ScriptedScene scene = build(reader, *root, *entry, scene_seed, motion_model);
    if (reader.error()) return *reader.error();
    return scene;
}

}  // namespace surefoot::sim
