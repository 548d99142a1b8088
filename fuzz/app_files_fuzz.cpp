// SPDX-License-Identifier: Apache-2.0
// Files that only one verb of the command line reads: joystick scripts and lists of stairs. Input:
// any bytes. SUREFOOT_FUZZ_READER names the function under test.
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "fuzz/must.hpp"
#include "service/live/joystick_script.hpp"
#include "studies/runs/stairs_json.hpp"

namespace {

using namespace surefoot;

/// The times of an accepted script never decrease, and at each time the joystick returns the
/// command of its line.
[[maybe_unused]] void fuzz_joystick_script(std::string_view bytes) {
    const auto script = app::parse_joystick_script(bytes, "f");
    must_explain(script);
    if (!script) return;
    must(app::code_at(*script, -1) == 0);
    for (std::size_t i = 0; i < script->size(); ++i) {
        const app::JoystickLine& line = (*script)[i];
        must(line.time_ns >= 0 && (i == 0 || line.time_ns >= (*script)[i - 1].time_ns));
        const bool last = i + 1 == script->size() || (*script)[i + 1].time_ns > line.time_ns;
        must(!last || app::code_at(*script, line.time_ns) == line.code);
    }
}

/// An accepted file has a list, and no count is negative.
[[maybe_unused]] void fuzz_stairs_file(std::string_view bytes) {
    const auto listed = app::parse_stairs(bytes, "f");
    must_explain(listed);
    if (!listed) return;
    must(!listed->lists.empty());
    for (const stairs::Flight& flight : listed->features.flights) must(flight.steps >= 0);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    SUREFOOT_FUZZ_READER({reinterpret_cast<const char*>(data), size});
    return 0;
}
