// SPDX-License-Identifier: Apache-2.0
// Any bytes as a scene file give a scene with a finite path and a finite first pose, or an error
// with a message. SUREFOOT_FUZZ_READER names the function under test.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "fuzz/must.hpp"
#include "surefoot/sim/scenes/expression.hpp"
#include "surefoot/sim/scenes/scene_file.hpp"

namespace {

using namespace surefoot;

[[maybe_unused]] void fuzz_scene(std::string_view bytes) {
    const sim::SceneFile file{"f", bytes};
    const auto infos = sim::read_scene_infos(file);
    must_explain(infos);
    if (!infos) return;
    constexpr std::uint64_t kSeed = 7;
    const std::string name = infos->empty() ? std::string() : infos->front().name;
    const auto scene = sim::read_scene(file, name, kSeed);
    must_explain(scene);
    if (!scene) return;
    must(scene->motion != nullptr && std::isfinite(scene->motion->duration_s()));
    must(scene->motion->at(0.0).T_world_body.all_finite());
    must(scene->motion->at(scene->motion->duration_s()).T_world_body.all_finite());
}

[[maybe_unused]] void fuzz_expression(std::string_view bytes) {
    static const sim::NamedNumbers numbers{{"a", 2.0}, {"b_m", -0.5}};
    const auto value = sim::evaluate(bytes, numbers);
    must_explain(value);
    must(!value || std::isfinite(*value));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    SUREFOOT_FUZZ_READER({reinterpret_cast<const char*>(data), size});
    return 0;
}
