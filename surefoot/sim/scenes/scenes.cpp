// SPDX-License-Identifier: Apache-2.0
#include "surefoot/sim/scenes/scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "surefoot/core/assert.hpp"
#include "surefoot/core/nearest_names.hpp"
#include "surefoot/files/input_file.hpp"
#include "surefoot/sim/scenes/embedded_scenes.hpp"
#include "surefoot/sim/scenes/scene_file.hpp"

namespace surefoot::sim {
namespace {

constexpr std::string_view kExtension = ".yaml";

struct Entry {
    SceneInfo info;
    const SceneFile* file = nullptr;
};

/// The scenes that are compiled into the program; read once.
const std::vector<Entry>& index() {
    static const std::vector<Entry> all = [] {
        std::vector<Entry> entries;
        for (const SceneFile& file : embedded_scenes()) {
            const auto infos = read_scene_infos(file);
            SUREFOOT_ASSERT(infos.ok());  // cannot fail: tests read all embedded scenes
            for (const SceneInfo& info : *infos) entries.push_back({info, &file});
        }
        return entries;
    }();
    return all;
}

Result<ScriptedScene> scene_of_file(const std::string& path,
                                    const std::string& name,
                                    std::uint64_t seed,
                                    std::optional<MotionModel> motion_model) {
    const Result<std::string> text = files::read_file(path, files::limits::kSettingsBytes);
    if (!text) return text.error();
    return read_scene({path, *text}, name, seed, motion_model);
}

}  // namespace

std::vector<SceneInfo> list_scenes() {
    std::vector<SceneInfo> scenes;
    for (const Entry& entry : index()) scenes.push_back(entry.info);
    return scenes;
}

Result<ScriptedScene> make_scene(const std::string& name,
                                 std::uint64_t seed,
                                 std::optional<MotionModel> motion_model) {
    const std::size_t hash = name.find('#');
    const std::string path = name.substr(0, hash);
    if (path.ends_with(kExtension)) {
        return scene_of_file(
            path, hash == name.npos ? "" : name.substr(hash + 1), seed, motion_model);
    }
    std::vector<std::string> names;
    for (const Entry& entry : index()) {
        if (entry.info.name == name) return read_scene(*entry.file, name, seed, motion_model);
        names.push_back(entry.info.name);
    }
    // The message names only the likely scene, because a list of a hundred names would hide it.
    const std::string likely = did_you_mean(name, names);
    return usage_error(
        fmt::format("simulator: no scene is named '{}'{} 'surefoot sim --list' "
                    "shows all {} scenes",
                    name,
                    likely.empty() ? ";" : likely,
                    names.size()));
}

NamedNumbers drawn_numbers(const ScriptedScene& script) {
    NamedNumbers numbers;
    for (const SceneParameter& parameter : script.parameters) {
        if (const auto value = evaluate(parameter.value, {})) numbers[parameter.name] = *value;
    }
    return numbers;
}

double drawn_number(const ScriptedScene& script, std::string_view name) {
    const auto found = std::find_if(script.parameters.begin(),
                                    script.parameters.end(),
                                    [&](const SceneParameter& p) { return p.name == name; });
    SUREFOOT_ASSERT(found != script.parameters.end());
    return std::stod(found->value);  // exact, because the text of a drawn value is exact
}

}  // namespace surefoot::sim
